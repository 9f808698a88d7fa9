//! Levels and warnings of the effect, for display.

/// Largest magnitudes since the last [`Chain::take_meters`](super::Chain::take_meters).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Meters {
    /// Main input.
    pub input: f32,
    /// Drive, after its high-pass.
    pub drive: f32,
    /// Low layer, after its level.
    pub low: f32,
    /// Extension layer, after its level.
    pub extension: f32,
    /// Texture layer, after its level.
    pub texture: f32,
    /// Vortex layer, after its level.
    pub vortex: f32,
    /// Crackle layer, after its level.
    pub crackle: f32,
    /// Hiss layer, after its level.
    pub hiss: f32,
    /// Body layer, after its level.
    pub body: f32,
    /// Output.
    pub output: f32,
    /// Present degree of amplitude mapping in texture: scalingAlpha, reduced for a buzz if that is enabled.
    pub scaling_alpha: f32,
    /// True if the input's channels cancel in the mean that drives the engines.
    pub cancels: bool,
    /// True if texture lacks a recording.
    pub no_recording: bool,
    /// Number of steps of the live simulation that came too late.
    pub late_steps: u64,
}
