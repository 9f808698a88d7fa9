//! From a file's bytes to a clean stream of sound: its format, and the position of its sound.
//!
//! | file | contents |
//! |---|---|
//! | `wav`, `w64`, `aiff`, `caf` | chunks, up to plain samples |
//! | `flac`, `mp3` | frames, skipping tags and headers around them |
//! | `ogg` | pages, then packets of Vorbis or FLAC |
//! | `described`, `sound` | the types that all of them return |
//!
//! No count is trusted before it has been compared with the bytes present, and anything that is not sound cannot
//! prevent sound from being read.

mod aiff;
mod caf;
mod chunk;
pub(crate) mod described;
mod flac;
mod flac_frame;
mod kind;
mod mp3;
mod mpeg;
mod ogg;
mod ogg_page;
mod sound;
mod tags;
mod vorbis;
mod vorbis_clock;
mod w64;
mod wav;

use self::kind::ContainerKind;
use crate::Error;

pub(crate) use self::described::{Described, check_layout, damaged};
pub(crate) use self::sound::{Link, Sound};

/// Finds the sound in a file.
pub(crate) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    // The tags of FLAC or MP3 files may also precede other formats.
    let start = tags::all_at_start(bytes);
    let sound = &bytes[start..];
    match kind::recognise(sound, name)? {
        ContainerKind::Wav => wav::read(sound, name),
        ContainerKind::Wave64 => w64::read(sound, name),
        ContainerKind::Aiff => aiff::read(sound, name),
        ContainerKind::Caf => caf::read(sound, name),
        ContainerKind::Flac => flac::read(sound, name),
        ContainerKind::Ogg => ogg::read(sound, name),
        ContainerKind::Mp3 => mp3::read(sound, name),
    }
}
