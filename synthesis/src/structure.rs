//! Settings that decide sizes: buffers, latency, dictionary. They do not change during playback; a change rebuilds the
//! engines.

use crate::error::{Error, in_range};

/// Reconciliation of a drive's loudness, which varies far more, with a recording's.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum MatchingMode {
    /// As published: windows are matched at their own loudness, or mapped one by one (Chadwick & James 2011, §5.3).
    #[default]
    Paper,
    /// The slow loudness is removed from both, windows are matched in that flattened domain, and the drive's loudness
    /// is restored: see [`crate::companding`].
    Companded,
}

/// Sizes of both engines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineConfig {
    /// Pyramid levels at 44.1 kHz, 3-8; see [`levels_at`](Self::levels_at) for other rates.
    pub levels: usize,
    /// Half-width W of a texture window, in samples of its own level, 2-16.
    pub window: usize,
    /// Feature half-width F in windows, 1-6.
    pub feature: usize,
    /// Weight of a feature's sample at distance d from the window's centre is exp(-falloff * d);
    /// 0-1, per sample of the sample's own level.
    pub falloff: f64,
    /// Half-width of an extension window in samples at 44.1 kHz, 100-2000; a time: it scales with the rate.
    pub half_width: usize,
    /// Width in Hz of the band in which extension fits its noise, three standard deviations, 3-120.
    pub fit_width_hz: f64,
    /// Texture's relation to the drive's loudness; it decides the contents of a dictionary.
    pub dynamics: MatchingMode,
}

impl Default for EngineConfig {
    /// The paper's values (Chadwick & James 2011, §4-5).
    fn default() -> Self {
        Self {
            levels: 6,
            window: 4,
            feature: 3,
            falloff: 0.0,
            half_width: 500,
            fit_width_hz: 30.0,
            dynamics: MatchingMode::Paper,
        }
    }
}

impl EngineConfig {
    /// The rate in Hz at which the paper's sizes are stated.
    pub const REFERENCE_RATE_HZ: f64 = 44_100.0;

    /// Fails with the first setting out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("levels", self.levels as f64, 3.0, 8.0)?;
        in_range("window", self.window as f64, 2.0, 16.0)?;
        in_range("feature", self.feature as f64, 1.0, 6.0)?;
        in_range("falloff", self.falloff, 0.0, 1.0)?;
        in_range("extension half-width", self.half_width as f64, 100.0, 2000.0)?;
        in_range("fit width", self.fit_width_hz, 3.0, 120.0)
    }

    /// Pyramid levels at `sample_rate_hz`: one more per doubling of the rate, so that the top level's band does not
    /// move.
    pub fn levels_at(&self, sample_rate_hz: f64) -> usize {
        let doublings = maths::log2(sample_rate_hz / Self::REFERENCE_RATE_HZ).round();
        (self.levels as f64 + doublings).max(2.0) as usize
    }

    /// Extension half-width in samples at `sample_rate_hz`.
    pub fn half_width_at(&self, sample_rate_hz: f64) -> usize {
        (self.half_width as f64 * sample_rate_hz / Self::REFERENCE_RATE_HZ).round().max(1.0) as usize
    }
}
