//! Sizes and positions of pyramid levels, windows and features.

use crate::EngineConfig;
use crate::error::{Error, in_range};
use bitcode::{Decode, Encode};

/// The sizes that a dictionary and an engine must share.
#[derive(Debug, Clone, Copy, PartialEq, Encode, Decode)]
pub struct PyramidConfig {
    /// Pyramid levels L, 2-13; level 0 is the sound, level L-1 the top (coarsest).
    pub levels: usize,
    /// Half-width W of a window in samples of its own level, 2-16.
    pub window: usize,
    /// Feature half-width F in windows, 1-6.
    pub feature: usize,
    /// Weight of a feature's sample at distance d from the centre is exp(-falloff * d), 0-1.
    pub falloff: f64,
}

impl Default for PyramidConfig {
    /// The paper's values (§5).
    fn default() -> Self {
        Self::at_rate(&EngineConfig::default(), EngineConfig::REFERENCE_RATE_HZ)
    }
}

impl PyramidConfig {
    /// The shape that preserves the structure's times and bands at `sample_rate_hz`.
    pub fn at_rate(structure: &EngineConfig, sample_rate_hz: f64) -> Self {
        Self {
            levels: structure.levels_at(sample_rate_hz),
            window: structure.window,
            feature: structure.feature,
            falloff: structure.falloff,
        }
    }

    /// Fails with the first size out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("levels", self.levels as f64, 2.0, 13.0)?;
        in_range("window", self.window as f64, 2.0, 16.0)?;
        in_range("feature", self.feature as f64, 1.0, 6.0)?;
        in_range("falloff", self.falloff, 0.0, 1.0)
    }

    /// Index of the top level.
    pub fn top(&self) -> usize {
        self.levels - 1
    }

    /// Distance in samples from a window's centre to the far end of its feature: W(F+1).
    pub fn reach(&self) -> usize {
        self.window * (self.feature + 1)
    }

    /// Samples of the feature's causal half, W F + 1.
    pub fn causal_len(&self) -> usize {
        self.window * self.feature + 1
    }

    /// Samples of the feature's coarse half, 2 W (F+1) + 1.
    pub fn coarse_len(&self) -> usize {
        2 * self.reach() + 1
    }

    /// Samples of a whole feature.
    pub fn feature_len(&self) -> usize {
        self.causal_len() + self.coarse_len()
    }

    /// Weight of every sample of a feature, causal half first (§5.1).
    pub fn weights(&self) -> Vec<f64> {
        let reach = self.reach() as f64;
        let causal = (0..self.causal_len()).map(|i| reach - i as f64);
        let coarse = (0..self.coarse_len()).map(|i| (i as f64 - reach).abs());
        causal.chain(coarse).map(|distance| maths::exp(-self.falloff * distance)).collect()
    }

    /// The hat window (W - |W - i|) / W, i = 0..2W.
    pub fn hat(&self) -> Vec<f64> {
        let w = self.window as i64;
        (0..=2 * w).map(|i| (w - (w - i).abs()) as f64 * (1.0 / w as f64)).collect()
    }

    /// Samples of input after n that output sample n may depend on: the latency of a stream.
    pub fn latency_samples(&self) -> usize {
        let span = (1 << self.top()) - 1;
        let odd = self.window % 2;
        span * (2 * self.reach() + self.window + 1 + odd)
    }

    /// Period in samples after which the grid of all levels' windows repeats.
    pub fn period_samples(&self) -> usize {
        self.window << self.top()
    }
}

/// Position of a signal in the padded arrays of every level.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Padding {
    /// Array size of each level.
    pub size: Vec<usize>,
    /// First sample of the signal in each level.
    pub start: Vec<usize>,
    /// One past the last sample of the signal in each level.
    pub end: Vec<usize>,
}

impl Padding {
    /// Padding of a signal of `samples` to the smallest 2^k + 1 that holds it, with the signal in the middle. Fails if
    /// the top level would have an even size.
    pub fn new(samples: usize, levels: usize, what: &'static str) -> Result<Self, Error> {
        let least = (1 << levels.saturating_sub(1)) + 2;
        if samples < least {
            return Err(Error::TooShort { what, found: samples, least, remedy: "fewer levels" });
        }
        let padded = (samples - 1).next_power_of_two() + 1;
        let offset = (padded - samples) / 2;
        let mut padding = Self { size: vec![padded], start: vec![offset], end: vec![offset + samples] };
        for level in 1..levels {
            padding.size.push((padding.size[level - 1] - 1) / 2 + 1);
            padding.start.push(padding.start[level - 1].div_ceil(2));
            padding.end.push(padding.end[level - 1].div_ceil(2));
        }
        Ok(padding)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_matches_the_reference_shapes() {
        let padding = Padding::new(200, 6, "input").unwrap();
        assert_eq!(padding.size, [257, 129, 65, 33, 17, 9]);
        assert_eq!(padding.start, [28, 14, 7, 4, 2, 1]);
        assert_eq!(padding.end, [228, 114, 57, 29, 15, 8]);
        let padding = Padding::new(4096, 6, "input").unwrap();
        assert_eq!(padding.size, [4097, 2049, 1025, 513, 257, 129]);
        assert_eq!(padding.start, [0; 6]);
        assert_eq!(padding.end, [4096, 2048, 1024, 512, 256, 128]);
    }

    #[test]
    fn too_short_names_the_least_length() {
        let error = Padding::new(33, 6, "input").unwrap_err();
        assert_eq!(error, Error::TooShort { what: "input", found: 33, least: 34, remedy: "fewer levels" });
        assert_eq!(Padding::new(34, 6, "input").unwrap().size[5] % 2, 1);
    }

    #[test]
    fn default_sizes_are_the_papers() {
        let shape = PyramidConfig::default();
        assert_eq!((shape.causal_len(), shape.coarse_len(), shape.feature_len()), (13, 33, 46));
        assert_eq!(shape.latency_samples(), 1147);
    }
}
