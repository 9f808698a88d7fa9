//! Helpers shared by the end-to-end tests: the built bundles, sessions for them, sounds to play.
//!
//! The bundles and the command line must have been built: `cargo xtask test` does it all.

use std::path::{Path, PathBuf};
use std::process::Command;

use pyrophone_host::bounce::{BounceOptions, await_ready, bounce};
use pyrophone_host::state::wrap;
use pyrophone_host::{BusLayout, Configuration, Format, Plugin, numeric_id};
use pyrophone_settings::session::{Learned, RecordingReference, Session, plugin_state};
use pyrophone_settings::{Preset, Values};
use pyrophone_synthesis::structure::MatchingMode;

pub mod desk;
pub mod live;
/// Reference data.
#[allow(missing_docs, reason = "written for one crate's own tests")]
#[path = "../../synthesis/tests/common/mod.rs"]
pub mod reference;
/// Made-up signals.
#[allow(missing_docs, reason = "written for one crate's own tests")]
#[path = "../../synthesis/tests/common/signals.rs"]
pub mod signals;
pub use reference::skip;

/// Sample rate of most tests, in Hz.
pub const RATE_HZ: f64 = 44_100.0;
/// One channel in, one out.
pub const MONO: BusLayout = BusLayout { input: 1, sidechain: 0, output: 1 };
/// Two channels in, two out.
pub const STEREO: BusLayout = BusLayout { input: 2, sidechain: 0, output: 2 };

/// The build's folder.
pub fn target_dir() -> PathBuf {
    // A relative one counts from where Cargo is called, which is the workspace.
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    workspace.join(std::env::var_os("CARGO_TARGET_DIR").unwrap_or_else(|| "target".into()))
}

/// The built bundle.
pub fn bundle(format: Format) -> PathBuf {
    let path = target_dir().join("bundled").join(format!("Pyrophone.{}", format.extension()));
    assert!(path.exists(), "{} is not built; run `cargo xtask test`", path.display());
    path
}

/// The command line of the build that `PYROPHONE_BUILD` names, `debug` unless told.
pub fn command_line() -> PathBuf {
    let build = std::env::var_os("PYROPHONE_BUILD").unwrap_or_else(|| "debug".into());
    let path = target_dir().join(build).join(format!("pyrophone{}", std::env::consts::EXE_SUFFIX));
    assert!(path.exists(), "{} is not built; run `cargo xtask test`", path.display());
    path
}

/// A new instance.
pub fn open(format: Format) -> Box<dyn Plugin> {
    pyrophone_host::load(&bundle(format), format).unwrap_or_else(|error| panic!("{format}: {error}"))
}

/// A factory preset's values, changed.
pub fn preset(name: &str, changes: &[(&str, &str)]) -> Values {
    let mut values = Preset::find(name).expect("a factory preset").values;
    for (id, text) in changes {
        values.set_text(id, text).unwrap_or_else(|error| panic!("{error}"));
    }
    values
}

/// Loads values and session into an instance, as a host loads its project.
pub fn load_session(plugin: &mut dyn Plugin, values: &Values, session: &Session) {
    let state = wrap(plugin.format(), plugin_state(values, session).as_bytes());
    plugin.set_state(&state).unwrap_or_else(|error| panic!("{error}"));
}

/// A session with this recording.
pub fn session(recording: Option<&Path>, learned: Option<Learned>) -> Session {
    let reference = |path: &Path| RecordingReference {
        path: path.to_str().expect("a UTF-8 path").to_owned(),
        content_hash: pyrophone_recording::decode(path, &|_| true).expect("a good recording").content_hash,
        embedded: None,
    };
    Session { recording: recording.map(reference), learned, ..Session::default() }
}

/// Distribution that texture learns from these channels played through `values`.
pub fn learned(values: &Values, input: &[Vec<f32>], sample_rate_hz: f64) -> Learned {
    let structure = values.structure();
    let distribution = pyrophone_synthesis::chain::learn(sample_rate_hz, &structure, &values.controls(), input, &[]);
    let quantiles = distribution.expect("long enough").quantiles().to_vec();
    Learned {
        sample_rate_hz,
        levels: structure.levels,
        companded: structure.dynamics == MatchingMode::Companded,
        quantiles,
    }
}

/// Waits until an inactive instance has its recording, however long that takes.
pub fn await_recording(plugin: &mut dyn Plugin, sample_rate: f64, layout: BusLayout) {
    let configuration = Configuration { sample_rate, max_block: 512, layout, offline: true };
    await_ready(plugin, &configuration).unwrap_or_else(|error| panic!("{error}"));
}

/// Plays `input` through an inactive instance; the output is as long, latency compensated.
pub fn play(plugin: &mut dyn Plugin, input: &[Vec<f32>], options: &BounceOptions) -> Vec<Vec<f32>> {
    bounce(plugin, input, None, options).unwrap_or_else(|error| panic!("{error}")).channels
}

/// Sets a parameter by id and text from the main thread.
pub fn set(plugin: &mut dyn Plugin, id: &str, text: &str) {
    let id = numeric_id(id);
    let value = plugin.parse(id, text).unwrap_or_else(|error| panic!("{id}={text}: {error}"));
    plugin.set_value(id, value).unwrap_or_else(|error| panic!("{error}"));
}

/// How often something is tried: fewer times in `cargo xtask test` than in `cargo xtask soak`.
pub fn rounds(test: usize, soak: usize) -> usize {
    if is_soak() { soak } else { test }
}

/// Whether these are the long tests.
pub fn is_soak() -> bool {
    std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1")
}

/// Flame-like channels.
pub fn flame(seed: u64, channels: usize, samples: usize) -> Vec<Vec<f32>> {
    let mut random = signals::Random::new(seed);
    (0..channels).map(|_| signals::signal(&mut random, 0, samples).iter().map(|x| *x as f32).collect()).collect()
}

/// Writes a crackling recording to `folder`.
pub fn recording(folder: &Path, name: &str, channels: usize, samples: usize) -> PathBuf {
    let mut random = signals::Random::new(channels as u64 + samples as u64);
    let sound: Vec<Vec<f32>> =
        (0..channels).map(|_| signals::signal(&mut random, 1, samples).iter().map(|x| *x as f32).collect()).collect();
    write_wav(&folder.join(name), &sound, RATE_HZ as u32)
}

/// Writes a float32 WAV file.
pub fn write_wav(path: &Path, channels: &[Vec<f32>], rate_hz: u32) -> PathBuf {
    pyrophone_recording::write_wav_f32(path, channels, rate_hz).unwrap_or_else(|error| panic!("{error}"));
    path.to_owned()
}

/// Samples of two sounds that differ.
pub fn differing(a: &[f32], b: &[f32]) -> usize {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).filter(|(a, b)| a.to_bits() != b.to_bits() && a != b).count()
}

/// Largest magnitude; infinite where a sample is no number.
pub fn peak(x: &[f32]) -> f32 {
    x.iter().fold(0.0, |peak, x| if x.is_finite() { peak.max(x.abs()) } else { f32::INFINITY })
}

/// Asserts that every channel sounds in every stretch of `stretch` samples, within reason.
#[track_caller]
pub fn assert_sounds(channels: &[Vec<f32>], stretch: usize, context: &str) {
    assert!(!channels.is_empty(), "{context}: no channels");
    for (index, channel) in channels.iter().enumerate() {
        assert!(channel.len() >= stretch, "{context}: only {} samples", channel.len());
        for (number, part) in channel.chunks_exact(stretch).enumerate() {
            let found = peak(part);
            let at = number * stretch;
            assert!(found > 1e-5, "{context}: channel {index} is silent from sample {at} on");
            assert!(found < 100.0, "{context}: channel {index} reaches {found} after sample {at}");
        }
    }
}

/// Asserts that two sounds are the same, bit for bit, and no silence.
#[track_caller]
pub fn assert_same(found: &[Vec<f32>], expected: &[Vec<f32>], context: &str) {
    assert_eq!(found.len(), expected.len(), "{context}: channels");
    for (channel, (found, expected)) in found.iter().zip(expected).enumerate() {
        assert!(peak(expected) > 1e-5, "{context}: channel {channel} is silent");
        let first = found.iter().zip(expected).position(|(a, b)| a != b);
        let count = differing(found, expected);
        assert_eq!(
            count,
            0,
            "{context}: of {} samples of channel {channel} these differ, the first {first:?}",
            found.len()
        );
    }
}

/// The part of every channel in a range of samples.
pub fn part(channels: &[Vec<f32>], range: std::ops::Range<usize>) -> Vec<Vec<f32>> {
    channels.iter().map(|channel| channel[range.clone()].to_vec()).collect()
}

/// Writes a stereo recording that sounds in channel `side` alone, so that it can be told by ear which recording is heard.
pub fn one_sided_recording(folder: &Path, name: &str, side: usize, samples: usize) -> PathBuf {
    let mut random = signals::Random::new(side as u64 + 77);
    let mut sound = vec![vec![0.0; samples]; 2];
    sound[side] = signals::signal(&mut random, 1, samples).iter().map(|x| *x as f32).collect();
    write_wav(&folder.join(name), &sound, RATE_HZ as u32)
}

/// Fails if `condition` has not come true within a minute of asking; what is waited for happens on the plugin's own thread.
#[track_caller]
pub fn wait_until(what: &str, mut condition: impl FnMut() -> bool) {
    let began = std::time::Instant::now();
    while !condition() {
        assert!(began.elapsed().as_secs() < 60, "{what}: not within a minute");
    }
}

/// Runs the test of this path (as `--list` prints it) in another process, with more in its environment, because what goes wrong here aborts the host,
/// or kills a thread of the framework, which is only heard of on the error stream. Lines that begin with `figure: ` are shown.
pub fn in_a_process_of_its_own(test: &str, environment: &[(&str, &str)], body: fn()) {
    const INSIDE: &str = "PYROPHONE_TEST_INSIDE";
    if std::env::var_os(INSIDE).is_some() {
        return body();
    }
    let program = std::env::current_exe().expect("this program");
    let mut command = Command::new(program);
    let output = command
        .args(["--exact", test, "--nocapture"])
        .env(INSIDE, "1")
        .envs(environment.iter().copied())
        .output()
        .expect("it runs again");
    let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned()).concat();
    assert!(said.contains("1 passed") && output.status.success(), "{test}: {}\n{said}", output.status);
    said.lines().filter(|line| line.starts_with("figure: ")).for_each(|line| println!("{line}"));
    let panics: Vec<&str> = said.lines().filter(|line| line.contains("panicked")).collect();
    assert!(panics.is_empty(), "{test}: threads were lost:\n{}", panics.join("\n"));
}
