//! Recognition of a file's format by its first bytes; file names are not trusted.

use super::described::{damaged, unsupported};
use super::{mpeg, w64};
use crate::Error;

/// Formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ContainerKind {
    Wav,
    Wave64,
    Aiff,
    Caf,
    Flac,
    Ogg,
    Mp3,
}

/// First bytes of sound that is not read.
const UNSUPPORTED: &[(&[u8], &str)] = &[
    (b"RIFX", "big-endian WAV (RIFX)"),
    (b"\x1aE\xdf\xa3", "Matroska or WebM (most often Opus)"),
    (b"0&\xb2u\x8e\x66\xcf\x11", "Windows Media (WMA)"),
    (b".snd", "Sun audio (AU)"),
    (b"wvpk", "WavPack"),
    (b"MAC ", "Monkey's Audio"),
    (b"#!AMR", "AMR"),
    (b"DSD ", "DSD"),
    (b"FRM8", "DSD"),
];

/// First bytes of files that are not sound.
const NOT_AUDIO: &[(&[u8], &str)] = &[
    (b"\x89PNG", "it is a PNG picture"),
    (b"\xff\xd8\xff", "it is a JPEG picture"),
    (b"%PDF", "it is a PDF document"),
    (b"PK\x03\x04", "it is a ZIP archive"),
];

/// The format; the error for an unsupported format states what the bytes appear to be.
pub(super) fn recognise(bytes: &[u8], name: &str) -> Result<ContainerKind, Error> {
    match (bytes.get(..4), bytes.get(8..12)) {
        (Some(b"RIFF" | b"RF64" | b"BW64"), Some(b"WAVE")) => return Ok(ContainerKind::Wav),
        (Some(b"RIFF" | b"RF64" | b"BW64" | b"FORM"), None) => return Err(damaged(name, "the header is truncated")),
        (Some(b"FORM"), Some(b"AIFF" | b"AIFC")) => return Ok(ContainerKind::Aiff),
        (Some(b"caff"), _) => return Ok(ContainerKind::Caf),
        (Some(b"fLaC"), _) => return Ok(ContainerKind::Flac),
        (Some(b"OggS"), _) => return Ok(ContainerKind::Ogg),
        _ if bytes.starts_with(w64::MARK) => return Ok(ContainerKind::Wave64),
        _ => {}
    }
    let starts_with = |(mark, _): &&(&[u8], &'static str)| bytes.starts_with(mark);
    if let Some((_, found)) = UNSUPPORTED.iter().find(starts_with) {
        return Err(unsupported(name, *found));
    }
    if bytes.get(4..8) == Some(b"ftyp") {
        return Err(unsupported(name, "MP4 or M4A"));
    }
    if let Some((_, found)) = NOT_AUDIO.iter().find(starts_with) {
        return Err(Error::NotAudio { name: name.into(), found: (*found).into() });
    }
    if mpeg::is_adts(bytes) {
        return Err(unsupported(name, "AAC"));
    }
    if mpeg::first(bytes).is_some() {
        return Ok(ContainerKind::Mp3);
    }
    let is_text = bytes.iter().take(512).all(|byte| matches!(byte, b'\t' | b'\n' | b'\r' | 0x20..=0x7e | 0x80..));
    let found = match is_text {
        true => "it looks like text".into(),
        false => format!("{} bytes of no known sound format", bytes.len()),
    };
    Err(Error::NotAudio { name: name.into(), found })
}
