//! How sudden a sound is.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use super::memory::{MEMORY_S, PATIENCE_S};
use super::poles::Poles;

/// Suddenness of a sound: the kurtosis of its part above 1 kHz, with the slow loudness removed. 3 for Gaussian noise.
#[derive(Debug, Clone)]
pub struct Crackle {
    high: [Poles; 2],
    loudness: Poles,
    /// Powers waiting until the loudness after them is known too.
    waiting: VecDeque<f64>,
    loudest: f64,
    forget: f64,
    moments: [f64; 2],
    weight: f64,
}

impl Crackle {
    /// Lowest frequency in Hz that crackles, and the fastest loudness in Hz that is slow.
    const LOW_HZ: f64 = 1000.0;
    const SLOW_HZ: f64 = 8.0;
    /// Share of the loudest power below which a sound counts as silent: -40 dB.
    const ACTIVE: f64 = 1e-2;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let forget = 1.0 / (MEMORY_S * rate_hz);
        let high = [Poles::new(Self::LOW_HZ, rate_hz); 2];
        let loudness = Poles::new(Self::SLOW_HZ, rate_hz);
        // Two poles lag by their time constants.
        let lag = (2.0 * rate_hz / (TAU * Self::SLOW_HZ)) as usize;
        let waiting = VecDeque::from(vec![0.0; lag]);
        Self { high, loudness, waiting, loudest: 0.0, forget, moments: [0.0; 2], weight: 0.0 }
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: f32) {
        let sample = if sample.is_finite() { f64::from(sample) } else { 0.0 };
        let high = self.high.iter_mut().fold(sample, |sample, poles| poles.high(sample));
        let power = self.loudness.low(high * high);
        self.waiting.push_back(high * high);
        let square = self.waiting.pop_front().unwrap_or(0.0);
        self.loudest = power.max(self.loudest * (1.0 - self.forget));
        if power > Self::ACTIVE * Self::ACTIVE * self.loudest && power > 1e-20 {
            let flat = square / power;
            for (moment, value) in self.moments.iter_mut().zip([flat, flat * flat]) {
                *moment += self.forget * (value - *moment);
            }
            self.weight += self.forget * (1.0 - self.weight);
        }
    }

    /// The recent kurtosis; none before two seconds of sound.
    pub fn kurtosis(&self) -> Option<f64> {
        let known = 1.0 - (-PATIENCE_S / MEMORY_S).exp();
        let [square, fourth] = self.moments;
        // Both have the same weight, so one of it is left over.
        (self.weight >= known && square > 0.0).then(|| fourth * self.weight / (square * square))
    }
}
