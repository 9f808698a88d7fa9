//! The reference module against the golden data.

use std::f64::consts::TAU;

use crate::common::{read_f64, read_wav, reference_dir};
use maths::fft::{Complex64, ComplexTransform};
use pyrophone_synthesis::Error;
use pyrophone_synthesis::extend::reference::*;

const RATE_HZ: f64 = 44_100.0;

/// Fails unless all values agree to `tolerance` of the largest expected one.
fn assert_close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}: length");
    let peak = expected.iter().fold(0.0f64, |peak, x| peak.max(x.abs()));
    let worst = found.iter().zip(expected).fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(peak > 0.0 && worst <= tolerance * peak, "{what}: off by {worst:e}, peak {peak:e}");
}

#[test]
fn kernels_match() {
    let Some(folder) = reference_dir() else { return };
    let kernel = |name: &str| read_f64(&folder.join("kernels").join(name));
    let axis = frequency_axis(1024, RATE_HZ);
    let (lower, upper) = blend_ramps(&axis, 165.0, 195.0);
    assert_close("blend1", &lower, &kernel("extend_blend1.f64"), 1e-14);
    assert_close("blend2", &upper, &kernel("extend_blend2.f64"), 1e-14);
    assert_close("gaussian", &gaussian(&axis, 180.0, 10.0), &kernel("extend_gaussian.f64"), 1e-14);
    let magnitude: Vec<f64> = noise_spectrum(&axis, 2.5, &mut Pcg32::new(42)).iter().map(|bin| bin.norm()).collect();
    assert_close("power law", &magnitude, &kernel("extend_powerlaw_mag.f64"), 1e-14);
    let tones = [(0.6, 100.0), (0.3, 800.0), (0.1, 4500.0)];
    let signal: Vec<f64> = (0..4410)
        .map(|n| tones.iter().map(|(gain, hz)| gain * (TAU * hz * f64::from(n) / RATE_HZ).sin()).sum())
        .collect();
    assert_close("low-pass", &zero_phase_low_pass(&signal, 180.0, RATE_HZ), &kernel("extend_lowpass.f64"), 1e-12);
    let window = kernel("extend_window_500_L1024.f64");
    let streaming = pyrophone_synthesis::extend::window::triangle(500);
    let peak = window.iter().position(|x| *x == 1.0).expect("a peak");
    assert_close("triangle", &streaming, &window[peak - 500..peak + 500], 1e-15);
}

#[test]
fn random_draws_match() {
    let expected = [
        0.4421448060311377,
        0.23623736714944243,
        0.9536763080395758,
        0.14759166655130684,
        0.2652577902190387,
        0.56567323487252,
        0.3210757712367922,
        0.3276327084749937,
    ];
    let mut generator = Pcg32::new(42);
    for (draw, value) in expected.iter().enumerate() {
        assert!((generator.next_unit() - value).abs() < 1e-15, "draw {draw}");
    }
}

/// One beta; the data's note: here alone no draw was made at bin 0.
#[test]
fn one_beta_matches() {
    const BINS: usize = 256;
    let mut drive: Vec<Complex64> =
        (0..BINS).map(|n| n as f64 / RATE_HZ).map(|t| ((-30.0 * t).exp() * (TAU * 120.0 * t).sin()).into()).collect();
    ComplexTransform::new(BINS).forward(&mut drive);
    let axis = frequency_axis(BINS, RATE_HZ);
    let (lower, upper) = blend_ramps(&axis, 165.0, 195.0);
    let mut phases = Pcg32::new(7);
    let mut noise = vec![Complex64::default()];
    noise.extend(noise_spectrum(&axis[1..], 2.5, &mut phases));
    noise.iter_mut().zip(&upper).for_each(|(bin, upper)| *bin *= upper);
    let beta = fit(&axis, &gaussian(&axis, 180.0, 10.0), &lower, &drive, &noise);
    assert!((beta / 104_427.304_436_688_38 - 1.0).abs() < 1e-10, "{beta}");
}

#[test]
fn goldens_match() {
    let Some(folder) = reference_dir() else { return };
    let mut checked = 0;
    for entry in std::fs::read_dir(folder.join("extend")).expect("goldens") {
        let path = entry.expect("a golden").path();
        let name = path.file_name().and_then(|name| name.to_str()).expect("a name").to_owned();
        let Some((signal, alpha)) = name
            .strip_suffix(".f64")
            .filter(|stem| !stem.ends_with(".betas"))
            .and_then(|stem| stem.split_once("_alpha"))
        else {
            continue;
        };
        let (channels, rate) = read_wav(&folder.join(format!("signals/{signal}.wav")));
        let settings = Settings { alpha: alpha.parse().expect("alpha"), ..Settings::new(f64::from(rate)) };
        let found = extend(&channels[0], &settings, &mut |_| true).expect("extends");
        let golden_betas = read_f64(&path.with_extension("betas.f64"));
        assert_eq!(found.betas.len(), golden_betas.len(), "{name}");
        for (window, (beta, golden)) in found.betas.iter().zip(&golden_betas).enumerate() {
            assert!(
                (beta - golden).abs() <= 1e-10 * golden.abs(),
                "{name} window {window}: {beta} instead of {golden}"
            );
        }
        assert_close(&name, &found.samples, &read_f64(&path), 1e-10);
        checked += 1;
    }
    assert!(checked >= 5, "only {checked} goldens found");
}

#[test]
fn silence_gives_silence_and_betas_of_zero() {
    let found = extend(&[0.0; 3000], &Settings::new(RATE_HZ), &mut |_| true).expect("extends");
    assert!(found.samples.iter().all(|sample| *sample == 0.0));
    assert_eq!(found.betas, [0.0; 7]);
}

#[test]
fn refuses_with_a_reason() {
    let settings = Settings::new(RATE_HZ);
    let go = |signal: &[f64], settings: &Settings| extend(signal, settings, &mut |_| true).unwrap_err();
    assert!(matches!(go(&[0.0; 499], &settings), Error::TooShort { found: 499, least: 500, .. }));
    assert!(matches!(go(&[], &Settings { half_width: 1, ..settings }), Error::TooShort { .. }));
    let mut bad = vec![0.0; 1000];
    bad[700] = f64::NAN;
    assert!(matches!(go(&bad, &settings), Error::NotFinite { at: 700, .. }));
    for wrong in [
        Settings { alpha: 7.0, ..settings },
        Settings { alpha: f64::NAN, ..settings },
        Settings { cutoff_hz: 0.0, ..settings },
        Settings { half_width: 0, ..settings },
        Settings { fit_width_hz: 0.0, ..settings },
        Settings { blend_end_hz: 165.0, ..settings },
        Settings { noise_amplitude: -1.0, ..settings },
        Settings { sample_rate_hz: 0.0, ..settings },
    ] {
        assert!(matches!(go(&[0.0; 1000], &wrong), Error::OutOfRange { .. }), "{wrong:?}");
    }
    assert_eq!(extend(&[0.0; 1000], &settings, &mut |_| false), Err(Error::Cancelled));
}
