//! `--json` and `--quiet`: their shape is a promise to scripts.

use crate::common::{hiss, pyrophone, read, rumble, write};
use pyrophone_recording::samples_hash;
use serde_json::Value;
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "noise.wav", &[hiss(48_000, 1), hiss(48_000, 2)], 48_000);
    write(folder.path(), "hum.wav", &[rumble(24_000, 48_000)], 48_000);
    folder
}

/// The object on standard output.
#[track_caller]
fn summary(folder: &TempDir, arguments: &str) -> Value {
    let output = pyrophone(folder.path(), arguments);
    assert!(output.status.success(), "{arguments}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{arguments}: {error}"))
}

#[test]
fn shape_of_the_summary() {
    let folder = folder();
    // The input as it is, so that every machine writes the same samples.
    let command = "render --preset extend --set bypass=on --input noise.wav --output out.wav --json";
    let output = pyrophone(folder.path(), command);
    insta::assert_snapshot!("summary", String::from_utf8(output.stdout).unwrap());
}

#[test]
fn every_command_that_writes_tells_the_same_keys() {
    let folder = folder();
    let keys = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    let render = summary(&folder, "render --preset extend --input hum.wav --output a.wav --json");
    for (arguments, command, is_sound) in [
        ("texture --input hum.wav --training noise.wav --output b.wav", "texture", true),
        ("extend --input hum.wav --output c.wav --betas c.csv", "extend", true),
        (
            "simulate candle --resolution 16 --seconds 0.05 --pre-roll 0 --output d.wav --flux-csv d.csv",
            "simulate",
            true,
        ),
        ("flux --input d.csv --rate 360 --output e.wav", "flux", true),
        (
            "vortex-texture --speeds 2:4:2 --seconds 0.25 --voxels 8x8x8 --rate 2000 --output f.vtx",
            "vortex-texture",
            false,
        ),
        ("man --output pages", "man", false),
    ] {
        let printed = summary(&folder, &format!("{arguments} --json"));
        assert_eq!(keys(&printed), keys(&render), "{arguments}");
        assert_eq!(printed["command"], command);
        assert_eq!(printed["hash"].is_string(), is_sound, "{arguments}");
        for file in printed["files"].as_array().unwrap() {
            assert!(folder.path().join(file.as_str().unwrap()).is_file(), "{arguments}: {file}");
        }
    }
}

#[test]
fn figures_are_those_of_the_file_that_was_written() {
    let folder = folder();
    for (name, arguments) in
        [("a.wav", "--set output_level=-6"), ("a.flac", ""), ("loud.flac", "--set output_level=24 --set ceiling=off")]
    {
        let printed =
            summary(&folder, &format!("--json render --preset extend {arguments} --input noise.wav --output {name}"));
        let file = read(&folder.path().join(name));
        assert_eq!(printed["hash"], samples_hash(&file.channels), "{name}");
        assert_eq!(printed["seconds"], 1.0);
        assert_eq!((printed["channels"].as_u64(), printed["sample_rate_hz"].as_u64()), (Some(2), Some(48_000)));
        assert!(printed["latency_samples"].as_u64().unwrap() > 0);
        assert!(printed["lufs"].as_f64().unwrap() < 24.0, "{printed}");
        let notes = printed["notes"].as_array().unwrap();
        let clips = notes.iter().any(|note| note.as_str().unwrap().contains("clipped"));
        assert_eq!(clips, name == "loud.flac", "{notes:?}");
    }
}

#[test]
fn too_loud_and_too_quiet_outputs_are_noted_with_their_peak() {
    let folder = folder();
    let render = "render --preset extend --set bypass=on --input noise.wav --output a.wav --json";
    assert_eq!(summary(&folder, render)["notes"], Value::Array(vec![]));
    for (factor, says) in [(20.0, "dBFS, where players clip"), (0.01, "LUFS, with a peak of -60.0 dBFS")] {
        let sound: Vec<f32> = hiss(48_000, 1).iter().map(|sample| factor * sample).collect();
        write(folder.path(), "noise.wav", &[sound], 48_000);
        let notes = summary(&folder, render)["notes"].clone();
        assert!(notes.as_array().unwrap().len() == 1 && notes[0].as_str().unwrap().contains(says), "{notes}");
        let plain = pyrophone(folder.path(), &render.replace(" --json", ""));
        let printed = String::from_utf8(plain.stderr).unwrap();
        assert!(printed.starts_with("note: ") && printed.contains(says), "{printed}");
        assert!(plain.stdout.is_empty());
    }
}

#[test]
fn quiet_leaves_only_errors() {
    let folder = folder();
    let noted = "render --preset default --input hum.wav --output a.wav";
    assert!(!pyrophone(folder.path(), noted).stderr.is_empty());
    for quiet in ["--quiet", "-q"] {
        let output = pyrophone(folder.path(), &format!("{noted} {quiet}"));
        assert!(output.status.success() && output.stderr.is_empty() && output.stdout.is_empty());
    }
    let with_summary = summary(&folder, &format!("{noted} --quiet --json"));
    assert!(!with_summary["notes"].as_array().unwrap().is_empty(), "notes are in the summary all the same");
    let refused = pyrophone(folder.path(), "render --preset none --input hum.wav --output a.wav --quiet");
    assert!(String::from_utf8(refused.stderr).unwrap().starts_with("error: "));
}
