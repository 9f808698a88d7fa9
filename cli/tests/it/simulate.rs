//! `pyrophone simulate`: the same result by every way, and what is refused.

#[cfg(unix)]
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{read, refuses, succeeds};

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Simulating and measuring in one go equals `flux` over the frames.
#[test]
fn cached_frames_give_the_same_signal() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["candle", "torch"] {
        let run = format!("simulate {scene} --resolution 16 --seconds 0.1 --pre-roll 0.05");
        succeeds(
            folder.path(),
            &format!("{run} --output at-once.wav --flux-csv at-once.csv --cache {scene} --report page"),
        );
        succeeds(folder.path(), &format!("flux --input {scene} --output read.wav --flux-csv read.csv"));
        assert_eq!(std::fs::read_dir(folder.path().join(scene)).unwrap().count(), 36);
        assert_eq!(bytes(folder.path(), "at-once.csv"), bytes(folder.path(), "read.csv"), "{scene}");
        assert_eq!(bytes(folder.path(), "at-once.wav"), bytes(folder.path(), "read.wav"), "{scene}");
        let sound = read(&folder.path().join("read.wav"));
        let peak = sound.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        assert!((peak - 10f32.powf(-6.0 / 20.0)).abs() < 1e-3, "{scene}: peak {peak}");
        assert!(String::from_utf8(bytes(folder.path(), "page/index.html")).unwrap().contains("data:image/png"));
    }
}

#[test]
fn a_report_that_is_a_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("page"), "mine").unwrap();
    let run = "simulate dragon --seconds 3600 --output a.wav --report page";
    refuses(folder.path(), run, 1, &["page: this is a file"]);
    assert_eq!(bytes(folder.path(), "page"), b"mine");
}

#[test]
fn the_seed_and_the_options_are_heard() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str, options: &str| {
        succeeds(folder.path(), &format!("simulate dragon --resolution 16 --seconds 0.1 --output {name} {options}"));
        bytes(folder.path(), name)
    };
    let plain = run("a.wav", "");
    assert_eq!(plain, run("b.wav", "--seed 1 --refine 3 --pre-roll 0.5"));
    for options in ["--seed 2", "--intensity 0.5", "--turbulence 2", "--wind 2", "--pre-roll 0.6", "--refine 1"] {
        assert_ne!(plain, run("c.wav", options), "{options} changes nothing");
    }
}

/// Stopped by Ctrl-C and called again, it goes on where it was and gives what an uninterrupted run gives.
#[cfg(unix)]
#[test]
fn an_interrupted_simulation_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let run = "simulate campfire --resolution 16 --pre-roll 0 --cache frames --output fire.wav --flux-csv fire.csv";
    let mut child = Command::new(env!("CARGO_BIN_EXE_pyrophone"))
        .current_dir(folder.path())
        .args(run.split(' ').chain(["--seconds", "3600"]))
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let began = Instant::now();
    while !folder.path().join("frames/campfire_000010.npz").exists() {
        assert!(began.elapsed() < Duration::from_secs(120), "no frame was written");
        std::thread::sleep(Duration::from_millis(20));
    }
    let stopped = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(stopped.success());
    assert_eq!(child.wait().unwrap().signal(), Some(2), "it dies of the signal");
    let progress = "fire.wav.simulation-progress";
    assert!(folder.path().join(progress).exists() && !folder.path().join("fire.wav").exists());
    // The settings are the same but for the length.
    let done = std::fs::read_dir(folder.path().join("frames")).unwrap().count();
    let seconds = (done + 30) as f64 / 360.0;
    succeeds(folder.path(), &format!("{run} --seconds {seconds}"));
    assert!(!folder.path().join(progress).exists());
    let other = run.replace("frames", "others").replace("fire.", "whole.");
    succeeds(folder.path(), &format!("{other} --seconds {seconds}"));
    assert_eq!(bytes(folder.path(), "fire.csv"), bytes(folder.path(), "whole.csv"));
    assert_eq!(bytes(folder.path(), "fire.wav"), bytes(folder.path(), "whole.wav"));
}

#[test]
fn progress_of_another_run_is_not_gone_on_with() {
    let folder = tempfile::tempdir().unwrap();
    let run = "simulate candle --resolution 16 --seconds 0.05 --pre-roll 0 --output fire.wav";
    succeeds(folder.path(), run);
    let expected = bytes(folder.path(), "fire.wav");
    for garbage in [&b"12\nhello world!"[..], b"", b"99999999999999999999\n", &[255; 100]] {
        std::fs::write(folder.path().join("fire.wav.simulation-progress"), garbage).unwrap();
        succeeds(folder.path(), run);
        assert_eq!(bytes(folder.path(), "fire.wav"), expected);
    }
}

/// Frames of two runs in one folder would be measured as one.
#[test]
fn a_cache_is_not_mixed_with_another() {
    let folder = tempfile::tempdir().unwrap();
    let run = "simulate candle --resolution 16 --pre-roll 0 --cache frames --output fire.wav";
    succeeds(folder.path(), &format!("{run} --seconds 0.05"));
    succeeds(folder.path(), &format!("{run} --seconds 0.05 --seed 2"));
    refuses(folder.path(), &format!("{run} --seconds 0.03"), 1, &["frames", "candle_0000", "another run"]);
    let other = run.replace("candle", "torch");
    refuses(folder.path(), &format!("{other} --seconds 0.05"), 1, &["frames", "candle_0000", "another run"]);
}

/// Less fuel makes a smaller sound, not none, until there is none.
#[test]
fn a_weak_torch_burns() {
    let folder = tempfile::tempdir().unwrap();
    let run = "simulate torch --resolution 16 --seconds 0.1 --output fire.wav";
    succeeds(folder.path(), &format!("{run} --intensity 0.3"));
    assert!(read(&folder.path().join("fire.wav")).channels[0].iter().any(|sample| *sample != 0.0));
    let output = crate::common::pyrophone(folder.path(), &format!("{run} --intensity 0"));
    assert!(output.status.success() && String::from_utf8(output.stderr).unwrap().contains("silent"));
}

#[test]
fn senseless_options_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |options: &str, says: &[&str]| {
        refuses(folder.path(), &format!("simulate candle --seconds 0.05 {options}"), 1, says);
    };
    refused("", &["nothing to write"]);
    refused("--output a.wav --resolution 7", &["resolution", "7", "8", "512"]);
    refused("--output a.wav --resolution 100000", &["resolution"]);
    refused("--output a.wav --wind nan", &["wind", "0", "4"]);
    refused("--output a.wav --pre-roll -1", &["--pre-roll"]);
    refused("--output a.wav --refine 0", &["refinement"]);
    refused("--output nowhere/a.wav", &["no folder nowhere"]);
    refuses(folder.path(), "simulate candle --seconds 0 --output a.wav", 1, &["--seconds"]);
    let output = crate::common::pyrophone(folder.path(), "simulate bonfire --output a.wav");
    assert_eq!(output.status.code(), Some(2));
}
