//! `pyrophone flux-plan`: jobs that run, and make what one run makes.

mod common;

use std::fs::File;
use std::path::Path;
use std::process::Command;

use common::{pyrophone, refuses, succeeds};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use tempfile::TempDir;

/// Voxels along an edge.
const SIZE: usize = 12;

/// A folder with spaces in its name and `fire 1.npz` to `fire 17.npz`: a ball of flame that breathes.
fn cache() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("the cache")).unwrap();
    for number in 1..=17 {
        let radius = 4.0 + 0.7 * f64::from(number * number).sin();
        let count = SIZE * SIZE * SIZE;
        let from_middle = |n: usize| [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64 - 5.5);
        let away = |n: usize| from_middle(n).iter().map(|x| x * x).sum::<f64>().sqrt();
        let frame = DenseFrame {
            shape: [SIZE; 3],
            flame: &(0..count).map(|n| [(0.5 + 0.5 * (radius - away(n))).clamp(0.0, 1.0) as f32]).collect::<Vec<_>>(),
            velocity: &(0..count).map(|n| from_middle(n).map(|x| x as f32)).collect::<Vec<_>>(),
            voxel_size: 0.1,
            origin: [0.0; 3],
            time_s: None,
        };
        let path = folder.path().join("the cache").join(format!("fire {number}.npz"));
        write_frame(File::create(path).unwrap(), &frame).unwrap();
    }
    folder
}

/// `flux-plan` with arguments that may have spaces.
fn plan(at: &Path, format: &str, job: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    command.current_dir(at).args(["flux-plan", "--input", "the cache", "--chunk", "5", "--rate", "24", "--skip-bad"]);
    command.args(["--format", format, "--output", "farm.wav", "--job", job, "--merge-option=--peak-db=-9"]);
    let output = command.args(["--", "--refine", "2", "--upsample-seed", "3"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Result of a single run.
fn whole(at: &Path) -> Vec<u8> {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    command.current_dir(at).args([
        "flux",
        "--input",
        "the cache",
        "--rate",
        "24",
        "--refine",
        "2",
        "--upsample-seed",
        "3",
    ]);
    let output = command.args(["--peak-db=-9", "--output", "whole.wav"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    std::fs::read(at.join("whole.wav")).unwrap()
}

#[test]
#[cfg(unix)]
fn a_shell_job_makes_what_one_run_makes() {
    let folder = cache();
    let at = folder.path();
    plan(at, "shell", "job.sh");
    for threads in ["1", "3"] {
        let status =
            Command::new("sh").arg("job.sh").current_dir(at).env("RAYON_NUM_THREADS", threads).status().unwrap();
        assert!(status.success());
        assert_eq!(std::fs::read(at.join("farm.wav")).unwrap(), whole(at), "{threads} threads");
    }
    assert_eq!(at.join("farm.wav.parts").read_dir().unwrap().count(), 4);
    // One part is cut, as by a full disk: the merge says which.
    let part = at.join("farm.wav.parts/part_6-10.csv");
    let text = std::fs::read_to_string(&part).unwrap();
    std::fs::write(&part, &text[..text.len() / 2]).unwrap();
    refuses(at, "flux-merge farm.wav.parts --output x.wav", 1, &["part_6-10.csv", "cut or changed"]);
    std::fs::create_dir(at.join("empty")).unwrap();
    refuses(at, "flux-merge empty --output x.wav", 1, &["empty", "no parts"]);
}

/// Runs where `openjd` is installed (`pip install openjd-cli`).
#[test]
#[cfg(unix)]
fn an_open_job_makes_what_one_run_makes() {
    if Command::new("openjd").arg("--version").output().is_err() {
        eprintln!("skipped: openjd is not installed (pip install openjd-cli)");
        return;
    }
    let folder = cache();
    let at = folder.path();
    plan(at, "openjd", "job.json");
    let run = |arguments: &[&str]| {
        let output = Command::new("openjd").args(arguments).current_dir(at).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{arguments:?}: {said}{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["check", "job.json"]);
    run(&["run", "job.json", "--step", "Measure"]);
    run(&["run", "job.json", "--step", "Merge"]);
    assert_eq!(std::fs::read(at.join("farm.wav")).unwrap(), whole(at));
}

#[test]
fn plans_that_make_no_sense_are_refused() {
    let folder = cache();
    let at = folder.path();
    std::fs::rename(at.join("the cache"), at.join("cache")).unwrap();
    refuses(at, "flux-plan --input none --format shell --output x.wav", 1, &["none", "no such"]);
    refuses(at, "flux-plan --input cache --chunk 0 --format shell --output x.wav", 1, &["--chunk", "0"]);
    refuses(at, "flux-plan --input cache --format pbs --output x.wav", 2, &["pbs", "slurm"]);
    succeeds(at, "flux-plan --input cache --format slurm --output x.wav --job job.sh");
    let printed = pyrophone(at, "flux-plan --input cache --format slurm --output x.wav").stdout;
    assert_eq!(printed, std::fs::read(at.join("job.sh")).unwrap());
}
