//! An equaliser towards a spectrum: minimum phase, so that it adds no latency.

use crate::fft::Complex64;

use super::bands::centres_hz;
use crate::extend::spectrum::Transform;
use crate::smoothed::Smoothed;

/// Most that a third octave is raised or lowered, in dB.
pub const LIMIT_DB: f64 = 20.0;
/// How far a low-pass falls, in dB: what windows that change leave there is as far above an empty band's noise floor.
const STOP_DB: f64 = 30.0;
/// Taps at 44.1 kHz.
const TAPS: f64 = 512.0;
/// Length of the transform for designing, in taps; long, so that the cepstrum does not wrap.
const DESIGN_FACTOR: usize = 16;
/// Time constant in seconds with which the amount follows its control.
const SMOOTHING_S: f64 = 0.02;

/// Taps of the minimum-phase filter whose gains in dB at [`centres_hz`] are `gains_db`; beyond the
/// outermost they stay.
pub fn design(gains_db: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let centres: Vec<f64> = centres_hz(sample_rate_hz).iter().map(|hz| hz.ln()).collect();
    let gain_db = |hz: f64| interpolate(&centres, gains_db, hz.max(1.0).ln()).clamp(-LIMIT_DB, LIMIT_DB);
    minimum_phase(gain_db, sample_rate_hz)
}

/// Taps of a low-pass that stays as it is up to a frequency in Hz, and falls by [`STOP_DB`] within a sixth of an octave.
pub fn design_low_pass(corner_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    minimum_phase(|hz| -STOP_DB * (6.0 * (hz.max(1.0) / corner_hz).log2()).clamp(0.0, 1.0), sample_rate_hz)
}

/// Taps of the minimum-phase filter with a gain in dB by frequency in Hz.
fn minimum_phase(gain_db: impl Fn(f64) -> f64, sample_rate_hz: f64) -> Vec<f64> {
    let taps = ((TAPS * sample_rate_hz / 44_100.0).ceil() as usize).next_multiple_of(STRIDE);
    let mut transform = Transform::new((taps * DESIGN_FACTOR).next_power_of_two());
    let len = transform.len();
    for (bin, value) in transform.spectrum.iter_mut().enumerate() {
        let gain_db = gain_db(bin as f64 * sample_rate_hz / len as f64);
        *value = Complex64::new(gain_db / 20.0 * std::f64::consts::LN_10 / len as f64, 0.0);
    }
    // The cepstrum, folded onto positive times, is that of the minimum-phase filter
    // (Oppenheim & Schafer, "Discrete-Time Signal Processing", §13.5).
    transform.inverse();
    let half = len / 2;
    transform.time[1..half].iter_mut().for_each(|x| *x *= 2.0);
    transform.time[half + 1..].fill(0.0);
    transform.forward();
    transform.spectrum.iter_mut().for_each(|x| *x = x.exp() / len as f64);
    transform.inverse();
    let fade = taps / 4;
    let ending = |tap: usize| match (tap + fade).checked_sub(taps) {
        Some(into) => (std::f64::consts::FRAC_PI_2 * into as f64 / fade as f64).cos().powi(2),
        None => 1.0,
    };
    (0..taps).map(|tap| transform.time[tap] * ending(tap)).collect()
}

fn interpolate(places: &[f64], values: &[f64], at: f64) -> f64 {
    let above = places.partition_point(|place| *place <= at);
    match (above.checked_sub(1), values.get(above)) {
        (None, first) => first.copied().unwrap_or(0.0),
        (Some(below), None) => values.get(below.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0),
        (Some(below), Some(next)) => {
            let part = (at - places[below]) / (places[above] - places[below]);
            values[below] + part * (next - values[below])
        }
    }
}

/// Taps summed at once, in a fixed order whatever the machine.
const STRIDE: usize = 8;

/// Filters channels with taps that may be exchanged, wholly or in part.
#[derive(Debug)]
pub struct Equalizer {
    /// The last samples of every channel, each kept twice so that they always lie in a row.
    histories: Vec<Vec<f64>>,
    length: usize,
    at: usize,
    amount: Smoothed,
    fresh: bool,
    /// Samples for which every channel has been silent.
    silent_samples: usize,
}

impl Equalizer {
    /// An equaliser for `channels`.
    pub fn new(sample_rate_hz: f64, channels: usize) -> Self {
        let length = design(&[0.0], sample_rate_hz).len();
        Self {
            histories: vec![vec![0.0; 2 * length]; channels],
            length,
            at: 0,
            amount: Smoothed::new(SMOOTHING_S, sample_rate_hz),
            fresh: true,
            silent_samples: length,
        }
    }

    /// Samples for which it sounds on.
    pub fn tail_samples(&self) -> usize {
        self.length
    }

    /// Back to silence.
    pub fn reset(&mut self) {
        self.histories.iter_mut().for_each(|history| history.fill(0.0));
        self.at = 0;
        self.fresh = true;
        self.silent_samples = self.length;
    }

    /// Filters one sample of every channel with `taps`, made by [`design`], by `amount` (0-1).
    #[inline]
    pub fn process(&mut self, taps: &[f64], amount: f64, channels: &mut [&mut [f64]], at: usize) {
        if self.fresh {
            self.amount.value = amount;
            self.fresh = false;
        }
        let amount = self.amount.next(amount);
        let silent = channels.iter().all(|channel| channel[at] == 0.0);
        self.silent_samples = if silent { self.silent_samples.saturating_add(1) } else { 0 };
        self.at = if self.at == 0 { self.length - 1 } else { self.at - 1 };
        let is_heard = amount != 0.0 && taps.len() == self.length && self.silent_samples < self.length;
        for (channel, history) in channels.iter_mut().zip(&mut self.histories) {
            let input = channel[at];
            history[self.at] = input;
            history[self.at + self.length] = input;
            if is_heard {
                let filtered = dot(taps, &history[self.at..self.at + self.length]);
                channel[at] = input + amount * (filtered - input);
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; STRIDE];
    for (a, b) in a.as_chunks::<STRIDE>().0.iter().zip(b.as_chunks::<STRIDE>().0) {
        for i in 0..STRIDE {
            sums[i] += a[i] * b[i];
        }
    }
    sums.iter().sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

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
    fn has_the_gains_asked_for() {
        let centres = centres_hz(RATE_HZ);
        let gains: Vec<f64> = centres.iter().map(|hz| 6.0 * (hz / 1000.0).log2().sin()).collect();
        let taps = design(&gains, RATE_HZ);
        for (hz, gain) in centres.iter().zip(&gains).filter(|(hz, _)| **hz > 250.0) {
            let found = gain_db(&taps, *hz);
            assert!((found - gain).abs() < 0.7, "{hz} Hz: {found} dB instead of {gain} dB");
        }
    }

    #[test]
    fn a_low_pass_leaves_what_is_below_and_takes_what_is_above() {
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
            equalizer.process(&taps, amount, &mut [&mut signal], i);
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
        for i in 0..signal.len() {
            equalizer.process(&taps, 0.0, &mut [&mut signal], i);
        }
        assert_eq!(signal, untouched);
        equalizer.reset();
        for i in 0..signal.len() {
            equalizer.process(&taps, 1.0, &mut [&mut signal], i);
        }
        assert!((signal[500] / untouched[500] - 2.0).abs() < 0.02);
        assert!(signal[1000 + equalizer.tail_samples()..].iter().all(|x| *x == 0.0));
    }
}
