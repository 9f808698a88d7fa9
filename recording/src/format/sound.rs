//! The sound in a file, before anything is decoded.

use std::borrow::Cow;

use symphonia::core::codecs::audio::AudioCodecParameters;

use super::vorbis_clock::Clock;
use crate::pcm::Pcm;

/// Sound that is not yet decoded.
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
    pub ends: SoundBounds,
    /// Exact number of samples per channel, if the format states it.
    pub declared_samples: Option<u64>,
}

/// Samples of a link that are not sound.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct SoundBounds {
    /// Samples at its start that belong to the coder.
    pub skip_start: u64,
    /// Samples at its end that the coder added.
    pub skip_end: u64,
    /// The coder's own clock, which carries the same information.
    pub clock: Option<Clock>,
}
