//! Slow random motion: gusts of wind, breath, an unsteady hand.

use crate::solver::Random;

/// Number of waves in one motion.
const WAVES: usize = 12;

/// A random function of time with mean 0, rms 1, and frequencies in one band.
#[derive(Debug, Clone)]
pub struct Wander {
    /// Angular frequency in 1/s and phase.
    waves: [(f64, f64); WAVES],
}

impl Wander {
    /// Motion number `seed`, between two frequencies.
    pub fn new(seed: u64, low_hz: f64, high_hz: f64) -> Self {
        let mut random = Random::new(seed);
        let waves = std::array::from_fn(|wave| {
            // One in each equal part of the band's logarithm, so that no part is left out.
            let share = (wave as f64 + random.uniform()) / WAVES as f64;
            let frequency_hz = low_hz * maths::pow(high_hz / low_hz, share);
            (std::f64::consts::TAU * frequency_hz, std::f64::consts::TAU * random.uniform())
        });
        Self { waves }
    }

    /// Value at a time.
    pub fn value_at(&self, time_s: f64) -> f64 {
        let sum: f64 = self.waves.iter().map(|(rate, phase)| maths::sin(rate * time_s + phase)).sum();
        sum * (2.0 / WAVES as f64).sqrt()
    }
}
