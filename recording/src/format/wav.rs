//! WAV, with 32-bit sizes (RIFF) or additional 64-bit ones (RF64, BW64: EBU Tech 3306).

use super::chunk::{Chunk, ChunkLayout, UNKNOWN_SIZE, chunks};
use super::described::{Described, check_layout, damaged, unsupported};
use super::sound::Sound;
use crate::pcm::{Coding, Pcm, padded};
use crate::{Error, Note};

/// Contents of a format chunk.
#[derive(Debug, Clone, Copy)]
pub(super) struct Format {
    channels: usize,
    sample_rate_hz: u32,
    tag: u16,
    bits: usize,
    /// Bytes of one sample in the file.
    sample_bytes: usize,
}

/// Reads the chunks up to the sound.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let is_wide = !bytes.starts_with(b"RIFF");
    let mut format = None;
    let mut wide_data_bytes = None;
    for chunk in chunks(bytes, 12, ChunkLayout::Riff, &[b"fmt ", b"data"]) {
        match (&chunk.id, format) {
            (b"ds64", _) if is_wide => wide_data_bytes = chunk.body.get(8..16).map(le_u64),
            (b"fmt ", None) => format = Some(Format::read(&chunk, name)?),
            (b"data", None) => return Err(damaged(name, "its sound comes before its format")),
            (b"data", Some(format)) => {
                let (data, notes) = data(&chunk, bytes, wide_data_bytes, &format, name)?;
                return format.sound(data, notes, name);
            }
            _ => {}
        }
    }
    Err(damaged(name, if format.is_some() { "no data chunk" } else { "no fmt chunk" }))
}

/// The bytes of the sound, however its size is stated.
fn data<'a>(
    chunk: &Chunk<'a>,
    bytes: &[u8],
    wide_bytes: Option<u64>,
    format: &Format,
    name: &str,
) -> Result<(&'a [u8], Vec<Note>), Error> {
    let declared = match wide_bytes {
        Some(wide_bytes) if chunk.declared == u64::from(u32::MAX) => wide_bytes,
        _ => chunk.declared,
    };
    let outer = bytes.get(4..8).map_or(0, |size| u64::from(le_u32(size)));
    // A recorder that was switched off before it could write the sizes leaves both at nothing.
    let was_never_closed = declared == 0 && (outer == 0 || outer >= UNKNOWN_SIZE) && !chunk.rest.is_empty();
    let found = chunk.rest.len() as u64;
    if was_never_closed || (declared >= UNKNOWN_SIZE && declared > found) {
        return Ok((chunk.rest, vec![format.unknown_length(chunk.rest)]));
    }
    if declared > found {
        return Err(Error::Truncated { name: name.into(), found, declared, unit: "bytes of sound" });
    }
    Ok((&chunk.rest[..declared as usize], vec![]))
}

impl Format {
    /// Reads Microsoft's `WAVEFORMATEX` and `WAVEFORMATEXTENSIBLE`, ignoring anything after the relevant fields.
    pub fn read(chunk: &Chunk, name: &str) -> Result<Self, Error> {
        chunk.complete(name)?;
        let body = chunk.body;
        if body.len() < 16 {
            return Err(damaged(name, format!("a format chunk of {} bytes, at least 16 are needed", body.len())));
        }
        let u16_at = |at: usize| u16::from_le_bytes([body[at], body[at + 1]]);
        let channels = usize::from(u16_at(2));
        let sample_rate_hz = le_u32(&body[4..8]);
        let (frame_bytes, bits) = (usize::from(u16_at(12)), usize::from(u16_at(14)));
        check_layout(channels, Some(sample_rate_hz), name)?;
        let tag = match u16_at(0) {
            0xfffe if body.len() >= 40 => u16_at(24),
            0xfffe => return Err(damaged(name, "a truncated extensible format chunk")),
            tag => tag,
        };
        check_coding(tag, bits, name)?;
        let expected = channels * bits.div_ceil(8);
        let is_padded =
            tag == 1 && frame_bytes.is_multiple_of(channels) && (expected..=4 * channels).contains(&frame_bytes);
        if frame_bytes != expected && !is_padded {
            if !bits.is_multiple_of(8) {
                return Err(unsupported(
                    name,
                    format!("WAV with {bits} bits per sample in frames of {frame_bytes} bytes"),
                ));
            }
            return Err(damaged(name, format!("frames of {frame_bytes} bytes where {expected} are expected")));
        }
        Ok(Self { channels, sample_rate_hz, tag, bits, sample_bytes: frame_bytes / channels })
    }

    /// Note that the sound has no stated end but the file's.
    pub fn unknown_length(&self, data: &[u8]) -> Note {
        let frames = data.len() / (self.sample_bytes * self.channels);
        Note::UnknownLength { found_s: frames as f64 / f64::from(self.sample_rate_hz) }
    }

    /// The sound of this format in `data`.
    pub fn sound<'a>(self, data: &'a [u8], notes: Vec<Note>, name: &str) -> Result<(Described, Sound<'a>), Error> {
        let coding = match (self.tag, self.bits) {
            (3, 32) => Coding::Float32,
            (3, _) => Coding::Float64,
            (6, _) => Coding::ALaw,
            (7, _) => Coding::MuLaw,
            (_, ..=8) if self.sample_bytes == 1 => Coding::Unsigned8,
            (_, bits) if self.sample_bytes > bits.div_ceil(8) => padded(bits, self.sample_bytes, false, data),
            (_, bits) => Coding::integer(bits),
        };
        if data.len() < coding.bytes() * self.channels {
            return Err(Error::NoSamples { name: name.into() });
        }
        let described = Described { channels: self.channels, sample_rate_hz: self.sample_rate_hz, notes };
        Ok((described, Sound::Pcm(Pcm { coding, is_big_endian: false, data })))
    }
}

/// Rejects unsupported codings, under the names that users know.
fn check_coding(tag: u16, bits: usize, name: &str) -> Result<(), Error> {
    let is_read = match tag {
        1 => (1..=32).contains(&bits),
        3 => matches!(bits, 32 | 64),
        6 | 7 => bits == 8,
        2 | 0x11 | 0x20 | 0x69 => return Err(unsupported(name, "WAV with ADPCM coding")),
        0x50 => return Err(unsupported(name, "WAV with MPEG layer 2 coding (0x0050)")),
        0x55 => return Err(unsupported(name, "WAV with MP3 coding (0x0055)")),
        other => return Err(unsupported(name, format!("WAV with coding 0x{other:04x}"))),
    };
    if is_read { Ok(()) } else { Err(unsupported(name, format!("WAV with {bits} bits per sample in coding {tag}"))) }
}

fn le_u32(bytes: &[u8]) -> u32 {
    bytes.first_chunk().map_or(0, |four| u32::from_le_bytes(*four))
}

fn le_u64(bytes: &[u8]) -> u64 {
    bytes.first_chunk().map_or(0, |eight| u64::from_le_bytes(*eight))
}
