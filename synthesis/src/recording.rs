//! From a recording to a dictionary: as the paper takes it, or as companding does.

use crate::Error;
use crate::companding::Profile;
use crate::companding::bands::Power;
use crate::companding::calibrate::{Goal, calibrate};
use crate::crackle::{Split, is_impulsive, split};
use crate::dsp::{integrated_lufs, mean_of};
use crate::structure::MatchingMode;
use crate::texture::PyramidConfig;
use crate::texture::dictionary::{Dictionary, Progress, check};

/// The part of the work after which a companded dictionary is ready for its trial run.
const INDEXED: f32 = 0.7;

impl Dictionary {
    /// Analyses a recording as [`new`](Self::new) or [`companded`](Self::companded), whichever `dynamics` asks for.
    pub fn for_dynamics(
        dynamics: MatchingMode,
        channels: &[Vec<f64>],
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        match dynamics {
            MatchingMode::Paper => {
                let mut dictionary = Self::new(channels, sample_rate_hz, shape, progress)?;
                dictionary.set_impulsive(is_impulsive(channels, sample_rate_hz));
                Ok(dictionary)
            }
            MatchingMode::Companded => Self::companded(channels, sample_rate_hz, shape, progress),
        }
    }

    /// Analyses a recording's bed ([`crate::crackle`]) without its slow loudness ([`crate::companding`]), keeps its crackles
    /// apart, and finds its level and equaliser by a trial run. Takes and fails as [`new`](Self::new).
    pub fn companded(
        channels: &[Vec<f64>],
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        check(channels, sample_rate_hz, shape)?;
        let lufs = integrated_lufs(channels, sample_rate_hz);
        let Split { mut bed, crackles } = split(channels, sample_rate_hz);
        let power = Power::of(&mean_of(&bed), sample_rate_hz);
        let goal = Goal::of(&bed, &power, sample_rate_hz, crackles.is_some());
        let mut profile = Profile::compress_with(&mut bed, &power, sample_rate_hz);
        let mut dictionary = Self::of_channels(bed, sample_rate_hz, shape, &|done| progress(INDEXED * done))?;
        profile.set_loudness(lufs);
        dictionary.set_parts(profile, crackles);
        calibrate(dictionary, &goal, &|done: f32| progress(INDEXED + (1.0 - INDEXED) * done))
    }
}
