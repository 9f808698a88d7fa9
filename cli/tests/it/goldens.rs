//! The commands against the reference data.

use std::path::Path;

use crate::common::{doubles, read, reference, succeeds, write};

#[track_caller]
fn equals_golden(output: &Path, golden: &Path) {
    let output = read(output);
    let golden = doubles(golden);
    assert_eq!(output.channels.len(), 1);
    assert_eq!(output.len_samples(), golden.len());
    assert!(golden.iter().any(|sample| sample.abs() > 1e-3), "a silent golden proves nothing");
    let differing =
        output.channels[0].iter().zip(&golden).filter(|(found, golden)| found.to_bits() != (**golden as f32).to_bits());
    assert_eq!(differing.count(), 0);
}

#[test]
fn texture_of_burning_brick() {
    let Some(reference) = reference() else { return };
    let folder = tempfile::tempdir().unwrap();
    let (signals, training) = (reference.join("signals"), reference.join("training"));
    let (signal, training) = (signals.join("burning_brick.wav"), training.join("burning_brick.wav"));
    let arguments = format!("texture --input {} --training {} --output out.wav", signal.display(), training.display());
    succeeds(folder.path(), &arguments);
    equals_golden(&folder.path().join("out.wav"), &reference.join("texture/burning_brick.f64"));
}

#[test]
fn texture_with_other_settings() {
    let Some(reference) = reference() else { return };
    for variant in ["variant_a", "variant_b"] {
        let folder = tempfile::tempdir().unwrap();
        let text = std::fs::read_to_string(reference.join(format!("texture/{variant}.json"))).unwrap();
        let settings: serde_json::Value = serde_json::from_str(&text).unwrap();
        let pair = settings["pair"].as_str().unwrap();
        for kind in ["input", "training"] {
            let source = if kind == "input" { "signals" } else { "training" };
            let whole = read(&reference.join(source).join(format!("{pair}.wav")));
            let at = |end: usize| settings[format!("{kind}_samples")][end].as_u64().unwrap() as usize;
            write(folder.path(), &format!("{kind}.wav"), &[whole.channels[0][at(0)..at(1)].to_vec()], 44_100);
        }
        let mut arguments = "texture --input input.wav --training training.wav --output out.wav".to_string();
        for option in ["levels", "window", "feature", "falloff", "scaling_alpha"] {
            arguments += &format!(" --{} {}", option.replace('_', "-"), settings[option]);
        }
        if settings["dynamic_range"] == false {
            arguments += " --no-dynamic-range";
        }
        succeeds(folder.path(), &arguments);
        equals_golden(&folder.path().join("out.wav"), &reference.join(format!("texture/{variant}.f64")));
    }
}

#[test]
fn extension_as_published() {
    let Some(reference) = reference() else { return };
    let folder = tempfile::tempdir().unwrap();
    let signal = reference.join("signals/burning_brick.wav");
    let arguments =
        format!("extend --reference --alpha 3 --input {} --output out.wav --betas betas.csv", signal.display());
    succeeds(folder.path(), &arguments);

    let output = read(&folder.path().join("out.wav"));
    let golden = doubles(&reference.join("extend/burning_brick_alpha3.0.f64"));
    let peak = golden.iter().fold(0.0f64, |peak, sample| peak.max(sample.abs()));
    assert_eq!(output.len_samples(), golden.len());
    for (found, golden) in output.channels[0].iter().zip(&golden) {
        // 1e-10 of the peak, and the rounding to 32-bit float.
        let allowed = 1e-10 * peak + golden.abs() * f64::from(f32::EPSILON) / 2.0;
        assert!((f64::from(*found) - golden).abs() <= allowed, "{found} instead of {golden}");
    }

    let golden = doubles(&reference.join("extend/burning_brick_alpha3.0.betas.f64"));
    let text = std::fs::read_to_string(folder.path().join("betas.csv")).unwrap();
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("window,time_s,beta"));
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|field| field.parse().unwrap()).collect()).collect();
    assert_eq!(rows.len(), golden.len());
    for (window, (row, golden)) in rows.iter().zip(&golden).enumerate() {
        assert_eq!(row[..2], [window as f64, window as f64 * 500.0 / 44_100.0]);
        assert!((row[2] - golden).abs() <= 1e-10 * golden.abs(), "window {window}: {} instead of {golden}", row[2]);
    }
}
