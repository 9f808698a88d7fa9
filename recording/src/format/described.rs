//! A format's header, checked against the limits of recordings.

use crate::{Error, MAX_CHANNELS, MAX_SAMPLE_RATE_HZ, MAX_SAMPLES, MAX_SECONDS, MIN_SAMPLE_RATE_HZ, Note};

/// Description of a sound before it is decoded.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Described {
    pub channels: usize,
    pub sample_rate_hz: u32,
    pub notes: Vec<Note>,
}

impl Described {
    /// Fails if there are more samples per channel than allowed.
    pub fn check_length(&self, samples: u64, name: &str) -> Result<(), Error> {
        let found = samples.saturating_mul(self.channels as u64);
        let found_s = samples as f64 / f64::from(self.sample_rate_hz.max(1));
        if found_s > f64::from(MAX_SECONDS) {
            return Err(Error::TooLong { name: name.into(), found_s });
        }
        if found > MAX_SAMPLES as u64 {
            return Err(Error::TooManySamples { name: name.into(), found });
        }
        Ok(())
    }
}

/// Rejects channel counts and rates that no engine supports.
pub(crate) fn check_layout(channels: usize, rate_hz: Option<u32>, name: &str) -> Result<(), Error> {
    let name = || name.to_string();
    match (channels, rate_hz) {
        (0, _) => Err(Error::NoChannels { name: name() }),
        (found, _) if found > MAX_CHANNELS => Err(Error::TooManyChannels { name: name(), found }),
        (_, Some(found_hz)) if !(MIN_SAMPLE_RATE_HZ..=MAX_SAMPLE_RATE_HZ).contains(&found_hz) => {
            Err(Error::SampleRate { name: name(), found_hz })
        }
        _ => Ok(()),
    }
}

pub(crate) fn damaged(name: &str, reason: impl Into<String>) -> Error {
    Error::Damaged { name: name.into(), reason: reason.into() }
}

pub(crate) fn unsupported(name: &str, found: impl Into<String>) -> Error {
    Error::Unsupported { name: name.into(), found: found.into() }
}
