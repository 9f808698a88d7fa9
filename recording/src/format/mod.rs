//! From a file's bytes to a clean stream of sound: which format it is, and where in it the sound stands.
//!
//! | file | reads |
//! |---|---|
//! | `wav`, `w64`, `aiff`, `caf` | chunks, up to plain samples |
//! | `flac`, `mp3` | frames, with the tags and headers round them passed over |
//! | `ogg` | pages, then packets of Vorbis or FLAC |
//!
//! No count is believed before it has been compared with the bytes that are there, and nothing that is not sound can
//! keep sound from being read.

mod aiff;
mod caf;
mod chunk;
mod flac;
mod flac_frame;
mod kind;
mod mp3;
mod mpeg;
mod ogg;
mod ogg_page;
mod tags;
mod vorbis;
mod w64;
mod wav;

use std::borrow::Cow;

use symphonia::core::codecs::audio::AudioCodecParameters;

use self::kind::Kind;
use crate::pcm::Pcm;
use crate::{Error, MAX_CHANNELS, MAX_SAMPLE_RATE_HZ, MAX_SAMPLES, MAX_SECONDS, MIN_SAMPLE_RATE_HZ, Note};

/// What is known of a sound before it is decoded.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Described {
    pub channels: usize,
    pub sample_rate_hz: u32,
    pub notes: Vec<Note>,
}

/// A sound not yet decoded.
#[derive(Debug)]
pub(crate) enum Sound<'a> {
    Pcm(Pcm<'a>),
    Packets(Vec<Link<'a>>),
}

/// Packets that one decoder decodes one after the other. A file of several has been joined from as many.
#[derive(Debug)]
pub(crate) struct Link<'a> {
    pub parameters: AudioCodecParameters,
    pub packets: Vec<Cow<'a, [u8]>>,
    pub ends: Ends,
    /// Samples per channel that must come out, where the format counts them exactly.
    pub declared_samples: Option<u64>,
}

/// What of a link's samples is no sound.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Ends {
    /// Samples at its start that belong to the coder.
    pub skip_start: u64,
    /// Samples at its end that belong to the coder.
    pub skip_end: u64,
    /// The coder's own clock, which says the same in its way.
    pub clock: Option<vorbis::Clock>,
}

/// Finds the sound in a file.
pub(crate) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    // What makes of a FLAC or MP3 file a tagged one may stand before others, too.
    let start = tags::all_at_start(bytes);
    let sound = &bytes[start..];
    match kind::of(sound, name)? {
        Kind::Wav => wav::read(sound, name),
        Kind::Wave64 => w64::read(sound, name),
        Kind::Aiff => aiff::read(sound, name),
        Kind::Caf => caf::read(sound, name),
        Kind::Flac => flac::read(sound, name),
        Kind::Ogg => ogg::read(sound, name),
        Kind::Mp3 => mp3::read(sound, name),
    }
}

impl Described {
    /// Fails where so many samples per channel are more than are allowed.
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

/// Refuses channel counts and rates that no engine takes.
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

fn unsupported(name: &str, found: impl Into<String>) -> Error {
    Error::Unsupported { name: name.into(), found: found.into() }
}
