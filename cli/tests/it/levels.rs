//! Levels of the factory presets: none exceeds -1 dBTP, neither by itself nor over the reference drives and crackling recordings.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::common::{read, reference};
use pyrophone_settings::Id;
use pyrophone_settings::Preset;
use pyrophone_settings::table::DRIVE_MODES;
use pyrophone_synthesis::structure::MatchingMode;
use tempfile::TempDir;

/// The most that is allowed, in dB relative to full scale between samples.
const MOST_DBTP: f64 = -1.0;
/// Seconds of what burns by itself, in every run and in the long tests.
const SECONDS: [f64; 2] = [5.0, 80.0];
/// Of so many presets one is heard in every run; all in the long tests.
const STRIDE: usize = 12;
/// Drives of the reference data, and the recordings that are heard with them.
const REFERENCE: [(&str, &str); 5] = [
    ("burning_brick", "training/burning_brick.wav"),
    ("dragon", "recordings/chimney.flac"),
    ("dragon", "training/dragon.wav"),
    ("dragon", "recordings/esc_camp.flac"),
    ("torch", "training/torch.wav"),
];
/// Samples on either side from which a value between two samples is found, and places between two at which it is.
const REACH: i64 = 16;
const PLACES: i64 = 4;

/// True peak (ITU-R BS.1770-4, Annex 2: four values for every sample) in dB. Values between samples that are all small are
/// not looked for: they are no peak.
fn true_peak_db(channels: &[Vec<f32>]) -> f64 {
    let peak = channels.iter().flatten().fold(0.0f32, |peak, x| peak.max(x.abs()));
    let mut most = f64::from(peak);
    for channel in channels {
        for (at, _) in channel.iter().enumerate().filter(|(_, x)| x.abs() >= 0.7 * peak) {
            let beside = (1 - PLACES..PLACES).map(|place| between(channel, at as i64, place as f64 / PLACES as f64));
            most = beside.fold(most, |most, value| most.max(value.abs()));
        }
    }
    20.0 * most.max(1e-9).log10()
}

/// The signal `part` of a sample after sample `at`, by a windowed sinc.
fn between(signal: &[f32], at: i64, part: f64) -> f64 {
    let weight = |x: f64| {
        let sinc = if x.abs() < 1e-9 { 1.0 } else { (std::f64::consts::PI * x).sin() / (std::f64::consts::PI * x) };
        let window = 0.5 + 0.5 * (std::f64::consts::PI * x / (REACH as f64 + 1.0)).cos();
        sinc * window
    };
    let near = (at - REACH..=at + REACH).filter(|index| (0..signal.len() as i64).contains(index));
    near.map(|index| f64::from(signal[index as usize]) * weight((at - index) as f64 + part)).sum()
}

/// Whether a preset burns by itself.
fn burns(preset: &Preset) -> bool {
    DRIVE_MODES.get(preset.values.get(Id::DriveMode) as usize) == Some(&"flame")
}

/// Whether a preset has the recording's own level, as the paper's mode has.
fn is_paper(preset: &Preset) -> bool {
    preset.values.structure().dynamics == MatchingMode::Paper
}

/// Whether the long tests run.
fn is_soak() -> bool {
    std::env::var_os("PYROPHONE_SOAK").is_some()
}

struct Studio(TempDir);

impl Studio {
    /// What is rendered louder than it may be, in words.
    fn too_loud(&self, preset: &Preset, options: &str) -> Option<String> {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
        command.current_dir(self.0.path()).args(["render", "--quiet", "--preset", &preset.name, "--output", "out.wav"]);
        command.args(options.split_whitespace());
        // What many presets learn alike is learnt once: for all tests, where they have a folder, else for these.
        if std::env::var_os("PYROPHONE_CACHE").is_none_or(|folder| folder.is_empty()) {
            command.env("PYROPHONE_CACHE", self.0.path().join("cache"));
        }
        let output = command.output().unwrap();
        assert!(output.status.success(), "{}: {}", preset.name, String::from_utf8_lossy(&output.stderr));
        let found_db = true_peak_db(&read(&self.0.path().join("out.wav")).channels);
        (found_db > MOST_DBTP).then(|| format!("{}: {found_db:.2} dBTP with {options}", preset.name))
    }
}

fn file(folder: &Path, name: &str) -> String {
    let path: PathBuf = folder.join(name);
    path.to_str().expect("a UTF-8 path").to_owned()
}

#[test]
fn presets_that_burn_by_themselves_stay_below_minus_1_dbtp() {
    let studio = Studio(tempfile::tempdir().unwrap());
    let presets = Preset::factory().unwrap();
    let alone: Vec<&Preset> = presets.iter().filter(|preset| burns(preset) && !is_paper(preset)).collect();
    assert!(alone.len() > 20, "{} presets burn by themselves", alone.len());
    let options = format!("--seconds {}", SECONDS[usize::from(is_soak())]);
    let chosen = alone.into_iter().step_by(if is_soak() { 1 } else { STRIDE / 4 });
    let loud: Vec<String> = chosen.filter_map(|preset| studio.too_loud(preset, &options)).collect();
    assert!(loud.is_empty(), "{loud:#?}");
}

#[test]
fn presets_over_the_reference_data_stay_below_minus_1_dbtp() {
    let Some(folder) = reference() else { return };
    let studio = Studio(tempfile::tempdir().unwrap());
    let (mut loud, mut heard) = (Vec::new(), 0);
    let presets = Preset::factory().unwrap().into_iter();
    for (number, preset) in presets.step_by(if is_soak() { 1 } else { STRIDE }).enumerate() {
        let drive = |name: &str| match burns(&preset) {
            true => "--seconds 12".to_owned(),
            false => format!("--input {}", file(&folder, &format!("signals/{name}.wav"))),
        };
        for (place, (drive_name, recording)) in REFERENCE.into_iter().enumerate() {
            // The paper's mode plays a recording as loud as it is: only its own are below full scale.
            let is_foreign = recording.ends_with(".flac");
            // Every second recording, and the ones between for the next preset; all for all in the long tests only.
            let is_chosen = (number + place).is_multiple_of(2) || is_soak();
            if is_foreign && is_paper(&preset) || !is_chosen {
                continue;
            }
            let recording = file(&folder, recording);
            loud.extend(studio.too_loud(&preset, &format!("{} --recording {recording}", drive(drive_name))));
            heard += 1;
        }
    }
    assert!(heard >= 6, "only {heard} were heard");
    assert!(loud.is_empty(), "{loud:#?}");
}

#[test]
fn a_peak_between_two_samples_is_found() {
    // A sine at a quarter of the rate whose samples all lie beside its crests.
    let sine: Vec<f32> = (0..400).map(|n| (std::f64::consts::FRAC_PI_2 * (f64::from(n) + 0.5)).sin() as f32).collect();
    assert!((true_peak_db(&[sine]) - 0.0).abs() < 0.1);
}
