//! Conversion from the rate at which sources are summed to the output's.
//!
//! The sources' sound ends far below half of the output's rate, and a crowd of them is summed sample by sample. They
//! are therefore summed at 22-44 kHz, and the sum of each channel is upsampled to the output's rate once.

use std::f64::consts::{PI, TAU};

/// Lowest rate in Hz at which sources are summed if the output's rate is higher. At this rate the filter is flat up to
/// 7.3 kHz; the built-in textures end at 2 kHz, and pace and Doppler shift raise that by less than half.
const LEAST_RATE_HZ: f64 = 22_000.0;

/// Number of samples at the lower rate, on either side of an output sample, that interpolate it.
const REACH: usize = 12;

/// Share of the lower rate up to which the filter is flat; from 1 minus that, its images are 92 dB down.
const FLAT: f64 = 1.0 / 3.0;

/// Share of the output's rate up to which sound extends without upsampling.
const UNRAISED: f64 = 0.45;

/// Samples of the output per sample of the sum: a power of two.
pub(super) fn factor(sample_rate_hz: f64) -> usize {
    let mut factor = 1;
    while sample_rate_hz >= 2.0 * factor as f64 * LEAST_RATE_HZ {
        factor *= 2;
    }
    factor
}

/// Highest frequency in Hz that is reproduced correctly.
pub(super) fn top_hz(sample_rate_hz: f64) -> f64 {
    match factor(sample_rate_hz) {
        1 => UNRAISED * sample_rate_hz,
        factor => FLAT * sample_rate_hz / factor as f64,
    }
}

/// Raises the rate of several channels, hop by hop.
#[derive(Debug)]
pub(super) struct Upsampler {
    factor: usize,
    /// Weights of the samples around, by phase, the oldest sample's first.
    weights: Vec<[f32; 2 * REACH]>,
    /// By channel: the most recent samples, and the present hop.
    recent: Vec<Vec<f32>>,
    /// One phase of a hop.
    phase: Vec<f32>,
}

impl Upsampler {
    /// An upsampler for hops of `hop` samples at the lower rate.
    pub fn new(factor: usize, channels: usize, hop: usize) -> Self {
        let weights = (0..factor).map(|phase| {
            std::array::from_fn(|at| {
                // The output's sample is `phase` after the sample before the middle.
                let from = (at + 1) as f64 - REACH as f64 - phase as f64 / factor as f64;
                let sinc = if from == 0.0 { 1.0 } else { maths::sin(PI * from) / (PI * from) };
                (sinc * window(from / REACH as f64)) as f32
            })
        });
        Self {
            factor,
            weights: weights.collect(),
            recent: vec![vec![0.0; 2 * REACH - 1 + hop]; channels],
            phase: vec![0.0; hop],
        }
    }

    /// Delay in samples of the output.
    pub fn latency_samples(&self) -> usize {
        if self.factor == 1 { 0 } else { REACH * self.factor }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.recent.iter_mut().for_each(|recent| recent.fill(0.0));
    }

    /// Converts one hop of a channel, written to `raised`, which is `factor` times as long.
    pub fn process(&mut self, channel: usize, hop: &[f32], raised: &mut [f32]) {
        if self.factor == 1 {
            raised.copy_from_slice(hop);
            return;
        }
        let recent = &mut self.recent[channel];
        recent[2 * REACH - 1..].copy_from_slice(hop);
        for (phase, weights) in self.weights.iter().enumerate() {
            self.phase.fill(0.0);
            for (at, weight) in weights.iter().enumerate() {
                self.phase.iter_mut().zip(&recent[at..]).for_each(|(sum, x)| *sum += weight * x);
            }
            for (out, x) in raised[phase..].iter_mut().step_by(self.factor).zip(&self.phase) {
                *out = *x;
            }
        }
        recent.copy_within(hop.len().., 0);
    }
}

/// The four-term Blackman-Harris window from -1 to 1 (Harris 1978: sidelobes at -92 dB).
fn window(at: f64) -> f64 {
    let turn = 0.5 * TAU * at;
    0.35875 + 0.48829 * maths::cos(turn) + 0.14128 * maths::cos(2.0 * turn) + 0.01168 * maths::cos(3.0 * turn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tones_are_kept_and_have_no_images() {
        for (sample_rate_hz, expected) in
            [(8_000.0, 1), (43_900.0, 1), (44_100.0, 2), (48_000.0, 2), (96_000.0, 4), (192_000.0, 8), (384_000.0, 16)]
        {
            let factor = factor(sample_rate_hz);
            assert_eq!(factor, expected, "{sample_rate_hz} Hz");
            let low_hz = sample_rate_hz / factor as f64;
            for frequency_hz in [100.0, 0.5 * top_hz(sample_rate_hz), top_hz(sample_rate_hz)] {
                let (hop, hops) = (32, 12);
                let mut raise = Upsampler::new(factor, 2, hop);
                let mut raised = vec![0.0; hop * factor];
                let late = raise.latency_samples() as f64;
                let mut largest = 0.0f64;
                for index in 0..hops {
                    let sound = |at: usize| (TAU * frequency_hz / low_hz * (index * hop + at) as f64).sin() as f32;
                    let input: Vec<f32> = (0..hop).map(sound).collect();
                    raise.process(1, &input, &mut raised);
                    for (n, found) in raised.iter().enumerate().filter(|_| index > 0) {
                        let at = (index * hop * factor + n) as f64 - late;
                        let off = f64::from(*found) - (TAU * frequency_hz / sample_rate_hz * at).sin();
                        largest = largest.max(off.abs());
                    }
                }
                assert!(largest < 1e-4, "{frequency_hz} Hz at {sample_rate_hz} Hz: {largest:e}");
            }
        }
    }
}
