//! MPEG audio: consecutive frames, with tags and encoders' headers between them.
//!
//! Every header frame begins a new link, so that joined files are read completely. A header's count never ends the
//! sound; if it is correct, the encoder's delay and padding are removed.

use std::borrow::Cow;

use symphonia::core::codecs::audio::AudioCodecParameters;
use symphonia::core::codecs::audio::well_known::{CODEC_ID_MP1, CODEC_ID_MP2, CODEC_ID_MP3};

use super::described::{Described, check_layout, damaged};
use super::mpeg::{self, Header, Info};
use super::sound::{Link, Sound, SoundBounds};
use super::tags;
use crate::{Error, Note};

/// Number of consecutive frames that must match before the stream resumes after other bytes.
const RESUMING_FRAMES: usize = 2;

/// One item of the stream.
enum Here {
    Frame(Header),
    /// A tag, or unknown bytes: their number, and whether to mention them.
    Other(usize, bool),
    Cut,
}

/// Frames of one file, if several were joined.
#[derive(Default)]
struct Part<'a> {
    info: Option<Info>,
    frames: Vec<Cow<'a, [u8]>>,
}

/// Reads all frames.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let bytes = tags::without_trailing(bytes);
    let (start, first) = mpeg::first(bytes).ok_or_else(|| damaged(name, "no complete frame"))?;
    check_layout(first.channels, Some(first.sample_rate_hz), name)?;
    let (mut parts, mut notes, mut skipped) = (vec![Part::default()], vec![], 0);
    let (mut at, mut samples) = (start, 0);
    while at < bytes.len() {
        match here(bytes, at, &first) {
            Here::Frame(header) => {
                let at_s = samples as f64 / f64::from(first.sample_rate_hz);
                check_same(&first, &header, at_s, name)?;
                samples += header.samples;
                add(&mut parts, &bytes[at..at + header.frame_bytes], &header);
                at += header.frame_bytes;
            }
            Here::Other(length, is_worth_a_word) => {
                skipped += if is_worth_a_word { length } else { 0 };
                at += length;
            }
            Here::Cut => {
                notes.push(Note::BreaksOff { what: "frame" });
                break;
            }
        }
    }
    if skipped > 0 {
        notes.push(Note::Skipped { bytes: skipped });
    }
    parts.retain(|part| !part.frames.is_empty());
    let links = parts.into_iter().map(|part| link(part, &first, &mut notes)).collect();
    let described = Described { channels: first.channels, sample_rate_hz: first.sample_rate_hz, notes };
    Ok((described, Sound::Packets(links)))
}

fn here(bytes: &[u8], at: usize, first: &Header) -> Here {
    let rest = &bytes[at..];
    match Header::read(rest) {
        // A different kind of frame counts only if the stream continues with it.
        Some(header) if header.is_like(first) || header.is_followed(bytes, at, RESUMING_FRAMES) => {
            return if header.frame_bytes <= rest.len() { Here::Frame(header) } else { Here::Cut };
        }
        _ => {}
    }
    match tags::at_start(rest) {
        0 => {}
        length => return Here::Other(length, false),
    }
    let resumes = |offset: &usize| {
        let frame = Header::read(&rest[*offset..]);
        frame.is_some_and(|header| header.is_followed(bytes, at + offset, RESUMING_FRAMES))
            || tags::at_start(&rest[*offset..]) > 0
    };
    let length = (1..rest.len()).find(resumes).unwrap_or(rest.len());
    // Zeros fill space that a recorder reserved, and an ID3v1 tag was the end of a file that is now in the middle.
    let is_filling = rest[..length].iter().all(|byte| *byte == 0) || rest.starts_with(b"TAG");
    Here::Other(length, !is_filling)
}

fn check_same(first: &Header, header: &Header, at_s: f64, name: &str) -> Result<(), Error> {
    let changes = [
        ("sample rate in Hz", first.sample_rate_hz, header.sample_rate_hz),
        ("number of channels", first.channels as u32, header.channels as u32),
        ("MPEG layer", first.layer, header.layer),
    ];
    match changes.into_iter().find(|(_, from, to)| from != to) {
        Some((what, from, to)) => Err(Error::Changes { name: name.into(), what, from, to, at_s }),
        None => Ok(()),
    }
}

fn add<'a>(parts: &mut Vec<Part<'a>>, frame: &'a [u8], header: &Header) {
    match (Info::read(frame, header), parts.last_mut()) {
        (Some(info), _) => parts.push(Part { info: Some(info), frames: vec![] }),
        (None, Some(part)) => part.frames.push(Cow::Borrowed(frame)),
        (None, None) => {}
    }
}

fn link<'a>(part: Part<'a>, first: &Header, notes: &mut Vec<Note>) -> Link<'a> {
    let found = part.frames.len() as u64;
    let declared = part.info.and_then(|info| info.frames).map_or(found, u64::from);
    // Some encoders count the header, too.
    let is_right = declared == found || declared == found + 1;
    if !is_right {
        notes.push(Note::CountDiffers { declared, found, unit: "frames" });
    }
    let (delay, padding) = part.info.map_or((0, 0), |info| (info.delay, info.padding));
    let mut parameters = AudioCodecParameters::new();
    parameters.for_codec(match first.layer {
        1 => CODEC_ID_MP1,
        2 => CODEC_ID_MP2,
        _ => CODEC_ID_MP3,
    });
    parameters.with_sample_rate(first.sample_rate_hz);
    let skip_end = if is_right { padding } else { 0 };
    let ends = SoundBounds { skip_start: delay, skip_end, ..SoundBounds::default() };
    Link { parameters, packets: part.frames, ends, declared_samples: None }
}
