//! What the commands write: length, rate, channels, and what the options do.

mod common;

use std::path::Path;

use common::{hiss, read, rumble, succeeds, write};
use tempfile::TempDir;

fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    write(at, "mono.wav", &[rumble(30_000, 48_000)], 48_000);
    write(at, "stereo.wav", &[rumble(30_000, 48_000), rumble(30_000, 48_000)], 48_000);
    write(at, "fire.wav", &[hiss(40_000, 1), hiss(40_000, 2)], 44_100);
    write(at, "side.wav", &[hiss(9_000, 4)], 32_000);
    folder
}

fn peak(path: &Path) -> f32 {
    read(path).channels.iter().flatten().fold(0.0, |peak, sample| peak.max(sample.abs()))
}

/// Runs a command with its output, and gives the output's path.
#[track_caller]
fn made(folder: &TempDir, name: &str, arguments: &str) -> std::path::PathBuf {
    succeeds(folder.path(), &format!("{arguments} --output {name}"));
    folder.path().join(name)
}

#[test]
fn length_rate_and_channels() {
    let folder = folder();
    for (number, (arguments, channels)) in [
        ("texture --input mono.wav --training fire.wav", 2),
        ("texture --input stereo.wav --training side.wav", 1),
        ("extend --input mono.wav", 1),
        ("extend --input stereo.wav", 2),
        ("extend --reference --input stereo.wav", 2),
        ("render --preset default --input mono.wav --training fire.wav", 1),
        ("render --preset default --input mono.wav --training fire.wav --channels 2", 2),
        ("render --preset default --input stereo.wav --training fire.wav", 2),
        ("render --preset extend --input mono.wav --sidechain side.wav --set drive_mode=envelope", 1),
        ("render --preset texture-paper --input mono.wav --training fire.wav --dynamic-range running", 1),
    ]
    .iter()
    .enumerate()
    {
        let path = made(&folder, &format!("{number}.wav"), arguments);
        let output = read(&path);
        assert_eq!(
            (output.sample_rate_hz, output.len_samples(), output.channels.len()),
            (48_000, 30_000, *channels),
            "{arguments}"
        );
        assert!(peak(&path) > 1e-3, "{arguments}: silence");
    }
}

#[test]
fn the_same_twice_and_other_with_another_seed() {
    let folder = folder();
    let once = std::fs::read(made(&folder, "1.wav", "extend --input mono.wav")).unwrap();
    let twice = std::fs::read(made(&folder, "2.wav", "extend --input mono.wav --seed 42")).unwrap();
    let other = std::fs::read(made(&folder, "3.wav", "extend --input mono.wav --seed 43")).unwrap();
    assert_eq!(once, twice);
    assert_ne!(once, other);
}

#[test]
fn low_part_of_the_extension_is_in_time() {
    let folder = folder();
    let path = made(&folder, "low.wav", "extend --input mono.wav --noise-amplitude 0 --cutoff 400 --fit-center 400");
    let (input, output) = (rumble(30_000, 48_000), read(&path));
    for (n, (output, input)) in output.channels[0].iter().zip(&input).enumerate().take(24_000).skip(6000) {
        assert!((output - input).abs() < 0.005, "sample {n}: {output} instead of {input}");
    }
}

#[test]
fn settings_and_automation_act() {
    let folder = folder();
    let plain = read(&made(&folder, "plain.wav", "render --preset extend --input mono.wav"));
    let silent = made(&folder, "off.wav", "render --preset extend --input mono.wav --set output_level=-60");
    assert!(peak(&silent) < 0.002 * plain.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs())));

    std::fs::write(folder.path().join("steps.csv"), "sample,id,value\n15000,output_level,-60\n").unwrap();
    let stepped = "render --preset extend --input mono.wav --automation steps.csv";
    let stepped = read(&made(&folder, "stepped.wav", stepped));
    assert_eq!(stepped.channels[0][..14_000], plain.channels[0][..14_000]);
    for (stepped, plain) in stepped.channels[0].iter().zip(&plain.channels[0]).skip(18_000) {
        assert!(
            (stepped - 0.001 * plain).abs() < 1e-4 * plain.abs() + 1e-7,
            "{stepped} after the step, {plain} without"
        );
    }
}

#[test]
fn learning_from_the_input_is_the_default() {
    let folder = folder();
    let render = "render --preset texture --training fire.wav --input mono.wav --dynamic-range learned";
    let pass = std::fs::read(made(&folder, "pass.wav", render)).unwrap();
    let same = std::fs::read(made(&folder, "same.wav", &format!("{render} --learn mono.wav"))).unwrap();
    let other = std::fs::read(made(&folder, "other.wav", &format!("{render} --learn side.wav"))).unwrap();
    assert_eq!(pass, same);
    assert_ne!(pass, other);
}

#[test]
fn bypass_is_the_input() {
    let folder = folder();
    let path = made(&folder, "dry.wav", "render --preset default --training fire.wav --input mono.wav --set bypass=on");
    assert_eq!(read(&path).channels, [rumble(30_000, 48_000)]);
}

#[test]
fn betas_without_reference() {
    let folder = folder();
    made(&folder, "out.wav", "extend --input mono.wav --betas betas.csv");
    let text = std::fs::read_to_string(folder.path().join("betas.csv")).unwrap();
    let rows: Vec<&str> = text.lines().collect();
    // 500 samples at 44.1 kHz are 544 at 48 kHz.
    assert_eq!(rows[0], "window,time_s,beta");
    assert_eq!(rows.len(), 1 + 30_000usize.div_ceil(544) + 1);
    assert!(rows[2].starts_with("1,0.01133333"), "{}", rows[2]);
    let betas: Vec<f64> = rows[1..].iter().map(|row| row.rsplit(',').next().unwrap().parse().unwrap()).collect();
    assert!(betas[5..50].iter().all(|beta| *beta > 0.0), "{betas:?}");
}
