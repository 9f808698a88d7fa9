//! Wave64 (Sony), written by field recorders: WAV whose chunks have names of 16 bytes and sizes of 64 bits.

use super::chunk::{Chunk, UNKNOWN_SIZE};
use super::described::{Described, damaged};
use super::sound::Sound;
use super::wav::Format;
use crate::Error;

/// First bytes of a file.
pub(super) const MARK: &[u8; 16] = b"riff\x2e\x91\xcf\x11\xa5\xd6\x28\xdb\x04\xc1\0\0";

/// Rest of all other names, after their four letters.
const NAME_END: &[u8; 12] = b"\xf3\xac\xd3\x11\x8c\xd1\0\xc0\x4f\x8e\xdb\x8a";

/// Bytes of a chunk's header, which are included in its size.
const HEADER_BYTES: usize = 24;

/// Reads the chunks up to the sound.
pub(super) fn read<'a>(bytes: &'a [u8], name: &str) -> Result<(Described, Sound<'a>), Error> {
    if bytes.get(24..28) != Some(b"wave") {
        return Err(damaged(name, "the header is truncated"));
    }
    let mut format = None;
    for chunk in chunks(bytes) {
        match (&chunk.id, format) {
            (b"fmt ", _) => format = Some(Format::read(&chunk, name)?),
            (b"data", None) => return Err(damaged(name, "its sound comes before its format")),
            (b"data", Some(format)) => {
                let is_open = chunk.declared >= UNKNOWN_SIZE && !chunk.is_complete();
                if is_open {
                    return format.sound(chunk.rest, vec![format.unknown_length(chunk.rest)], name);
                }
                chunk.complete(name)?;
                return format.sound(chunk.body, vec![], name);
            }
            _ => {}
        }
    }
    Err(damaged(name, if format.is_some() { "no data chunk" } else { "no fmt chunk" }))
}

/// The chunks after the file's own header, at multiples of eight bytes.
fn chunks(bytes: &[u8]) -> impl Iterator<Item = Chunk<'_>> {
    let mut at = 40;
    std::iter::from_fn(move || {
        let header = bytes.get(at..)?.first_chunk::<HEADER_BYTES>()?;
        let (id, size) = (*header.first_chunk::<4>()?, u64::from_le_bytes(*header[16..].first_chunk()?));
        if header[4..16] != NAME_END[..] {
            return None;
        }
        let declared = size.checked_sub(HEADER_BYTES as u64)?;
        let rest = &bytes[at + HEADER_BYTES..];
        let body = &rest[..usize::try_from(declared).unwrap_or(usize::MAX).min(rest.len())];
        at = (at + HEADER_BYTES + body.len()).next_multiple_of(8);
        Some(Chunk { id, body, declared, rest })
    })
}
