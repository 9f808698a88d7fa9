//! The drive's distribution of amplitudes, learned or running.

use std::sync::Arc;

use super::dictionary::Dictionary;
use super::distribution::{Distribution, RunningDistribution, feature_factor};
use crate::controls::DynamicRange;

/// What dynamic-range matching (§5.3, eq. 17) knows of the drive.
#[derive(Debug)]
pub(super) struct DriveRange {
    /// Learned beforehand.
    pub learned: Option<Arc<Distribution>>,
    running: RunningDistribution,
}

impl DriveRange {
    /// Nothing is known; the drive's top level has the rate `top_rate_hz`.
    pub fn new(top_rate_hz: f64) -> Self {
        Self { learned: None, running: RunningDistribution::new(top_rate_hz) }
    }

    /// Forgets the running estimate.
    pub fn reset(&mut self) {
        self.running.reset();
    }

    /// Adds a magnitude of the drive's top level.
    pub fn push(&mut self, magnitude: f64) {
        self.running.push(magnitude);
    }

    /// The factor that takes a window of this mean magnitude into the recording's range.
    pub fn factor(&self, mean: f64, scaling_alpha: f64, by: DynamicRange, recording: &Dictionary) -> f64 {
        let distribution = recording.distribution();
        match (by, &self.learned) {
            (DynamicRange::Learned, Some(learned)) => {
                feature_factor(mean, scaling_alpha, |a| learned.fraction(a), distribution)
            }
            (DynamicRange::Running, _) => {
                let prior = recording.histogram();
                feature_factor(mean, scaling_alpha, |a| self.running.fraction(a, prior), distribution)
            }
            _ => 1.0,
        }
    }
}
