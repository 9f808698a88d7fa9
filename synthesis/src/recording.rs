//! What the engines learn from a recording: texture's windows, companding's profile, and its crackles, as one object that
//! is loaded, stored and replaced together.

use std::io::{self, Read, Write};
use std::sync::Arc;

use bitcode::{Decode, Encode};

use crate::Error;
use crate::bulk::{bulk_fields, read_value, write_value};
use crate::companding::Profile;
use crate::companding::bands::Power;
use crate::companding::calibrate::{Goal, calibrate};
use crate::crackle::{Crackles, Split, is_impulsive, split};
use crate::dsp::{integrated_lufs, mean_of};
use crate::structure::MatchingMode;
use crate::texture::PyramidConfig;
use crate::texture::dictionary::{Dictionary, Progress, check};

/// The part of the work after which a companded dictionary is ready for its trial run.
const INDEXED: f32 = 0.7;

/// The dictionary of a recording, with all that belongs to it.
#[derive(Debug)]
pub struct RecordingDictionary {
    windows: Arc<Dictionary>,
    extras: Extras,
}

/// What the companded mode knows of a recording besides its windows.
#[derive(Debug, Default, Encode, Decode)]
struct Extras {
    /// Companding data; none for the paper's dynamics.
    profile: Option<Profile>,
    /// Crackles that were separated from the recording before.
    crackles: Option<Crackles>,
}

bulk_fields!(Extras: crackles);

impl RecordingDictionary {
    /// Analyses a recording as `dynamics` asks for: as [`Dictionary::new`], or [companded](Self::companded). `channels`
    /// are equally long (1-10), their samples finite, at `sample_rate_hz`.
    ///
    /// # Errors
    /// As [`Dictionary::new`].
    pub fn new(
        dynamics: MatchingMode,
        channels: &[Vec<f64>],
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        match dynamics {
            MatchingMode::Paper => {
                let mut windows = Dictionary::new(channels, sample_rate_hz, shape, progress)?;
                windows.set_impulsive(is_impulsive(channels, sample_rate_hz));
                Ok(Self::from(windows))
            }
            MatchingMode::Companded => Self::companded(channels, sample_rate_hz, shape, progress),
        }
    }

    /// Analyses a recording's bed ([`crate::crackle`]) without its slow loudness ([`crate::companding`]), keeps its crackles
    /// apart, and finds its level and equaliser by a trial run.
    ///
    /// # Errors
    /// As [`Dictionary::new`].
    pub fn companded(
        channels: &[Vec<f64>],
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        check(channels, sample_rate_hz, shape)?;
        let lufs = integrated_lufs(channels, sample_rate_hz);
        let Split { mut bed, mut crackles } = split(channels, sample_rate_hz);
        let power = Power::of_signal(&mean_of(&bed), sample_rate_hz);
        let goal = Goal::of_bed(&bed, &power, sample_rate_hz, crackles.is_some());
        let (removed, mut profile) = Profile::compress_with(&mut bed, &power, sample_rate_hz);
        let mut windows = Dictionary::of_channels(bed, sample_rate_hz, shape, &|done| progress(INDEXED * done))?;
        windows.set_removed_loudness(removed);
        let windows = Arc::new(windows);
        profile.set_loudness(lufs);
        let calibrating = |done: f32| progress(INDEXED + (1.0 - INDEXED) * done);
        calibrate(&windows, &mut profile, crackles.as_mut(), &goal, &calibrating)?;
        Ok(Self { windows, extras: Extras { profile: Some(profile), crackles } })
    }

    /// Writes the dictionary, for [`read_from`](Self::read_from) in the same build on the same machine: it is a copy of
    /// memory, not a file format.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_to(&self, out: &mut dyn Write) -> io::Result<()> {
        write_value(&*self.windows, out)?;
        write_value(&self.extras, out)
    }

    /// Reads the output of [`write_to`](Self::write_to). `len` is the largest number of bytes: no more memory is used.
    /// The caller must verify that the bytes are complete; damaged ones may give a dictionary that sounds wrong.
    ///
    /// # Errors
    /// The errors of `from`, and [`io::ErrorKind::InvalidData`] if it does not contain a dictionary.
    pub fn read_from(from: &mut dyn Read, len: u64) -> io::Result<Self> {
        let mut left = len;
        let windows = Arc::new(read_value(from, &mut left)?);
        Ok(Self { windows, extras: read_value(from, &mut left)? })
    }

    /// The windows in which texture searches.
    pub fn windows(&self) -> &Arc<Dictionary> {
        &self.windows
    }

    /// The recording's side of companding; none for the paper's dynamics.
    pub fn profile(&self) -> Option<&Profile> {
        self.extras.profile.as_ref()
    }

    /// The crackles separated from it, if there are any.
    pub fn crackles(&self) -> Option<&Crackles> {
        self.extras.crackles.as_ref()
    }

    /// See [`Dictionary::is_impulsive`].
    pub fn is_impulsive(&self) -> bool {
        self.windows.is_impulsive()
    }

    /// Approximate number of bytes held.
    pub fn bytes(&self) -> usize {
        let profile = self.extras.profile.as_ref().map_or(0, Profile::bytes);
        self.windows.bytes() + profile + self.extras.crackles.as_ref().map_or(0, Crackles::bytes)
    }
}

/// For the paper's dynamics: windows alone.
impl From<Dictionary> for RecordingDictionary {
    fn from(windows: Dictionary) -> Self {
        Self { windows: Arc::new(windows), extras: Extras::default() }
    }
}
