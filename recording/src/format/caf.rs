//! CAF (Apple's Core Audio Format): 64-bit big-endian sizes; -1 for sound up to the end of the file.

use super::chunk::{Chunk, ChunkLayout, chunks};
use super::described::{Described, check_layout, damaged, unsupported};
use super::sound::Sound;
use crate::pcm::{Coding, Pcm, padded};
use crate::{Error, Note};

/// Flags of linear PCM.
const IS_FLOAT: u32 = 1;
const IS_LITTLE_ENDIAN: u32 = 2;

/// Bytes of the edit count before the sound.
const EDIT_COUNT_BYTES: usize = 4;

struct Format {
    channels: usize,
    sample_rate_hz: u32,
    flags: u32,
    bits: usize,
    /// Bytes of one sample in the file.
    sample_bytes: usize,
    /// Telephony coding, if it is one.
    law: Option<Coding>,
}

/// Reads the chunks up to the sound.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let mut format = None;
    for chunk in chunks(bytes, 8, ChunkLayout::Caf, &[b"desc", b"data"]) {
        match (&chunk.id, &format) {
            (b"desc", None) => format = Some(Format::read(&chunk, name)?),
            (b"data", Some(format)) => return format.sound(&chunk, name),
            (b"data", None) => return Err(damaged(name, "no desc chunk before the sound")),
            _ => {}
        }
    }
    Err(damaged(name, if format.is_some() { "no data chunk" } else { "no desc chunk" }))
}

impl Format {
    fn read(chunk: &Chunk, name: &str) -> Result<Self, Error> {
        let body = chunk.body;
        if body.len() < 32 {
            return Err(damaged(name, "a truncated format chunk"));
        }
        let u32_at = |at: usize| u32::from_be_bytes([body[at], body[at + 1], body[at + 2], body[at + 3]]);
        let law = match &body[8..12] {
            b"lpcm" => None,
            b"ulaw" => Some(Coding::MuLaw),
            b"alaw" => Some(Coding::ALaw),
            b"ima4" => return Err(unsupported(name, "CAF with ADPCM coding ('ima4')")),
            b"opus" => return Err(unsupported(name, "CAF with Opus coding")),
            other => {
                let coding: String = other.iter().map(|byte| char::from(*byte)).collect();
                return Err(unsupported(name, format!("CAF with coding '{}'", coding.escape_default())));
            }
        };
        let rate_hz = f64::from_be_bytes(*body.first_chunk().unwrap_or(&[0; 8]));
        let (channels, bits) = (u32_at(24) as usize, u32_at(28) as usize);
        check_layout(channels, Some(rate_hz as u32), name)?;
        let (flags, packet_bytes, packet_frames) = (u32_at(12), u32_at(16) as usize, u32_at(20));
        let sample_bytes = packet_bytes / channels;
        let fits = match law {
            Some(_) => sample_bytes == 1,
            None if flags & IS_FLOAT != 0 => matches!(bits, 32 | 64) && sample_bytes == bits / 8,
            None => (1..=32).contains(&bits) && (bits.div_ceil(8)..=4).contains(&sample_bytes),
        };
        if packet_frames != 1 || !packet_bytes.is_multiple_of(channels) || !fits {
            let found = format!("CAF with {bits} bits per sample in packets of {packet_bytes} bytes");
            return Err(unsupported(name, found));
        }
        Ok(Self { channels, sample_rate_hz: rate_hz as u32, flags, bits, sample_bytes, law })
    }

    fn sound<'a>(&self, chunk: &Chunk<'a>, name: &str) -> Result<(Described, Sound<'a>), Error> {
        let is_open = chunk.declared == u64::MAX;
        if !is_open {
            chunk.complete(name)?;
        }
        let data = chunk.body.get(EDIT_COUNT_BYTES..).unwrap_or_default();
        if data.len() < self.sample_bytes * self.channels {
            return Err(Error::NoSamples { name: name.into() });
        }
        let is_big_endian = self.flags & IS_LITTLE_ENDIAN == 0;
        let coding = match (self.law, self.flags & IS_FLOAT != 0) {
            (Some(law), _) => law,
            (None, true) if self.bits == 32 => Coding::Float32,
            (None, true) => Coding::Float64,
            (None, false) if self.sample_bytes > self.bits.div_ceil(8) => {
                padded(self.bits, self.sample_bytes, is_big_endian, data)
            }
            (None, false) => Coding::integer(self.bits),
        };
        // An open size is normal for this format, but a truncated file cannot be distinguished from a complete one.
        let frames = data.len() / (self.sample_bytes * self.channels);
        let found_s = frames as f64 / f64::from(self.sample_rate_hz);
        let notes = if is_open { vec![Note::UnknownLength { found_s }] } else { vec![] };
        let described = Described { channels: self.channels, sample_rate_hz: self.sample_rate_hz, notes };
        Ok((described, Sound::Pcm(Pcm { coding, is_big_endian, data })))
    }
}
