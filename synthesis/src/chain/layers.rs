//! The layers of a voice.

use super::bus::CHUNK;

/// The layers that a voice makes of one chunk.
#[derive(Debug)]
pub struct VoiceLayers {
    /// The drive's low part.
    pub low: Vec<f64>,
    /// Extension noise by channel.
    pub extension: Vec<Vec<f64>>,
    /// Texture by channel.
    pub texture: Vec<Vec<f64>>,
    /// Vortex sound by channel.
    pub vortex: Vec<Vec<f64>>,
    /// Crackle by channel.
    pub crackle: Vec<Vec<f64>>,
    /// A fuel's hiss by channel.
    pub hiss: Vec<Vec<f64>>,
    /// A fuel's body by channel.
    pub body: Vec<Vec<f64>>,
}

impl VoiceLayers {
    /// Silent layers for `channels`.
    pub fn new(channels: usize) -> Self {
        let channel = || vec![0.0; CHUNK];
        let all = || (0..channels).map(|_| channel()).collect();
        Self {
            low: channel(),
            extension: all(),
            texture: all(),
            vortex: all(),
            crackle: all(),
            hiss: all(),
            body: all(),
        }
    }

    /// Crossfades these layers to `other`, by the share that `ramp` gives for every sample, 0-1.
    pub fn fade_to(&mut self, other: &Self, samples: usize, ramp: impl Fn(usize) -> f64) {
        let channels = self.extension.iter_mut().chain(&mut self.texture).chain(&mut self.vortex);
        let channels = channels.chain(&mut self.crackle).chain(&mut self.hiss).chain(&mut self.body);
        let channels = channels.chain([&mut self.low]);
        let others = other.extension.iter().chain(&other.texture).chain(&other.vortex);
        let others = others.chain(&other.crackle).chain(&other.hiss).chain(&other.body).chain([&other.low]);
        for (mine, theirs) in channels.zip(others) {
            for i in 0..samples {
                let part = ramp(i);
                // At the ends exactly one of the two, whatever the other contains.
                if part >= 1.0 {
                    mine[i] = theirs[i];
                } else if part > 0.0 {
                    mine[i] += part * (theirs[i] - mine[i]);
                }
            }
        }
    }
}
