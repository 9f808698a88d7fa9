//! FLAC (RFC 9639): frames found by their checksums, with every other block of metadata passed over.

use std::borrow::Cow;

use symphonia::core::codecs::audio::AudioCodecParameters;
use symphonia::core::codecs::audio::well_known::CODEC_ID_FLAC;

use super::described::{Described, check_layout, damaged};
use super::sound::{Link, Sound, SoundBounds};
use super::tags;
use crate::format::flac_frame::{Crc16, FrameHeader};
use crate::{Error, Note};

/// First bytes of a stream.
const MARK: &[u8; 4] = b"fLaC";

/// Bytes of the one block that is needed.
const STREAM_INFO_BYTES: usize = 34;

/// Number of apparent frame starts that are tried: chance produces one in many megabytes.
const MOST_CANDIDATES: usize = 64;

/// STREAMINFO, the one block of metadata that is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct StreamInfo {
    bytes: [u8; STREAM_INFO_BYTES],
    pub sample_rate_hz: u32,
    pub channels: usize,
    /// Samples per channel; none if the encoder did not know.
    pub samples: Option<u64>,
}

impl StreamInfo {
    /// Reads the body of a block.
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let bytes = *bytes.first_chunk::<STREAM_INFO_BYTES>()?;
        let packed = u64::from_be_bytes(*bytes[10..].first_chunk()?);
        let samples = Some(packed & ((1 << 36) - 1)).filter(|samples| *samples > 0);
        let (sample_rate_hz, channels) = ((packed >> 44) as u32, (packed >> 41 & 7) as usize + 1);
        Some(Self { bytes, sample_rate_hz, channels, samples })
    }

    /// A decoder's parameters, for blocks of any size.
    pub fn parameters(&self) -> AudioCodecParameters {
        let mut bytes = self.bytes;
        bytes[2..4].copy_from_slice(&u16::MAX.to_be_bytes());
        let mut parameters = AudioCodecParameters::new();
        parameters.for_codec(CODEC_ID_FLAC).with_sample_rate(self.sample_rate_hz).with_extra_data(bytes.into());
        parameters
    }

    /// Rejects a frame that does not have this stream's rate and channels.
    pub fn check_frame(&self, frame: &FrameHeader, samples_before: u64, name: &str) -> Result<(), Error> {
        let changes = [
            ("sample rate in Hz", self.sample_rate_hz, frame.sample_rate_hz.unwrap_or(self.sample_rate_hz)),
            ("number of channels", self.channels as u32, frame.channels as u32),
        ];
        let at_s = samples_before as f64 / f64::from(self.sample_rate_hz.max(1));
        match changes.into_iter().find(|(_, from, to)| from != to) {
            Some((what, from, to)) => Err(Error::Changes { name: name.into(), what, from, to, at_s }),
            None => Ok(()),
        }
    }
}

/// Reads all streams in a file: usually one, but files can be joined.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let bytes = tags::without_trailing(bytes);
    let (mut at, mut links, mut notes) = (0, vec![], vec![]);
    let mut first: Option<StreamInfo> = None;
    let mut samples = 0;
    while bytes[at..].starts_with(MARK) {
        let broken = || damaged(name, "its FLAC header is truncated");
        let (info, frames_at) = header(bytes, at).ok_or_else(broken)?;
        let first = *first.get_or_insert(info);
        check_layout(first.channels, Some(first.sample_rate_hz), name)?;
        let frames = Frames { bytes, first, name };
        let (packets, end) = frames.all(frames_at, &mut samples)?;
        links.push(Link {
            parameters: info.parameters(),
            packets,
            ends: SoundBounds::default(),
            declared_samples: info.samples,
        });
        at = end + tags::all_at_start(&bytes[end..]);
    }
    let left = bytes[at..].iter().filter(|byte| **byte != 0).count();
    if left > 0 {
        notes.push(Note::Skipped { bytes: bytes.len() - at });
    }
    let first = first.ok_or_else(|| damaged(name, "its FLAC header is truncated"))?;
    let described = Described { channels: first.channels, sample_rate_hz: first.sample_rate_hz, notes };
    Ok((described, Sound::Packets(links)))
}

/// A stream's information and the start of its frames. If the sizes of blocks are misleading, the first frame is
/// searched for instead.
fn header(bytes: &[u8], start: usize) -> Option<(StreamInfo, usize)> {
    let mut at = start + MARK.len();
    let mut info = None;
    loop {
        let [flags, high, middle, low] = *bytes.get(at..)?.first_chunk::<4>()?;
        let length = usize::from(high) << 16 | usize::from(middle) << 8 | usize::from(low);
        let body = &bytes[at + 4..];
        if flags & 0x7f == 0 && info.is_none() {
            info = Some((StreamInfo::read(body)?, at + 4 + STREAM_INFO_BYTES));
        }
        at += 4 + length;
        if at >= bytes.len() || flags & 0x80 != 0 {
            break;
        }
    }
    let (info, after_info) = info?;
    let is_frame = |at: &usize| bytes.get(*at..).and_then(FrameHeader::read).is_some();
    if is_frame(&at) || at == bytes.len() {
        return Some((info, at));
    }
    (after_info..bytes.len()).find(is_frame).map(|at| (info, at))
}

/// Frames with their headers and checksums.
type Packets<'a> = Vec<Cow<'a, [u8]>>;

struct Frames<'a, 'n> {
    bytes: &'a [u8],
    first: StreamInfo,
    name: &'n str,
}

impl<'a> Frames<'a, '_> {
    /// The frames from `at` on, and the start of whatever follows them.
    fn all(&self, mut at: usize, samples: &mut u64) -> Result<(Packets<'a>, usize), Error> {
        let mut packets = vec![];
        while let Some(header) = FrameHeader::read(&self.bytes[at..]) {
            self.first.check_frame(&header, *samples, self.name)?;
            let end = match self.end(at) {
                Some(end) => end,
                None => self.end_of_last(at, &header)?,
            };
            packets.push(Cow::Borrowed(&self.bytes[at..end]));
            *samples += header.samples;
            at = end;
        }
        // Frames after an invalid one mean that those in between were lost.
        let is_lost = !self.is_boundary(at) && self.has_whole_frame(at + 1, 0);
        if is_lost {
            return Err(damaged(self.name, format!("the bytes from {at} on are not a frame of sound")));
        }
        Ok((packets, at))
    }

    /// True if a frame of at least this number begins at `from` or later.
    fn has_whole_frame(&self, from: usize, least_number: u64) -> bool {
        let is_later = |at: &usize| {
            let header = FrameHeader::read(&self.bytes[*at..]);
            header.is_some_and(|header| header.number >= least_number && header.channels == self.first.channels)
        };
        let mut candidates = (from..self.bytes.len()).filter(is_later).take(MOST_CANDIDATES);
        candidates.any(|at| self.end(at).is_some())
    }

    /// The end of a frame: where its checksum is correct and something that can follow begins.
    fn end(&self, at: usize) -> Option<usize> {
        let mut crc = Crc16::default();
        self.bytes[at..].iter().enumerate().find_map(|(offset, byte)| {
            crc.add(*byte);
            let end = at + offset + 1;
            (crc.is_clean() && self.is_boundary(end)).then_some(end)
        })
    }

    fn is_boundary(&self, at: usize) -> bool {
        let rest = &self.bytes[at..];
        rest.is_empty() || rest.starts_with(MARK) || tags::at_start(rest) > 0 || FrameHeader::read(rest).is_some()
    }

    /// A frame whose checksum is never correct is the last one, truncated or followed by other bytes, or it is damaged.
    fn end_of_last(&self, at: usize, header: &FrameHeader) -> Result<usize, Error> {
        if self.has_whole_frame(at + 1, header.number_of_next()) {
            let reason = format!("the frame of sound at byte {at} is damaged, or those after it are missing");
            return Err(damaged(self.name, reason));
        }
        Ok(self.bytes.len())
    }
}
