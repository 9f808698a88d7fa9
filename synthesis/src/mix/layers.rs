//! The layers that are mixed, their levels, and their peaks.

use crate::dsp::ceiling;

/// The layers of one block, all delayed by the effect's latency.
#[derive(Debug, Clone, Copy)]
pub struct Layers<'a> {
    /// The drive's low part, the same in every channel.
    pub low: &'a [f64],
    /// Extension noise, by channel.
    pub extension: &'a [Vec<f64>],
    /// Texture, by channel.
    pub texture: &'a [Vec<f64>],
    /// Vortex sound, by channel.
    pub vortex: &'a [Vec<f64>],
    /// Crackle, by channel.
    pub crackle: &'a [Vec<f64>],
    /// A fuel's hiss, by channel.
    pub hiss: &'a [Vec<f64>],
    /// A fuel's body, by channel.
    pub body: &'a [Vec<f64>],
    /// The input, by channel of the output, delayed likewise; silent where there is none.
    pub dry: &'a [Vec<f32>],
}

/// Largest magnitudes of the layers after their levels, and of the output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Peaks {
    /// Low layer.
    pub low: f64,
    /// Extension layer.
    pub extension: f64,
    /// Texture layer.
    pub texture: f64,
    /// Vortex layer.
    pub vortex: f64,
    /// Crackle layer.
    pub crackle: f64,
    /// Hiss layer.
    pub hiss: f64,
    /// Body layer.
    pub body: f64,
    /// Output.
    pub output: f64,
}

/// Levels of one sample.
#[derive(Debug, Clone, Copy)]
pub(super) struct Levels {
    pub low: f64,
    pub extension: f64,
    pub texture: f64,
    pub vortex: f64,
    pub crackle: f64,
    pub hiss: f64,
    pub body: f64,
    pub width: f64,
    pub output: f64,
    pub bypass: f64,
}

/// The larger magnitude; NaN counts as the largest, so that the ceiling silences it in all channels.
#[inline]
pub(super) fn louder(sample: f64, loudest: f64) -> f64 {
    if sample.abs() > loudest || sample.is_nan() { sample.abs() } else { loudest }
}

/// A sample of the channel of low-frequency effects.
#[inline]
pub(super) fn limited_effect(dry: f32, has_ceiling: bool) -> f32 {
    if has_ceiling { (f64::from(dry) * ceiling::gain(f64::from(dry).abs())) as f32 } else { dry }
}
