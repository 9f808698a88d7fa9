//! `pyrophone vortex-texture`: the same bytes by every way, and what is refused.

#[cfg(unix)]
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{refuses, succeeds};
use pyrophone_synthesis::vortex::texture::VortexTexture;

const PROGRESS: &str = "fire.vtx.vortex-progress";

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

fn small(options: &str) -> String {
    format!("vortex-texture --speeds 1:4:3 --seconds 0.25 --rate 2000 --voxels 8x8x8 {options}")
}

#[test]
fn the_file_holds_the_rows_that_were_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    succeeds(folder.path(), &small("--output fire.vtx"));
    let texture = VortexTexture::from_bytes(&bytes(folder.path(), "fire.vtx")).unwrap();
    assert_eq!((texture.sample_rate_hz(), texture.period_samples()), (2000.0, 500));
    assert_eq!(texture.rows().iter().map(|row| row.speed_m_s).collect::<Vec<_>>(), [1.0, 2.0, 4.0]);
    assert!(texture.rows().iter().all(|row| row.gain > 0.0));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "only the texture is left");
    for options in ["--kind jet", "--kind wind", "--seed 2", "--perturbation 0.3", "--voxel-size 0.04", "--paper"] {
        succeeds(folder.path(), &small(&format!("--output other.vtx {options}")));
        assert_ne!(bytes(folder.path(), "fire.vtx"), bytes(folder.path(), "other.vtx"), "{options} changes nothing");
    }
}

/// Stopped by Ctrl-C and called again, it takes the rows that were done and gives what an uninterrupted run gives.
#[cfg(unix)]
#[test]
fn an_interrupted_recording_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = small("--output fire.vtx");
    let mut child = Command::new(env!("CARGO_BIN_EXE_pyrophone"))
        .current_dir(folder.path())
        .args(arguments.replace("1:4:3", "1:4:200").split(' '))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while !folder.path().join(PROGRESS).exists() {
        assert!(began.elapsed() < Duration::from_secs(120), "no row was kept");
        std::thread::sleep(Duration::from_millis(10));
    }
    let stopped = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(stopped.success());
    assert_eq!(child.wait().unwrap().signal(), Some(2), "it dies of the signal");
    assert!(!folder.path().join("fire.vtx").exists());
    let kept = bytes(folder.path(), PROGRESS);
    let settings = kept.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    // Which row was done first depends on the cores; it is asked for again.
    let speed = f64::from_le_bytes(kept[settings..settings + 8].try_into().unwrap());
    let again = arguments.replace("1:4:3", &format!("{speed}:{speed}:1"));
    let output = crate::common::pyrophone(folder.path(), &again);
    assert!(output.status.success());
    assert!(String::from_utf8(output.stderr).unwrap().contains("1 rows are reused from an interrupted run"));
    assert!(!folder.path().join(PROGRESS).exists());
    succeeds(folder.path(), &again.replace("fire.vtx", "whole.vtx"));
    assert_eq!(bytes(folder.path(), "fire.vtx"), bytes(folder.path(), "whole.vtx"));
}

#[test]
fn progress_of_another_run_is_not_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let run = small("--output fire.vtx");
    succeeds(folder.path(), &run);
    let expected = bytes(folder.path(), "fire.vtx");
    for garbage in [&b"jet, 8x8x8 voxels\n"[..], b"", &[255; 100], b"no line's end"] {
        std::fs::write(folder.path().join(PROGRESS), garbage).unwrap();
        succeeds(folder.path(), &run);
        assert_eq!(bytes(folder.path(), "fire.vtx"), expected);
    }
}

#[test]
fn senseless_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |options: &str, says: &[&str]| refuses(folder.path(), &small(options), 1, says);
    refused("--output nowhere/a.vtx", &["no folder nowhere"]);
    refused("--output .", &["folder"]);
    refused("--output a.vtx --voxel-size 0", &["voxel size", "0.001"]);
    refused("--output a.vtx --perturbation nan", &["perturbation"]);
    let other = |from: &str, to: &str, says: &[&str]| {
        refuses(folder.path(), &small("--output a.vtx").replace(from, to), 1, says);
    };
    other("1:4:3", "0:4:3", &["speed", "0.1"]);
    other("1:4:3", "4:1:3", &["highest speed", "4"]);
    other("1:4:3", "1:4:0", &["number of speeds"]);
    other("0.25", "0", &["period"]);
    other("2000", "2000.5", &["whole"]);
    other("8x8x8", "8x8x1000", &["voxels", "128"]);
    for (from, to) in [("1:4:3", "1:4"), ("1:4:3", "a:4:3"), ("8x8x8", "8x8"), ("8x8x8", "8xx8")] {
        let output = crate::common::pyrophone(folder.path(), &small("--output a.vtx").replace(from, to));
        assert_eq!(output.status.code(), Some(2), "{to}");
    }
}
