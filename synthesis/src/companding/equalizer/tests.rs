use std::f64::consts::PI;

use super::*;
use crate::companding::bands::centres_hz;

const RATE_HZ: f64 = 44_100.0;

fn gain_db(taps: &[f64], frequency_hz: f64) -> f64 {
    let sum: Complex64 = taps
        .iter()
        .enumerate()
        .map(|(i, tap)| Complex64::from_polar(*tap, -2.0 * PI * frequency_hz * i as f64 / RATE_HZ))
        .sum();
    20.0 * sum.norm().log10()
}

#[test]
fn filter_has_the_designed_gains() {
    let centres = centres_hz(RATE_HZ);
    let gains: Vec<f64> = centres.iter().map(|hz| 6.0 * (hz / 1000.0).log2().sin()).collect();
    let taps = design(&gains, RATE_HZ);
    for (hz, gain) in centres.iter().zip(&gains).filter(|(hz, _)| **hz > 250.0) {
        let found = gain_db(&taps, *hz);
        assert!((found - gain).abs() < 0.7, "{hz} Hz: {found} dB instead of {gain} dB");
    }
}

#[test]
fn low_pass_is_flat_below_its_corner_and_attenuates_above() {
    let taps = design_low_pass(11_000.0, RATE_HZ);
    for hz in [100.0, 1000.0, 8000.0, 10_500.0] {
        assert!(gain_db(&taps, hz).abs() < 1.0, "{hz} Hz: {} dB", gain_db(&taps, hz));
    }
    for hz in [13_000.0, 16_000.0, 20_000.0] {
        assert!(gain_db(&taps, hz) < -25.0, "{hz} Hz: {} dB", gain_db(&taps, hz));
    }
}

#[test]
fn is_minimum_phase_and_flat_is_one() {
    let flat = design(&[0.0; 23], RATE_HZ);
    assert!((flat[0] - 1.0).abs() < 1e-9 && flat[1..].iter().all(|x| x.abs() < 1e-9));
    let tilt: Vec<f64> = (0..23).map(|i| f64::from(i) - 11.0).collect();
    let taps = design(&tilt, RATE_HZ);
    let energy = |taps: &[f64]| taps.iter().map(|x| x * x).sum::<f64>();
    assert!(energy(&taps[..32]) > 0.95 * energy(&taps));
}

#[test]
fn a_change_of_the_amount_does_not_click() {
    let taps = design(&[6.0; 23], RATE_HZ);
    let mut equalizer = Equalizer::new(RATE_HZ, 1);
    let mut signal = vec![1.0; 20_000];
    for i in 0..signal.len() {
        let amount = if i / 5000 % 2 == 0 { 0.0 } else { 1.0 };
        equalizer.process(&taps, amount, &mut [&mut signal], i..i + 1);
    }
    let largest = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!((signal[9999] - 2.0).abs() < 0.02 && largest < 2e-3, "{largest}");
}

#[test]
fn amount_0_is_bit_exact_and_silence_ends() {
    let taps = design(&[6.0; 23], RATE_HZ);
    let mut equalizer = Equalizer::new(RATE_HZ, 1);
    let mut signal: Vec<f64> = (0..3000).map(|i| if i < 1000 { (f64::from(i) * 0.1).sin() } else { 0.0 }).collect();
    let untouched = signal.clone();
    let all = 0..signal.len();
    equalizer.process(&taps, 0.0, &mut [&mut signal], all.clone());
    assert_eq!(signal, untouched);
    equalizer.reset();
    equalizer.process(&taps, 1.0, &mut [&mut signal], all);
    assert!((signal[500] / untouched[500] - 2.0).abs() < 0.02);
    assert!(signal[1000 + equalizer.tail_samples()..].iter().all(|x| *x == 0.0));
}

fn noise(samples: usize) -> Vec<f64> {
    let mut noise = vec![0.0; samples];
    crate::dsp::White::new(3, 4).fill(0, &mut noise);
    noise
}

#[test]
fn equals_the_plain_convolution_at_every_rate() {
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        let tilt: Vec<f64> = (0..23).map(|i| f64::from(i) - 11.0).collect();
        let taps = design(&tilt, rate_hz);
        let input = noise(6_000);
        let mut output = input.clone();
        let mut equalizer = Equalizer::new(rate_hz, 1);
        equalizer.process(&taps, 1.0, &mut [&mut output], 0..input.len());
        let scale = taps.iter().map(|tap| tap.abs()).sum::<f64>();
        for (i, found) in output.iter().enumerate() {
            let expected: f64 = taps.iter().zip(input[..=i].iter().rev()).map(|(tap, x)| tap * x).sum();
            assert!((found - expected).abs() < 1e-13 * scale, "{rate_hz} Hz, {i}: {found} instead of {expected}");
        }
    }
}

#[test]
fn output_does_not_depend_on_how_the_sound_is_cut() {
    let taps = [design(&[6.0; 23], RATE_HZ), design(&[-3.0; 23], RATE_HZ), Vec::new()];
    // Silence, other taps and other amounts, at places that lie in no block's middle.
    let run = |cut: usize| {
        let mut equalizer = Equalizer::new(RATE_HZ, 2);
        let (mut left, mut right) = (noise(12_000), noise(12_000));
        left[5_000..7_000].fill(0.0);
        right[5_000..7_000].fill(0.0);
        let mut at = 0;
        while at < left.len() {
            let amount = [0.0, 1.0, 0.4, 1.0, 0.0][at / 1_000 % 5];
            let end = (at + cut).min((at / 1_000 + 1) * 1_000);
            equalizer.process(&taps[at / 3_000 % 3], amount, &mut [&mut left, &mut right], at..end);
            at = end;
        }
        (left, right)
    };
    let whole = run(1_000);
    for cut in [1, 7, 64, 333] {
        assert!(run(cut) == whole, "cut into {cut}");
    }
}

#[test]
fn equalizer_turned_on_late_equals_one_always_on() {
    let taps = design(&(0..23).map(|i| f64::from(i) - 11.0).collect::<Vec<f64>>(), RATE_HZ);
    let run = |first: f64| {
        let mut equalizer = Equalizer::new(RATE_HZ, 1);
        let mut signal = noise(16_000);
        equalizer.process(&taps, first, &mut [&mut signal], 0..3_000);
        equalizer.process(&taps, 1.0, &mut [&mut signal], 3_000..16_000);
        signal
    };
    let (always, later) = (run(1.0), run(0.0));
    // A quarter of a second later the amount has arrived, apart from rounding.
    let error = always[15_000..].iter().zip(&later[15_000..]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(error < 1e-9, "{error}");
}
