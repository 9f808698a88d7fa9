//! Levels and warnings of the effect, for people to look at.

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
    /// How far texture maps amplitudes now: scalingAlpha, less what a buzz takes where that is asked for.
    pub scaling_alpha: f32,
    /// Whether the input's channels cancel in the mean that drives the engines.
    pub cancels: bool,
    /// Whether texture lacks a recording.
    pub no_recording: bool,
    /// Steps of the live simulation that came too late.
    pub late_steps: u64,
}
