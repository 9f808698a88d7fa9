//! Controls of spectral extension.

/// Controls of [`crate::extend`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExtendControls {
    /// Power-law exponent: the noise's power falls as frequency^(-alpha); 0-6.
    pub alpha: f64,
    /// Frequency in Hz where the drive ends and the noise begins, 40-1000: centre of the blend and of the fit, and
    /// corner of the envelope's low-pass.
    pub cutoff_hz: f64,
    /// Width of the blend in Hz, 2-400.
    pub blend_width_hz: f64,
    /// Factor on the fitted noise, 0-4.
    pub noise_amount: f64,
    /// Seed of the noise.
    pub seed: u32,
    /// 0 = the same noise in all channels, 1 = independent noise in each.
    pub width: f64,
}

impl Default for ExtendControls {
    /// The paper's values (§4), full width.
    fn default() -> Self {
        Self { alpha: 2.5, cutoff_hz: 180.0, blend_width_hz: 30.0, noise_amount: 1.0, seed: 42, width: 1.0 }
    }
}
