//! Sizes of the streaming extension, all in samples at its sample rate.

use crate::error::{Error, in_range};
use crate::structure::EngineConfig;

/// Half-length of the low part's filter at 44.1 kHz: a 30 Hz ramp keeps ±0.04 dB at this length,
/// ±0.14 dB at 1024.
const LOW_REACH: f64 = 1548.0;

/// Half-length of the envelope's filter at 44.1 kHz: at 180 Hz its taps have fallen to 1e-3.
const ENVELOPE_REACH: f64 = 400.0;

/// Smallest half-length at 44.1 kHz of the high-pass that removes from the noise what the envelope smears below the
/// blend. With the paper's half-width it is all that the low part's latency allows.
const HIGH_REACH: f64 = 648.0;

/// Transform length at 44.1 kHz: shorter ones do not resolve the cutoff, and beta becomes wrong. Slightly less than a
/// power of two, so that 48 kHz needs no more.
const TRANSFORM_LEN: f64 = 0.9 * 4096.0;

/// Sizes that follow from structure and sample rate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ExtensionSizes {
    /// Half-width of the windows, and the distance between them.
    pub half_width: usize,
    /// Half-length of the low part's low-pass.
    pub low_reach: usize,
    /// Half-length of the envelope's low-pass.
    pub envelope_reach: usize,
    /// Half-length of the noise's high-pass.
    pub high_reach: usize,
    /// Length of the transforms for low part and noise.
    pub transform_len: usize,
    /// Delay of all outputs.
    pub latency: usize,
}

impl ExtensionSizes {
    /// Sample rates in Hz that the engines support.
    pub const SAMPLE_RATES_HZ: (f64, f64) = (8000.0, 384_000.0);

    pub fn new(structure: &EngineConfig, sample_rate_hz: f64) -> Result<Self, Error> {
        structure.validate()?;
        in_range("sample rate in Hz", sample_rate_hz, Self::SAMPLE_RATES_HZ.0, Self::SAMPLE_RATES_HZ.1)?;
        let scaled = |size: f64| (size * sample_rate_hz / EngineConfig::REFERENCE_RATE_HZ).ceil() as usize;
        let half_width = structure.half_width_at(sample_rate_hz);
        let low_reach = scaled(LOW_REACH);
        let envelope_reach = scaled(ENVELOPE_REACH);
        // A low part's block must be complete, and one filter length more, before it begins to sound; a window must be
        // complete, with its envelope, one filter length before it does.
        let latency = (half_width + low_reach).max(2 * half_width + envelope_reach + scaled(HIGH_REACH));
        let high_reach = latency - 2 * half_width - envelope_reach;
        let transform_len =
            scaled(TRANSFORM_LEN).max(half_width + 2 * low_reach).max(4 * half_width).next_power_of_two();
        Ok(Self { half_width, low_reach, envelope_reach, high_reach, transform_len, latency })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_sizes_have_the_stated_latency() {
        let layout = ExtensionSizes::new(&EngineConfig::default(), 44_100.0).unwrap();
        assert_eq!((layout.latency, layout.transform_len, layout.high_reach), (2048, 4096, 648));
        let layout = ExtensionSizes::new(&EngineConfig::default(), 48_000.0).unwrap();
        assert_eq!(layout.transform_len, 4096);
    }

    #[test]
    fn refuses_rates_out_of_range() {
        for rate in [0.0, 7999.0, 400_000.0, f64::NAN] {
            assert!(ExtensionSizes::new(&EngineConfig::default(), rate).is_err());
        }
    }
}
