//! The filters that the figures share.

use std::f64::consts::TAU;

/// Two cascaded low-pass poles at one frequency; the remainder is the high-pass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Poles {
    part: f64,
    state: [f64; 2],
}

impl Poles {
    /// Poles at `cutoff_hz`, after silence.
    pub fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        Self { part: 1.0 - (-TAU * cutoff_hz / rate_hz).exp(), state: [0.0; 2] }
    }

    /// The next sample of the low-pass.
    pub fn low(&mut self, value: f64) -> f64 {
        self.state[0] += self.part * (value - self.state[0]);
        self.state[1] += self.part * (self.state[0] - self.state[1]);
        // Values this small matter to no figure, and denormals are slow.
        self.state.iter_mut().filter(|state| state.abs() < 1e-30).for_each(|state| *state = 0.0);
        self.state[1]
    }

    /// The next sample of what it leaves.
    pub fn high(&mut self, value: f64) -> f64 {
        let low = self.low(value);
        value - low
    }
}
