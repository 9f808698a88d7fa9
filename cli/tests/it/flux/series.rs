//! Series of flux, without frames.

use std::path::Path;

use super::{bytes, folder, notes, table};
use crate::common::{read, refuses, succeeds, write};

#[test]
fn a_series_goes_straight_to_pressure() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let flux: Vec<f64> = (0..720).map(|step| (std::f64::consts::TAU * 60.0 * f64::from(step) / 360.0).sin()).collect();
    let rows: String = flux.iter().enumerate().map(|(frame, flux)| format!("{frame},{flux:?},1\n")).collect();
    std::fs::write(at.join("flux.csv"), format!("frame,flux,area\n{rows}")).unwrap();
    succeeds(at, "flux --input flux.csv --output csv.wav --time-reference 12345678901 --rate 360");
    let sound = read(&at.join("csv.wav"));
    assert_eq!((sound.sample_rate_hz, sound.len_samples(), sound.channels.len()), (44_100, 88_200, 1));
    let file = bytes(at, "csv.wav");
    let bext = file.windows(4).position(|id| id == b"bext").unwrap() + 8;
    assert_eq!(file[bext + 338..bext + 346], 12_345_678_901u64.to_le_bytes());
    // A sound's samples are steps at its own rate.
    let dense: Vec<f32> = (0..4000).map(|n| (std::f32::consts::TAU * 60.0 * n as f32 / 2000.0).sin()).collect();
    write(at, "dense.wav", &[dense], 2000);
    succeeds(at, "flux --input dense.wav --output dense_out.wav");
    let dense = read(&at.join("dense_out.wav"));
    assert_eq!(dense.len_samples(), 88_200);
    // Both are cosines of 60 Hz at -6 dB.
    let far = (40_000..50_000).map(|n| (dense.channels[0][n] - sound.channels[0][n]).abs()).fold(0.0, f32::max);
    assert!(far < 0.1, "{far}");
    for option in ["--rate 100", "--iso 0.5", "--partial x.csv", "--frames 1-2", "--flux-csv y.csv", "--mesh z"] {
        let name = option.split(' ').next().unwrap();
        refuses(
            at,
            &format!("flux --input dense.wav --output x.wav {option}"),
            1,
            &["dense.wav", name, "leave it out"],
        );
    }
    refuses(at, "flux --input dense.wav --output dense.wav", 1, &["dense.wav", "overwrite"]);
    refuses(at, "flux --input flux.csv --output flux.csv", 1, &["flux.csv", ".csv files cannot be written"]);
    std::fs::write(at.join("bad.csv"), "frame,flux\n1,2\n2,x\n").unwrap();
    refuses(at, "flux --input bad.csv --output x.wav", 1, &["bad.csv", "line 3"]);
    std::fs::write(at.join("still.csv"), "1.5\n".repeat(100)).unwrap();
    succeeds(at, "flux --input still.csv --output still.wav --rate 360");
    assert!(read(&at.join("still.wav")).channels[0].iter().all(|sample| *sample == 0.0));
}

/// A series of few steps is as good as a cache of few frames, but for its parts.
#[test]
fn a_series_at_the_rate_of_film_is_upsampled() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let burst = |frame: i32| if frame % 12 < 3 { 5.0 } else { 1.0 };
    let rows: String = (0..96).map(|n| format!("{:?}\n", burst(n) + 0.1 * f64::from(n * n % 7))).collect();
    std::fs::write(at.join("film.csv"), rows).unwrap();
    let said = notes(at, "flux --input film.csv --rate 24 --output auto.wav");
    assert!(
        said.contains("upsampled to 360 steps (--upsample noise)") && said.contains("plausible, not true"),
        "{said}"
    );
    // The bursts are a quarter of the time, and louder.
    let sound = read(&at.join("auto.wav")).channels[0].clone();
    let power = |is_wanted: &dyn Fn(usize) -> bool| -> f64 {
        let samples = sound.iter().enumerate().filter(|(n, _)| is_wanted(n * 24 / 44_100 % 12));
        samples.map(|(_, x)| f64::from(x * x)).sum::<f64>()
    };
    let [burst, pause] = [power(&|frame| frame == 1), power(&|frame| (5..10).contains(&frame)) / 5.0];
    assert!(burst > 10.0 * pause && pause > 0.0, "{burst} {pause}");
    assert!(!notes(at, "flux --input film.csv --rate 24 --as envelope --output x.wav").contains("plausible"));
    for method in ["flips", "release"] {
        let command = format!("flux --input film.csv --rate 24 --upsample {method} --output x.wav");
        refuses(at, &command, 1, &["film.csv", "a series", "--upsample noise"]);
    }
}

/// Two flames of a shot keep their balance.
#[test]
fn flames_of_a_shot_share_their_scale() {
    let folder = folder();
    let at = folder.path();
    let flux = table_of(at, "flux --input flame");
    let scaled = |factor: f64| flux.iter().map(|flux| format!("{:?}\n", factor * flux)).collect::<String>();
    std::fs::write(at.join("loud.csv"), scaled(1.0)).unwrap();
    std::fs::write(at.join("soft.csv"), scaled(0.25)).unwrap();
    for name in ["loud", "soft"] {
        succeeds(at, &format!("flux --input {name}.csv --rate 360 --output {name}.wav --scale-file shot.scale"));
    }
    let [loud, soft] = ["loud.wav", "soft.wav"].map(|name| read(&at.join(name)).channels[0].clone());
    let peak = |samples: &[f32]| samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!((peak(&soft) / peak(&loud) - 0.25).abs() < 1e-3, "{} {}", peak(&soft), peak(&loud));
    std::fs::write(at.join("bad.scale"), "loud").unwrap();
    refuses(at, "flux --input loud.csv --rate 360 --output x.wav --scale-file bad.scale", 1, &["bad.scale"]);
}

/// The flux that a command writes to a table.
fn table_of(at: &Path, command: &str) -> Vec<f64> {
    succeeds(at, &format!("{command} --flux-csv of.csv"));
    table(at, "of.csv").rows.iter().map(|row| row.flux).collect()
}
