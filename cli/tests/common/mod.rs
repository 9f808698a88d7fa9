//! The built binary, and sounds to feed it.
#![allow(dead_code, missing_docs)]

#[path = "../../../tests/src/skip.rs"]
pub mod skip;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use pyrophone_recording::{Recording, decode, no_progress, write_wav_f32};

/// Runs `pyrophone` in `folder` with arguments parted by spaces. Lines of progress, which only a busy machine sees, are
/// left out of what it printed.
pub fn pyrophone(folder: &Path, arguments: &str) -> Output {
    let arguments = arguments.split_whitespace();
    // Help is wrapped to this width.
    let width = ("COLUMNS", "100");
    let binary = env!("CARGO_BIN_EXE_pyrophone");
    let mut output = Command::new(binary).current_dir(folder).envs([width]).args(arguments).output().unwrap();
    let printed = String::from_utf8_lossy(&output.stderr);
    let is_progress =
        |line: &str| line.ends_with(" %\n") && !line.starts_with("error: ") && !line.starts_with("note: ");
    output.stderr = printed.split_inclusive('\n').filter(|line| !is_progress(line)).collect::<String>().into_bytes();
    output
}

#[track_caller]
pub fn succeeds(folder: &Path, arguments: &str) {
    let output = pyrophone(folder, arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Asserts exit code, one line on standard error that says all of `says`, and no new file.
#[track_caller]
pub fn refuses(folder: &Path, arguments: &str, code: i32, says: &[&str]) {
    let before = files(folder);
    let output = pyrophone(folder, arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{arguments}: {error}");
    assert_eq!(error.lines().count(), 1, "{arguments}: {error}");
    assert!(error.starts_with("error: ") && output.stdout.is_empty(), "{arguments}: {error}");
    for part in says {
        assert!(error.contains(part), "{arguments}: '{part}' is missing from: {error}");
    }
    assert_eq!(files(folder), before, "{arguments} left a file behind");
}

fn files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

pub fn read(path: &Path) -> Recording {
    decode(path, &no_progress).unwrap()
}

/// A low flame rumble: two beating tones below the cutoff.
pub fn rumble(samples: usize, rate_hz: u32) -> Vec<f32> {
    let tone = |n: usize, hz: f32| (std::f32::consts::TAU * hz * n as f32 / rate_hz as f32).sin();
    (0..samples).map(|n| 0.1 * (tone(n, 90.0) + tone(n, 97.0) + tone(n, 171.0))).collect()
}

/// White noise at a tenth of full scale, the same for the same seed.
pub fn hiss(samples: usize, seed: u64) -> Vec<f32> {
    let mut state = seed;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 40) as f32 / (1u64 << 24) as f32 - 0.5) * 0.2
    };
    (0..samples).map(|_| next()).collect()
}

pub fn write(folder: &Path, name: &str, channels: &[Vec<f32>], rate_hz: u32) {
    write_wav_f32(&folder.join(name), channels, rate_hz).unwrap();
}

/// The reference data, or `None` with a line that says so; missing under `CI=true` is a failure.
pub fn reference() -> Option<PathBuf> {
    let beside = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or(beside, PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    assert!(std::env::var("CI").as_deref() != Ok("true"), "no reference data at {}", folder.display());
    skip::skip(&format!("no reference data at {}", folder.display()));
    None
}

/// A raw little-endian float64 file.
pub fn doubles(path: &Path) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap();
    bytes.chunks_exact(8).map(|bytes| f64::from_le_bytes(bytes.try_into().unwrap())).collect()
}
