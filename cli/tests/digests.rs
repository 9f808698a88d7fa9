//! The same bits everywhere: what renders and simulations write has one digest on every system and processor.
//!
//! `PYROPHONE_LAUNCHER` names another build of the command line to run, and what it is run by, such as
//! `qemu-aarch64 -L /usr/aarch64-linux-gnu target/aarch64-unknown-linux-gnu/release/pyrophone`.

mod common;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use common::{hiss, read, write};

/// File of digests, one line each: the output's name and its digest.
const KEPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/digests.txt");
/// Environment variable with the words that run the command line, parted by spaces.
const LAUNCHER: &str = "PYROPHONE_LAUNCHER";
/// Hides the wider vectors and the fused multiplication from the C library.
const PLAIN: (&str, &str) =
    ("GLIBC_TUNABLES", "glibc.cpu.hwcaps=-AVX2,-AVX,-FMA,-FMA4,-AVX512F,-AVX512VL,-AVX512BW,-AVX512DQ,-AVX512CD");

/// Outputs by name, and the arguments that make them.
const OUTPUTS: [(&str, &str); 10] = [
    ("default", "render --preset default --input drive.wav --training fire.wav"),
    ("texture", "render --preset texture --input drive.wav --training fire.wav"),
    ("texture-paper", "render --preset texture-paper --input drive.wav --training fire.wav"),
    ("extend", "render --preset extend --input drive.wav"),
    ("hearth", "render --preset hearth --seconds 1.5"),
    ("campfire", "render --preset campfire --seconds 1.5 --channels 6"),
    ("explosion", "render --preset explosion --seconds 1.5"),
    ("swinging-torch", "render --preset swinging-torch --seconds 1.5"),
    ("extension-as-published", "extend --reference --input drive.wav"),
    ("torch-simulated", "simulate torch --seconds 0.5 --resolution 32"),
];

/// Made of whole numbers and products alone, so that it is the same wherever this test is compiled: a rumble that swells,
/// or crackling noise.
fn sound(samples: usize, seed: u64, smoothing: f32) -> Vec<f32> {
    let mut low = [0.0f32; 2];
    let swell = |n: usize| 0.2 + (n % 9_000) as f32 / 9_000.0;
    let noise = hiss(samples, seed);
    let mut louder = 0.0f32;
    let smooth = |(n, x): (usize, f32)| {
        louder = if n % 1_777 == 100 { 6.0 } else { louder * 0.98 };
        low[0] += smoothing * (x * (1.0 + louder) - low[0]);
        low[1] += smoothing * (low[0] - low[1]);
        swell(n) * low[1] / smoothing.max(0.1)
    };
    noise.into_iter().enumerate().map(smooth).collect()
}

/// Runs the command line, or the one that is named from outside.
fn run(folder: &Path, arguments: &str, environment: Option<(&str, &str)>) {
    let launcher = std::env::var(LAUNCHER).unwrap_or_else(|_| env!("CARGO_BIN_EXE_pyrophone").to_owned());
    let mut words = launcher.split_whitespace();
    let mut command = Command::new(words.next().expect("a launcher"));
    command.args(words).args(arguments.split_whitespace()).current_dir(folder).envs(environment);
    // What one build has learnt must not serve another.
    command.env("PYROPHONE_CACHE", "");
    let output = command.output().unwrap_or_else(|error| panic!("{launcher}: {error}"));
    assert!(output.status.success(), "{arguments}: {}\n{}", output.status, String::from_utf8_lossy(&output.stderr));
}

/// The digest of all samples of a sound, channel by channel.
fn digest(path: &Path) -> String {
    let sound = read(path);
    let peak = sound.channels.iter().flatten().fold(0.0f32, |peak, x| peak.max(x.abs()));
    assert!(peak > 1e-3, "{} is silent: that proves nothing", path.display());
    let mut hasher = blake3::Hasher::new();
    for channel in &sound.channels {
        hasher.update(&(channel.len() as u64).to_le_bytes());
        for sample in channel {
            hasher.update(&sample.to_le_bytes());
        }
    }
    hasher.finalize().to_hex()[..32].to_owned()
}

/// Makes all outputs and compares their digests with those kept.
fn check(environment: Option<(&str, &str)>, is_checked: fn(&str) -> bool) {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "drive.wav", &[1, 2].map(|seed| sound(48_000, seed, 0.03)), 48_000);
    write(folder.path(), "fire.wav", &[3, 4].map(|seed| sound(60_000, seed, 1.0)), 44_100);
    let kept = std::fs::read_to_string(KEPT).unwrap();
    let kept: BTreeMap<&str, &str> = kept.lines().filter_map(|line| line.split_once(' ')).collect();
    let (mut found, mut wrong) = (String::new(), Vec::new());
    for (name, arguments) in OUTPUTS.into_iter().filter(|(name, _)| is_checked(name)) {
        let path = folder.path().join(format!("{name}.wav"));
        run(folder.path(), &format!("{arguments} --output {name}.wav"), environment);
        let digest = digest(&path);
        if kept.get(name) != Some(&digest.as_str()) {
            wrong.push(name);
        }
        writeln!(found, "{name} {digest}").unwrap();
    }
    assert!(wrong.is_empty(), "{wrong:?} differ from cli/tests/digests.txt; these were found:\n{found}");
    assert_eq!(kept.len(), OUTPUTS.len(), "a digest of something that is not made");
}

#[test]
fn outputs_have_their_digests() {
    check(None, |_| true);
}

#[test]
fn outputs_have_their_digests_without_fused_multiplication_in_the_c_library() {
    if std::env::var_os(LAUNCHER).is_none() {
        // Every engine once: what differs by the C library differs in all that use it. All in the long tests.
        let is_soak = std::env::var_os("PYROPHONE_SOAK").is_some();
        let once = |name: &str| ["default", "extension-as-published", "campfire", "torch-simulated"].contains(&name);
        check(Some(PLAIN), if is_soak { |_| true } else { once });
    }
}
