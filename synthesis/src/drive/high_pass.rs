//! The high-pass before both engines.

use crate::dsp::{Svf, section_gain};
use crate::error::within;

/// Duration in seconds of a change of the corner.
const GLIDE_S: f64 = 0.02;

/// Highest corner in Hz.
const MAX_CORNER_HZ: f64 = 1000.0;

/// Butterworth high-pass of order 2 whose corner may move. A corner of 0 Hz passes the signal unchanged.
#[derive(Debug)]
pub(super) struct HighPass {
    sample_rate_hz: f64,
    /// The corner requested last, in Hz; none right after reset, when there is nothing to glide from.
    asked_hz: Option<f64>,
    /// Integrator gain tan(pi corner / rate): its present value, and its change per sample of the glide.
    gain: f64,
    gain_step: f64,
    target_gain: f64,
    /// Share of the filter's output in the result: its present value, and its change per sample.
    wet: f64,
    wet_step: f64,
    target_wet: f64,
    glide_len: u32,
    glide_left: u32,
    section: Svf,
}

impl HighPass {
    pub fn new(sample_rate_hz: f64) -> Self {
        Self {
            sample_rate_hz,
            asked_hz: None,
            gain: 0.0,
            gain_step: 0.0,
            target_gain: 0.0,
            wet: 0.0,
            wet_step: 0.0,
            target_wet: 0.0,
            glide_len: (GLIDE_S * sample_rate_hz) as u32,
            glide_left: 0,
            section: Svf::default(),
        }
    }

    pub fn reset(&mut self) {
        *self = Self::new(self.sample_rate_hz);
    }

    pub fn process(&mut self, corner_hz: f64, signal: &mut [f64]) {
        if signal.is_empty() {
            return;
        }
        self.aim(within(corner_hz, 0.0, MAX_CORNER_HZ));
        for sample in signal {
            if self.wet == 0.0 && self.glide_left == 0 {
                // Nothing can change any more in this call.
                return self.section.reset();
            }
            if self.glide_left > 0 {
                self.glide();
            }
            let filtered = self.section.process(self.gain, *sample).high;
            *sample = if self.wet == 1.0 { filtered } else { *sample + self.wet * (filtered - *sample) };
        }
    }

    /// Sets out for a new corner.
    fn aim(&mut self, corner_hz: f64) {
        if self.asked_hz == Some(corner_hz) {
            return;
        }
        let fresh = self.asked_hz.is_none();
        self.asked_hz = Some(corner_hz);
        let gain = section_gain(corner_hz, self.sample_rate_hz);
        self.target_wet = if corner_hz > 0.0 { 1.0 } else { 0.0 };
        // Turned off, the filter keeps its corner while it fades out; turned on from nothing, it has its corner at
        // once.
        self.target_gain = if corner_hz > 0.0 { gain } else { self.gain };
        if fresh || self.wet == 0.0 {
            self.gain = self.target_gain;
        }
        if fresh {
            self.wet = self.target_wet;
        }
        self.glide_left = if fresh { 0 } else { self.glide_len };
        self.gain_step = (self.target_gain - self.gain) / f64::from(self.glide_len);
        self.wet_step = (self.target_wet - self.wet) / f64::from(self.glide_len);
    }

    fn glide(&mut self) {
        self.glide_left -= 1;
        if self.glide_left == 0 {
            (self.gain, self.wet) = (self.target_gain, self.target_wet);
        } else {
            self.gain += self.gain_step;
            self.wet += self.wet_step;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn sine(frequency_hz: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| (2.0 * PI * frequency_hz * i as f64 / 44_100.0).sin()).collect()
    }

    #[test]
    fn has_the_butterworth_response() {
        for frequency_hz in [10.0f64, 30.0, 60.0, 150.0] {
            let mut signal = sine(frequency_hz, 88_200);
            HighPass::new(44_100.0).process(30.0, &mut signal);
            let power: f64 = signal[44_100..].iter().map(|x| x * x).sum::<f64>() / 44_100.0;
            let ratio = (30.0 / frequency_hz).powi(4);
            let (found, expected) = (10.0 * (2.0 * power).log10(), -10.0 * (1.0 + ratio).log10());
            assert!((found - expected).abs() < 0.01, "{frequency_hz} Hz: {found} dB instead of {expected} dB");
        }
    }

    #[test]
    fn off_is_bit_exact_also_after_having_been_on() {
        let input = sine(50.0, 20_000);
        let mut off = input.clone();
        let mut filter = HighPass::new(44_100.0);
        filter.process(0.0, &mut off);
        assert_eq!(off, input);
        filter.process(30.0, &mut off.clone());
        let mut out = input.clone();
        filter.process(0.0, &mut out);
        assert_eq!(out[2000..], input[2000..]);
        assert_ne!(out[..100], input[..100]);
    }

    #[test]
    fn changes_of_the_corner_do_not_click() {
        // On a 20 Hz tone every corner gives another level and phase.
        let input = sine(20.0, 44_100);
        let steepest = 2.0 * PI * 20.0 / 44_100.0;
        for (from, to) in [(30.0, 0.0), (0.0, 30.0), (30.0, 100.0), (100.0, 10.0), (0.0, 200.0)] {
            let mut filter = HighPass::new(44_100.0);
            let mut out = input.clone();
            let (before, after) = out.split_at_mut(21_000);
            filter.process(from, before);
            filter.process(to, after);
            let largest = out[1000..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
            assert!(largest < 3.0 * steepest, "{from} to {to} Hz: step {largest}");
        }
    }

    #[test]
    fn ends_exactly_after_silence() {
        let mut filter = HighPass::new(44_100.0);
        filter.process(30.0, &mut sine(50.0, 1000));
        let mut silence = vec![0.0; 44_100];
        filter.process(30.0, &mut silence);
        assert!(silence[30_000..].iter().all(|sample| *sample == 0.0));
    }
}
