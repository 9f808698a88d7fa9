//! The drive's envelope, which sets the speed of the gas.

use crate::controls::VortexControls;
use crate::dsp::{Envelope, Follow};

/// Drive beyond this magnitude is a broken signal.
const LARGEST_DRIVE: f64 = 1e4;

/// Follows the drive, at most a hop at a time.
#[derive(Debug)]
pub(super) struct Follower {
    envelope: Envelope,
    room: Vec<f64>,
    /// The envelope after the last sample.
    pub now: f64,
}

impl Follower {
    /// After silence, for hops of `hop` samples.
    pub fn new(sample_rate_hz: f64, hop: usize) -> Self {
        Self { envelope: Envelope::new(sample_rate_hz), room: vec![0.0; hop], now: 0.0 }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.envelope.reset();
        self.now = 0.0;
    }

    /// Follows at most a hop of the drive.
    pub fn process(&mut self, drive: &[f64], controls: &VortexControls) {
        let VortexControls { attack_s, release_s, threshold, .. } = *controls;
        let envelope = &mut self.room[..drive.len()];
        for (kept, sample) in envelope.iter_mut().zip(drive) {
            *kept = if sample.is_nan() { 0.0 } else { sample.clamp(-LARGEST_DRIVE, LARGEST_DRIVE) };
        }
        self.envelope.process(&Follow { attack_s, release_s, threshold }, envelope);
        self.now = envelope.last().copied().unwrap_or(0.0);
    }
}
