//! How well a sound follows another.

use std::collections::VecDeque;

use super::memory::{MEMORY_S, PATIENCE_S};
use super::poles::Poles;

/// Agreement of two sounds' loudness: correlation of both envelopes in dB.
#[derive(Debug, Clone)]
pub struct Follow {
    high: [Poles; 2],
    envelopes: [Poles; 2],
    step: usize,
    until_step: usize,
    pairs: VecDeque<[f64; 2]>,
}

impl Follow {
    /// Lowest frequency in Hz of the sound that follows; the fastest envelope in Hz; pairs per second.
    const LOW_HZ: f64 = 500.0;
    const ENVELOPE_HZ: f64 = 20.0;
    const PAIRS_HZ: f64 = 100.0;
    /// Level in dB below the loudest at which all sounds count as equally soft.
    const RANGE_DB: f64 = 50.0;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let step = ((rate_hz / Self::PAIRS_HZ).round() as usize).max(1);
        let high = [Poles::new(Self::LOW_HZ, rate_hz); 2];
        let envelopes = [Poles::new(Self::ENVELOPE_HZ, rate_hz); 2];
        Self { high, envelopes, step, until_step: step, pairs: VecDeque::new() }
    }

    /// Adds one sample of the leading and one of the following sound, at the same moment.
    pub fn push(&mut self, leads: f32, follows: f32) {
        let clean = |sample: f32| if sample.is_finite() { f64::from(sample) } else { 0.0 };
        let follows = self.high.iter_mut().fold(clean(follows), |sample, poles| poles.high(sample));
        let [led, following] = &mut self.envelopes;
        let now = [led.low(clean(leads).abs()), following.low(follows.abs())];
        self.until_step -= 1;
        if self.until_step == 0 {
            self.until_step = self.step;
            self.pairs.push_back(now);
            if self.pairs.len() as f64 > MEMORY_S * Self::PAIRS_HZ {
                self.pairs.pop_front();
            }
        }
    }

    /// The correlation, -1 to 1; none before two seconds, and where one of the two does not change.
    pub fn correlation(&self) -> Option<f64> {
        if (self.pairs.len() as f64) < PATIENCE_S * Self::PAIRS_HZ {
            return None;
        }
        let loudest = self.pairs.iter().fold([0.0f64; 2], |[a, b], pair| [a.max(pair[0]), b.max(pair[1])]);
        let level = |pair: &[f64; 2], which: usize| {
            let floor = loudest[which] * 10f64.powf(-Self::RANGE_DB / 20.0);
            20.0 * (pair[which].max(floor) + 1e-30).log10()
        };
        let count = self.pairs.len() as f64;
        let mean = [0, 1].map(|which| self.pairs.iter().map(|pair| level(pair, which)).sum::<f64>() / count);
        let (mut both, mut squares) = (0.0, [0.0; 2]);
        for pair in &self.pairs {
            let [a, b] = [0, 1].map(|which| level(pair, which) - mean[which]);
            both += a * b;
            squares[0] += a * a;
            squares[1] += b * b;
        }
        let changes = squares.iter().all(|square| square / count > 0.01);
        changes.then(|| both / (squares[0] * squares[1]).sqrt())
    }
}
