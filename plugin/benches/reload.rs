//! Cost of restoring a recording when a session is reopened: CPU seconds of the whole process from the order to the
//! dictionary's arrival at the audio thread, first without and then with the dictionary on disk, each in a separate
//! process.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use nice_plug_egui::RepaintNotifier;
use pyrophone::loader::link::{AudioLink, Update};
use pyrophone::loader::{Engine, Loader};
use pyrophone_settings::Session;
use pyrophone_settings::session::{FIELD, RecordingReference};
use pyrophone_synthesis::chain::Channels;
use pyrophone_synthesis::dsp::White;
use pyrophone_training::store::FOLDER_VARIABLE;

const RATE_HZ: u32 = 48_000;
/// Lengths of the recordings in seconds: one like those of the examples, and a long one.
const LENGTHS_S: [usize; 2] = [14, 120];
const PATIENCE: Duration = Duration::from_secs(120);

/// Stereo noise with a varying level and ten crackles a second, as 24-bit WAV.
fn write_recording(path: &Path, seconds: usize) {
    let specification = hound::WavSpec {
        channels: 2,
        sample_rate: RATE_HZ,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, specification).unwrap();
    let noises = [White::new(1, 0), White::new(1, 1)];
    for at in 0..seconds * RATE_HZ as usize {
        let time_s = at as f64 / f64::from(RATE_HZ);
        let swell = 0.03 * (1.2 + (2.0 * time_s).sin());
        let crackle = 0.5 * (-1500.0 * time_s.rem_euclid(0.1)).exp();
        for noise in &noises {
            let sample = (swell + crackle) * noise.sample_at(at as i64);
            writer.write_sample((sample.clamp(-1.0, 1.0) * 8_388_607.0) as i32).unwrap();
        }
    }
    writer.finalize().unwrap();
}

/// CPU seconds that this process has used.
fn cpu_s() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: the call writes the time into the given structure, which outlives the call.
    let answer = unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &mut time) };
    assert_eq!(answer, 0);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

fn has_dictionary(link: &mut AudioLink) -> bool {
    std::iter::from_fn(|| link.receive()).any(|update| matches!(update, Update::Dictionary(_, Some(_))))
}

/// Opens a session with a recording as a host does; prints CPU and wall seconds until the audio thread has it, and CPU
/// seconds until its picture is ready too, for a window opened at that point.
fn open_session(recording: &Path, waits_for_cache: Option<&Path>) {
    let content_hash = pyrophone_recording::content_hash(&std::fs::read(recording).unwrap());
    let (loader, params, mut link) = Loader::start(RepaintNotifier::new(), None);
    let path = recording.to_string_lossy().into_owned();
    let session =
        Session { recording: Some(RecordingReference { path, content_hash, embedded: None }), ..Session::default() };
    let field = serde_json::to_string(&session.to_json()).unwrap();
    let (cpu, wall) = (cpu_s(), Instant::now());
    nice_plug::prelude::Params::deserialize_fields(&*params, &[(FIELD.to_owned(), field)].into());
    let channels = Channels { input: 2, sidechain: 0, output: 2 };
    let structure = params.values().structure();
    let ticket = loader.set_engine(Engine { sample_rate_hz: f64::from(RATE_HZ), structure, channels });
    while !has_dictionary(&mut link) {
        assert!(wall.elapsed() < PATIENCE, "{:?}", loader.handle().status.view().error);
        std::thread::sleep(Duration::from_millis(1));
    }
    let (heard_cpu, heard_wall) = (cpu_s() - cpu, wall.elapsed().as_secs_f64());
    assert!(loader.wait(ticket, Some(PATIENCE)));
    loader.handle().shared.is_watched.store(true, std::sync::atomic::Ordering::Relaxed);
    while loader.handle().status.view().overview.is_none() {
        assert!(wall.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(1));
    }
    println!("{heard_cpu:.3} {heard_wall:.3} {:.3}", cpu_s() - cpu);
    while waits_for_cache.is_some_and(|folder| !is_kept(folder)) {
        assert!(wall.elapsed() < PATIENCE, "nothing was kept");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn is_kept(cache: &Path) -> bool {
    let files = std::fs::read_dir(cache.join("dictionaries")).into_iter().flatten().flatten();
    files.map(|file| file.path()).any(|path| path.extension().is_some_and(|extension| extension == "dictionary"))
}

/// Runs this program again on one recording; the three figures it prints.
fn measure(recording: &Path, cache: &Path, step: &str) -> Vec<f64> {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.arg(step).arg(recording).env(FOLDER_VARIABLE, cache).stderr(Stdio::inherit());
    let output = command.output().unwrap();
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    text.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[1..] {
        ["first", recording, ..] => {
            let cache = std::env::var_os(FOLDER_VARIABLE).unwrap();
            open_session(Path::new(recording), Some(Path::new(&cache)));
        }
        ["again", recording, ..] => open_session(Path::new(recording), None),
        _ => compare(),
    }
}

fn compare() {
    println!("### Loading a recording\n\nCPU seconds until the audio thread has it, (elapsed), and with its picture\n");
    println!("| recording | first time | opened again |\n|---|---|---|");
    for seconds in LENGTHS_S {
        let folder = tempfile::tempdir().unwrap();
        let (recording, cache) = (folder.path().join("recording.wav"), folder.path().join("cache"));
        write_recording(&recording, seconds);
        let cells = ["first", "again"].map(|step| {
            let figures = measure(&recording, &cache, step);
            format!("{:.3} ({:.3}), {:.3}", figures[0], figures[1], figures[2])
        });
        println!("| {seconds} s, stereo, 48 kHz | {} | {} |", cells[0], cells[1]);
    }
    println!();
}
