//! AIFF and AIFF-C: the layout in `COMM`, the sound in `SSND`, in either order; numbers are big-endian.

use super::chunk::{Chunk, ChunkLayout, UNKNOWN_SIZE, chunks};
use super::described::{Described, check_layout, damaged, unsupported};
use super::sound::Sound;
use crate::pcm::{Coding, Pcm};
use crate::{Error, Note};

/// Contents of the common chunk.
struct Common {
    channels: usize,
    sample_rate_hz: u32,
    frames: u64,
    coding: Coding,
    is_big_endian: bool,
}

/// Reads both chunks; exactly as many frames as `COMM` counts are sound.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    let is_compressed = bytes.get(8..12) == Some(b"AIFC");
    let (mut common, mut sound) = (None, None);
    for chunk in chunks(bytes, 12, ChunkLayout::Iff, &[b"COMM", b"SSND"]) {
        match &chunk.id {
            b"COMM" if common.is_none() => common = Some(Common::read(&chunk, is_compressed, name)?),
            b"SSND" if sound.is_none() => sound = Some(chunk),
            _ => {}
        }
    }
    let common = common.ok_or_else(|| damaged(name, "no COMM chunk"))?;
    let sound = match sound {
        Some(sound) => sound,
        // Without sound the chunk may be omitted.
        None if common.frames == 0 => return Err(Error::NoSamples { name: name.into() }),
        None => return Err(damaged(name, "no SSND chunk")),
    };
    common.sound(&sound, name)
}

impl Common {
    fn read(chunk: &Chunk, is_compressed: bool, name: &str) -> Result<Self, Error> {
        let body = chunk.body;
        if body.len() < 18 {
            return Err(damaged(name, "a truncated format chunk"));
        }
        let channels = usize::from(u16::from_be_bytes([body[0], body[1]]));
        let frames = u64::from(u32::from_be_bytes([body[2], body[3], body[4], body[5]]));
        let bits = usize::from(u16::from_be_bytes([body[6], body[7]]));
        let sample_rate_hz = rate_hz(body);
        check_layout(channels, Some(sample_rate_hz), name)?;
        let (coding, is_big_endian) = match body.get(18..22).filter(|_| is_compressed) {
            Some(kind) => compressed(kind, bits, name)?,
            None => (integer(bits, name)?, true),
        };
        Ok(Self { channels, sample_rate_hz, frames, coding, is_big_endian })
    }

    /// The counted frames, after the offset that block-aligned files have.
    fn sound<'a>(self, chunk: &Chunk<'a>, name: &str) -> Result<(Described, Sound<'a>), Error> {
        let frame_bytes = (self.coding.bytes() * self.channels) as u64;
        let is_open = chunk.declared >= UNKNOWN_SIZE && !chunk.is_complete();
        if !is_open {
            chunk.complete(name)?;
        }
        let body = if is_open { chunk.rest } else { chunk.body };
        let offset = body.first_chunk().map_or(0, |four| u32::from_be_bytes(*four) as usize);
        let data = body.get(8..).and_then(|data| data.get(offset..)).unwrap_or_default();
        let found = data.len() as u64;
        // A recorder that was switched off before it could count leaves nothing there.
        let is_uncounted = self.frames == 0 && found >= frame_bytes;
        let mut notes = vec![];
        if is_open || is_uncounted {
            let found_s = (found / frame_bytes) as f64 / f64::from(self.sample_rate_hz);
            notes.push(Note::UnknownLength { found_s });
        }
        let declared = if is_open || is_uncounted { found } else { self.frames * frame_bytes };
        if found < declared {
            return Err(Error::Truncated { name: name.into(), found, declared, unit: "bytes of sound" });
        }
        let pcm = Pcm { coding: self.coding, is_big_endian: self.is_big_endian, data: &data[..declared as usize] };
        Ok((Described { channels: self.channels, sample_rate_hz: self.sample_rate_hz, notes }, Sound::Pcm(pcm)))
    }
}

/// AIFF-C's codings of plain samples. Those with a fixed size have it whatever depth the file declares: mu-law usually
/// states 16, the depth of its decoded samples.
fn compressed(kind: &[u8], bits: usize, name: &str) -> Result<(Coding, bool), Error> {
    Ok(match kind {
        b"NONE" | b"twos" => (integer(bits, name)?, true),
        b"sowt" => (integer(bits, name)?, false),
        b"in24" => (Coding::integer(24), true),
        b"in32" => (Coding::integer(32), true),
        b"42ni" => (Coding::integer(24), false),
        b"23ni" => (Coding::integer(32), false),
        b"raw " => (Coding::Unsigned8, true),
        b"fl32" | b"FL32" => (Coding::Float32, true),
        b"fl64" | b"FL64" => (Coding::Float64, true),
        b"ulaw" | b"ULAW" => (Coding::MuLaw, true),
        b"alaw" | b"ALAW" => (Coding::ALaw, true),
        b"ima4" => return Err(unsupported(name, "AIFF-C with ADPCM coding ('ima4')")),
        other => {
            let coding: String = other.iter().map(|byte| char::from(*byte)).collect();
            return Err(unsupported(name, format!("AIFF-C with coding '{}'", coding.escape_default())));
        }
    })
}

fn integer(bits: usize, name: &str) -> Result<Coding, Error> {
    match bits {
        1..=32 => Ok(Coding::integer(bits)),
        _ => Err(unsupported(name, format!("AIFF with {bits} bits per sample"))),
    }
}

/// The rate is an 80-bit float: sign and exponent (bias 16383), then a 64-bit mantissa with its leading one.
fn rate_hz(comm: &[u8]) -> u32 {
    let exponent = i32::from(u16::from_be_bytes([comm[8], comm[9]]) & 0x7fff) - 16383;
    let mantissa = comm[10..18].iter().fold(0u64, |sum, byte| sum << 8 | u64::from(*byte));
    let is_negative = comm[8] & 0x80 != 0;
    if is_negative { 0 } else { (mantissa as f64 * maths::powi(2.0, exponent - 63)).round() as u32 }
}
