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
use crate::dsp::Timeline;

/// Mixing factors of the layers; a layer that is off is not computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseLevels {
    /// Gain factor of hiss.
    pub hiss: f64,
    /// Gain factor of body.
    pub body: f64,
}

/// Hiss and body of a fuel.
#[derive(Debug)]
pub struct FuelNoise {
    latency_samples: i64,
    timeline: Timeline<FuelControls>,
    hiss: Layer,
    body: Layer,
    /// Position of the next audible sample, and samples since reset.
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

    /// Delay of the layers after the drive, in samples.
    pub fn latency_samples(&self) -> usize {
        self.latency_samples as usize
    }

    /// Resets to silence; the next sample of the drive is at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.timeline.reset(FuelControls::default());
        self.position = position.wrapping_sub(self.latency_samples);
        self.now = 0;
        self.hiss.reset();
        self.body.reset();
    }

    /// Renders one block of both layers, by channel. `loudness` is that of the drive, relative to its overall level, at
    /// the audible samples, which are [`latency_samples`](Self::latency_samples) old; `controls` and `levels` belong to
    /// the samples that enter.
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
