//! Controls of the mix and its tone.

/// Tone of the whole effect: factors of 0 or more, each 1 if it changes nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToneControls {
    /// Factor below 700 Hz.
    pub low: f64,
    /// Factor above 700 Hz.
    pub high: f64,
    /// Factor above 2.5 kHz.
    pub air: f64,
    /// Factor above 6 kHz.
    pub hiss: f64,
}

impl Default for ToneControls {
    fn default() -> Self {
        Self { low: 1.0, high: 1.0, air: 1.0, hiss: 1.0 }
    }
}

/// Controls of [`crate::mix`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MixControls {
    /// Gain factor of the drive's own low part.
    pub low: f64,
    /// Factor on the extension's noise.
    pub extension: f64,
    /// Factor on the texture.
    pub texture: f64,
    /// Factor on vortex sound.
    pub vortex: f64,
    /// Factor on crackle.
    pub crackle: f64,
    /// Factor on a fuel's hiss.
    pub hiss: f64,
    /// Factor on a fuel's body.
    pub body: f64,
    /// Stereo width of texture, crackle, hiss and body: 0 = mono, 1 = as recorded.
    pub width: f64,
    /// Tone of the sum.
    pub tone: ToneControls,
    /// Factor on the sum.
    pub output: f64,
    /// Loudness in LUFS to which the recording is adjusted in texture and crackle, and a fuel in crackle, hiss and
    /// body, in the companded mode; none changes neither.
    pub loudness_lufs: Option<f64>,
    /// True if levels above -1 dBFS are soft-clipped so that nothing exceeds full scale.
    pub ceiling: bool,
    /// The input, delayed by the latency, instead of the effect.
    pub bypass: bool,
}

impl Default for MixControls {
    fn default() -> Self {
        Self {
            low: 1.0,
            extension: 1.0,
            texture: 1.0,
            vortex: 0.0,
            crackle: 1.0,
            hiss: 0.0,
            body: 0.0,
            width: 1.0,
            tone: ToneControls::default(),
            output: 1.0,
            loudness_lufs: None,
            ceiling: false,
            bypass: false,
        }
    }
}
