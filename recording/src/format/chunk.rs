//! Chunks: name, size and bytes of each part of a WAV, AIFF, CAF or Wave64 file.

use crate::Error;

/// Sizes from which writers mean that the size is unknown: all bits set, or the limit of old players. So large a file
/// is not read anyway.
pub(crate) const UNKNOWN_SIZE: u64 = 0x7fff_0000;

/// A chunk: its name, the bytes of it that are there, and the size that its header declares.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Chunk<'a> {
    pub id: [u8; 4],
    pub body: &'a [u8],
    pub declared: u64,
    /// All bytes from the start of the body to the end of the file.
    pub rest: &'a [u8],
}

impl Chunk<'_> {
    /// True if its header declares no more bytes than exist.
    pub fn is_complete(&self) -> bool {
        self.body.len() as u64 >= self.declared
    }

    /// Fails if it is not complete.
    pub fn complete(&self, name: &str) -> Result<(), Error> {
        if self.is_complete() {
            return Ok(());
        }
        Err(Error::Truncated {
            name: name.into(),
            found: self.body.len() as u64,
            declared: self.declared,
            unit: if matches!(&self.id, b"data" | b"SSND") { "bytes of sound" } else { "bytes of header" },
        })
    }
}

/// Layout of chunks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ChunkLayout {
    /// WAV: little-endian sizes, even.
    Riff,
    /// AIFF: big-endian sizes, even.
    Iff,
    /// CAF: 64-bit big-endian sizes, not padded.
    Caf,
}

impl ChunkLayout {
    /// Length of a chunk's header and the size it declares.
    fn header(self, bytes: &[u8]) -> Option<(usize, u64)> {
        let size = bytes.get(4..)?;
        Some(match self {
            Self::Riff => (8, u32::from_le_bytes(*size.first_chunk()?).into()),
            Self::Iff => (8, u32::from_be_bytes(*size.first_chunk()?).into()),
            Self::Caf => (12, u64::from_be_bytes(*size.first_chunk()?)),
        })
    }
}

/// The chunks from `start` on.
///
/// A chunk that no decoder needs may have a wrong size: if it extends beyond the file, or is followed by something
/// without a name, the walk continues at the next of the names in `needed`, if there is one.
pub(crate) fn chunks<'a>(
    bytes: &'a [u8],
    start: usize,
    kind: ChunkLayout,
    needed: &'a [&'a [u8; 4]],
) -> impl Iterator<Item = Chunk<'a>> + 'a {
    let mut at = start.min(bytes.len());
    std::iter::from_fn(move || {
        let rest = &bytes[at..];
        let id = *rest.first_chunk::<4>()?;
        let (header_len, declared) = kind.header(rest)?;
        let rest = &rest[header_len..];
        let size = usize::try_from(declared).unwrap_or(usize::MAX).min(rest.len());
        let chunk = Chunk { id, body: &rest[..size], declared, rest };
        let body_at = at + header_len;
        let is_odd = kind != ChunkLayout::Caf && size % 2 == 1;
        at = after(bytes, body_at + size, is_odd);
        let is_needed = needed.contains(&&id);
        if !is_needed && (!chunk.is_complete() || !is_name_or_end(&bytes[at..])) {
            at = find(bytes, body_at, needed).unwrap_or(at);
        }
        Some(chunk)
    })
}

/// Start of the next chunk: chunks are padded to even sizes, but not every writer does so.
fn after(bytes: &[u8], end: usize, is_odd: bool) -> usize {
    let has_pad = bytes.get(end).is_none_or(|pad| *pad == 0) || !is_name_or_end(&bytes[end..]);
    (end + usize::from(is_odd && has_pad)).min(bytes.len())
}

/// True for a name, which is four printable characters, or at the end, where less than a header's bytes are left.
fn is_name_or_end(rest: &[u8]) -> bool {
    rest.len() < 8 || rest[..4].iter().all(|byte| (0x20..0x7f).contains(byte))
}

fn find(bytes: &[u8], from: usize, names: &[&[u8; 4]]) -> Option<usize> {
    let is_name = |window: &[u8]| names.iter().any(|name| window == *name);
    bytes.get(from..)?.windows(4).position(is_name).map(|offset| from + offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(bytes: &[u8]) -> Vec<String> {
        let needed: &[&[u8; 4]] = &[b"fmt ", b"data"];
        chunks(bytes, 0, ChunkLayout::Riff, needed).map(|chunk| String::from_utf8_lossy(&chunk.id).into()).collect()
    }

    #[test]
    fn odd_chunks_are_followed_with_and_without_their_pad() {
        assert_eq!(names(b"abcd\x01\0\0\0x\0data\0\0\0\0"), ["abcd", "data"]);
        assert_eq!(names(b"abcd\x01\0\0\0xdata\0\0\0\0"), ["abcd", "data"]);
    }

    #[test]
    fn a_wrong_size_does_not_hide_the_sound() {
        for size in [*b"\xff\xff\0\0", *b"\x03\0\0\0", *b"\x06\0\0\0"] {
            let bytes = [&b"LIST"[..], &size, b"\x01\x02\x03\x04data\x02\0\0\0ab"].concat();
            assert!(names(&bytes).contains(&"data".to_string()), "{size:?}: {:?}", names(&bytes));
        }
    }
}
