//! Reduction of scalingAlpha against a buzz.

use crate::texture::buzz::Buzz;

/// Watches the synthesized sound for a buzz.
#[derive(Debug)]
pub struct BuzzGuard {
    buzz: Buzz,
    /// True if it has listened for a buzz since the reset.
    pub is_listening: bool,
    /// Present degree of mapping, for displays.
    pub scaling_alpha: f64,
}

impl BuzzGuard {
    /// A guard for windows whose centres are `hop` samples apart.
    pub fn new(hop: usize, sample_rate_hz: f64) -> Self {
        Self { buzz: Buzz::new(hop, sample_rate_hz), is_listening: false, scaling_alpha: 0.0 }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.buzz.reset();
        self.is_listening = false;
        self.scaling_alpha = 0.0;
    }

    /// Share of scalingAlpha that the buzz leaves, 0-1.
    pub fn share(&self) -> f64 {
        self.buzz.share()
    }

    /// Listens to the next synthesized sample.
    pub fn push(&mut self, sample: f64) {
        self.is_listening = true;
        self.buzz.push(sample);
    }

    /// Stops listening, and forgets what was heard.
    pub fn stop(&mut self) {
        if std::mem::take(&mut self.is_listening) {
            self.buzz.reset();
        }
    }
}
