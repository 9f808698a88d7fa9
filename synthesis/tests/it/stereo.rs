//! The stereo image of a recording survives: correlation of the channels in three bands, on generated recordings.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::effect::{Event, play};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels};
use pyrophone_synthesis::controls::{Controls, MixControls};
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;

const RATE_HZ: f64 = 44_100.0;
const LAYOUT: Channels = Channels { input: 1, sidechain: 0, output: 2 };
const BANDS_HZ: [[f64; 2]; 3] = [[200.0, 1000.0], [1000.0, 4000.0], [4000.0, 15_000.0]];
/// How far the output's correlation may lie from the recording's.
const TOLERANCE: f64 = 0.15;
const SAMPLES: usize = 200_000;

/// White noise between two frequencies, of unit variance before that: four one-pole filters to each side.
fn band(stream: u32, samples: usize, [low_hz, high_hz]: [f64; 2]) -> Vec<f64> {
    let step = |hz: f64| 1.0 - (-2.0 * PI * hz / RATE_HZ).exp();
    let (low, high, white) = (step(low_hz), step(high_hz.min(0.4 * RATE_HZ)), White::new(9, stream));
    let mut states = [0.0; 8];
    (0..samples as i64)
        .map(|at| {
            let mut value = white.sample_at(at);
            for state in &mut states[..4] {
                *state += high * (value - *state);
                value = *state;
            }
            for state in &mut states[4..] {
                *state += low * (value - *state);
                value -= *state;
            }
            value
        })
        .collect()
}

/// Correlation of two channels in a band.
fn correlation(channels: &[Vec<f64>], band_hz: [f64; 2]) -> f64 {
    let filtered: Vec<Vec<f64>> = channels
        .iter()
        .map(|channel| {
            let step = |hz: f64| 1.0 - (-2.0 * PI * hz / RATE_HZ).exp();
            let (low, high) = (step(band_hz[0]), step(band_hz[1]));
            // Four poles to each side: a loud low end must not leak into the band.
            let mut states = [0.0; 8];
            channel
                .iter()
                .map(|x| {
                    let mut value = *x;
                    for state in &mut states[..4] {
                        *state += high * (value - *state);
                        value = *state;
                    }
                    for state in &mut states[4..] {
                        *state += low * (value - *state);
                        value -= *state;
                    }
                    value
                })
                .collect()
        })
        .collect();
    let sum = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let [left, right] = &filtered[..] else { panic!("two channels") };
    sum(left, right) / (sum(left, left) * sum(right, right)).sqrt().max(f64::MIN_POSITIVE)
}

fn mixed(parts: &[(f64, &[f64])]) -> Vec<f64> {
    (0..SAMPLES).map(|i| parts.iter().map(|(gain, part)| gain * part[i]).sum()).collect()
}

/// What the effect makes of a recording under a steady rumble.
fn heard(recording: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let structure = EngineConfig { dynamics: MatchingMode::Companded, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, RATE_HZ);
    let dictionary = RecordingDictionary::companded(recording, RATE_HZ, &shape, &|_| true).unwrap();
    let mut chain = Chain::new(RATE_HZ, LAYOUT, &structure).unwrap();
    chain.swap_dictionary(Some(Arc::new(dictionary)));
    let controls =
        Controls { mix: MixControls { low: 0.0, extension: 0.0, ..MixControls::default() }, ..Controls::default() };
    let rumble: Vec<f32> = band(77, SAMPLES, [30.0, 180.0]).iter().map(|x| (1.2 * x) as f32).collect();
    let first = Event { at: 0, controls, jump: None };
    let out = play(&mut chain, &[rumble], &[], 2, &[first], 0, || 512);
    out.iter().map(|channel| channel[60_000..].iter().map(|x| f64::from(*x)).collect()).collect()
}

#[test]
fn correlation_in_every_band_is_the_recordings() {
    let everything = [60.0, 15_000.0];
    let [common, left, right] = [1, 2, 3].map(|stream| band(stream, SAMPLES, everything));
    let highs = band(4, SAMPLES, [4000.0, 15_000.0]);
    let [low_left, low_right] = [5, 6].map(|stream| band(stream, SAMPLES, [60.0, 150.0]));
    let pair = |left: &[(f64, &[f64])], right: &[(f64, &[f64])]| vec![mixed(left), mixed(right)];
    let recordings = [
        ("mono", pair(&[(0.1, &common)], &[(0.1, &common)])),
        ("wide", pair(&[(0.1, &left)], &[(0.1, &right)])),
        ("half wide", pair(&[(0.1, &common), (0.06, &left)], &[(0.1, &common), (0.06, &right)])),
        ("anti-phase highs", pair(&[(0.1, &common), (0.2, &highs)], &[(0.1, &common), (-0.2, &highs)])),
        // Without the image matched, the difference of the low end spreads into the bands above.
        ("wide low end", pair(&[(0.02, &common), (3.0, &low_left)], &[(0.02, &common), (3.0, &low_right)])),
    ];
    for (name, recording) in recordings {
        let out = heard(&recording);
        for band_hz in BANDS_HZ {
            let (expected, found) = (correlation(&recording, band_hz), correlation(&out, band_hz));
            println!("{name}, {band_hz:?} Hz: {found:.3} for {expected:.3}");
            assert!((found - expected).abs() < TOLERANCE, "{name}, {band_hz:?} Hz: {found} instead of {expected}");
        }
    }
}
