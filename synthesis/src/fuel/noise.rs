//! The layers of hiss and body.
//!
//! Each is a sum of octaves of noise, weighted to a spectrum with a hump and a slope to each side, times a slow unevenness,
//! times the drive's loudness to a power:
//!
//! ```text
//! level = (loudness / mean)^b      b = 0.5 * follow (hiss: fuel steams on), 0.77 * follow (body: as texture by default)
//! ```

use super::layer::{Layer, Run};
use super::recipe::NoiseKind;
use crate::controls::FuelControls;
use crate::timeline::Timeline;

/// Factors with which the layers are mixed; a layer that is off is not made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// Of hiss.
    pub hiss: f64,
    /// Of body.
    pub body: f64,
}

/// Hiss and body of a fuel.
#[derive(Debug)]
pub struct FuelNoise {
    latency_samples: i64,
    timeline: Timeline<FuelControls>,
    hiss: Layer,
    body: Layer,
    /// Position of the next sample that is heard, and samples since reset.
    position: i64,
    now: u64,
}

impl FuelNoise {
    /// Layers for `channels` of output (1-10) that come `latency_samples` after the drive.
    pub fn new(sample_rate_hz: f64, channels: usize, latency_samples: usize) -> Self {
        let layer = |kind| Layer::new(kind, channels, latency_samples, sample_rate_hz);
        Self {
            latency_samples: latency_samples as i64,
            timeline: Timeline::new(latency_samples + 1, FuelControls::default()),
            hiss: layer(NoiseKind::Hiss),
            body: layer(NoiseKind::Body),
            position: 0,
            now: 0,
        }
    }

    /// Samples by which the layers come after the drive.
    pub fn latency_samples(&self) -> usize {
        self.latency_samples as usize
    }

    /// Back to silence; the next sample of the drive stands at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.timeline.reset(FuelControls::default());
        self.position = position.wrapping_sub(self.latency_samples);
        self.now = 0;
        self.hiss.reset();
        self.body.reset();
    }

    /// Makes one block of both layers, by channel. `loudness` is that of the drive, relative to its level on the whole, at
    /// the samples that are heard: [`latency_samples`](Self::latency_samples) ago; `controls` and `levels` belong to those
    /// that enter.
    pub fn process(
        &mut self,
        loudness: &[f64],
        controls: &FuelControls,
        levels: NoiseLevels,
        hiss: &mut [&mut [f64]],
        body: &mut [&mut [f64]],
    ) {
        if self.timeline.end() == 0 {
            self.timeline.reset(*controls);
        }
        self.timeline.push(*controls, loudness.len());
        let run = Run { timeline: &self.timeline, late: self.latency_samples as u64, now: self.now, loudness };
        self.hiss.process(&run, self.position, levels.hiss != 0.0, hiss);
        self.body.process(&run, self.position, levels.body != 0.0, body);
        self.position = self.position.wrapping_add(loudness.len() as i64);
        self.now += loudness.len() as u64;
    }
}
