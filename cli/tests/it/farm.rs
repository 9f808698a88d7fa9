//! `pyrophone flux-plan`: jobs that run, and make what one run makes.

use std::fs::File;
use std::path::Path;
use std::process::Command;

use crate::common::{pyrophone, refuses, succeeds};
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

/// One run over all frames, with a speed field and a report, beside the same from parts of every kind.
#[test]
fn speed_fields_and_reports_of_parts_are_those_of_one_run() {
    let folder = cache();
    let at = folder.path();
    std::fs::rename(at.join("the cache"), at.join("cache")).unwrap();
    // A frame before ignition in which gas moves already, and one that cannot be read.
    let count = SIZE * SIZE * SIZE;
    let unlit = DenseFrame {
        shape: [SIZE; 3],
        flame: &vec![[0.0]; count],
        velocity: &vec![[0.1, 0.3, 0.0]; count],
        voxel_size: 0.1,
        origin: [0.0; 3],
        time_s: None,
    };
    write_frame(File::create(at.join("cache/fire 1.npz")).unwrap(), &unlit).unwrap();
    std::fs::write(at.join("cache/fire 9.npz"), "no frame").unwrap();
    let of_cache = "flux --input cache --refine 2 --skip-bad";
    for (rate, frames, first, cuts) in
        [(24, "1-17", 1, vec![1, 4, 5, 9, 17]), (360, "1-17", 1, vec![8, 13, 17]), (24, "3-15", 3, vec![3, 9, 15])]
    {
        let whole = format!("{of_cache} --rate {rate} --frames {frames} --start-frame 0 --up y");
        succeeds(at, &format!("{whole} --output one.wav --speed-field one.field --report one"));
        let mut parts = String::new();
        let mut first = first;
        for last in cuts {
            let with = format!("--partial-with speed-field,report --partial-of {frames}");
            let part = format!("{rate}_{frames}_{first}.csv");
            succeeds(at, &format!("{of_cache} --rate {rate} --frames {first}-{last} --partial {part} {with}"));
            parts = format!("{part} {parts}");
            first = last + 1;
        }
        let merge = format!("flux-merge {parts} --start-frame 0 --output all.wav --speed-field all.field --up y");
        succeeds(at, &format!("{merge} --report all"));
        for (one, all) in [("one.wav", "all.wav"), ("one.field", "all.field"), ("one/index.html", "all/index.html")] {
            let [one, all] = [one, all].map(|name| std::fs::read(at.join(name)).unwrap());
            assert_eq!(one.len(), all.len(), "{rate} {frames}");
            assert!(one == all, "{rate} {frames}");
        }
        let page = std::fs::read_to_string(at.join("all/index.html")).unwrap();
        assert!(page.contains("frame 5 "), "a picture of a frame in the middle");
    }
    std::fs::remove_dir_all(at.join("all")).unwrap();
    refuses_extras(at);
}

/// Parts with the wrong extras, or none.
fn refuses_extras(at: &Path) {
    let merge = |parts: &str| format!("flux-merge {parts} --quiet --output x.wav --speed-field x.field");
    refuses(at, &merge("24_1-17_1.csv 24_1-17_2.csv"), 1, &["24_1-17_1.csv", "frames 1-17", "together cover 1-4"]);
    let all = "360_1-17_1.csv 360_1-17_9.csv 360_1-17_14.csv";
    refuses(at, &format!("{} --rate 30", merge(all)), 1, &["--rate is 30", "stride of 12 steps"]);
    let extra = std::fs::read(at.join("360_1-17_9.csv.extra")).unwrap();
    std::fs::write(at.join("360_1-17_9.csv.extra"), &extra[..extra.len() - 1]).unwrap();
    refuses(at, &merge(all), 1, &["360_1-17_9.csv.extra", "truncated or modified"]);
    std::fs::copy(at.join("360_1-17_1.csv.extra"), at.join("360_1-17_9.csv.extra")).unwrap();
    refuses(at, &merge(all), 1, &["360_1-17_9.csv.extra", "does not match the present"]);
    for part in all.split(' ') {
        std::fs::remove_file(at.join(format!("{part}.extra"))).unwrap();
    }
    refuses(at, &merge(all), 1, &["360_1-17_1.csv", "no speeds", "--partial-with"]);
    let wrong = "flux --input cache --rate 24 --frames 1-5 --partial x.csv --partial-with report --partial-of 2-9";
    refuses(at, wrong, 1, &["--partial-of is 2-9", "does not contain frame 1"]);
    refuses(at, "flux --input cache --rate 24 --frames 1-5 --partial-with report --output x.wav", 2, &["--partial"]);
}

/// `flux-plan` with arguments that may have spaces.
fn plan(at: &Path, format: &str, job: &str) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    command.current_dir(at).args(["flux-plan", "--input", "the cache", "--chunk", "5", "--rate", "24", "--skip-bad"]);
    command.args(["--speed-field", "farm.field", "--report", "farm"]);
    command.args(["--format", format, "--output", "farm.wav", "--job", job, "--merge-option=--peak-db=-9"]);
    let output = command.args(["--", "--refine", "2", "--upsample-seed", "3"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

/// Asserts that a job has made what a single run makes.
#[track_caller]
fn is_as_one_run(at: &Path) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_pyrophone"));
    // As the job names it, and so the report.
    command.current_dir(at).arg("flux").arg("--input").arg(at.join("the cache"));
    command.args(["--rate", "24", "--refine", "2", "--upsample-seed", "3", "--peak-db=-9", "--output", "whole.wav"]);
    let output = command.args(["--speed-field", "whole.field", "--report", "whole"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for (made, whole) in
        [("farm.wav", "whole.wav"), ("farm.field", "whole.field"), ("farm/index.html", "whole/index.html")]
    {
        assert!(std::fs::read(at.join(made)).unwrap() == std::fs::read(at.join(whole)).unwrap(), "{made}");
    }
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
        is_as_one_run(at);
    }
    assert_eq!(at.join("farm.wav.parts").read_dir().unwrap().count(), 8, "four parts, each with its extras");
    // One part is cut, as by a full disk: the merge says which.
    let part = at.join("farm.wav.parts/part_6-10.csv");
    let text = std::fs::read_to_string(&part).unwrap();
    std::fs::write(&part, &text[..text.len() / 2]).unwrap();
    refuses(at, "flux-merge farm.wav.parts --output x.wav", 1, &["part_6-10.csv", "truncated or modified"]);
    std::fs::create_dir(at.join("empty")).unwrap();
    refuses(at, "flux-merge empty --output x.wav", 1, &["empty", "no parts"]);
}

/// Runs where `openjd` is installed (`pip install openjd-cli`), or is named by PYROPHONE_OPENJD.
#[test]
#[cfg(unix)]
fn an_open_job_makes_what_one_run_makes() {
    let openjd = std::env::var_os("PYROPHONE_OPENJD").unwrap_or("openjd".into());
    if Command::new(&openjd).arg("--version").output().is_err() {
        crate::common::skip::skip("openjd is not installed (pip install openjd-cli)");
        return;
    }
    let folder = cache();
    let at = folder.path();
    plan(at, "openjd", "job.json");
    let run = |arguments: &[&str]| {
        let output = Command::new(&openjd).args(arguments).current_dir(at).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{arguments:?}: {said}{}", String::from_utf8_lossy(&output.stderr));
    };
    run(&["check", "job.json"]);
    run(&["run", "job.json", "--step", "Measure"]);
    run(&["run", "job.json", "--step", "Merge"]);
    is_as_one_run(at);
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
