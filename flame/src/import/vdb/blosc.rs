//! Chunks of the Blosc 1 container, as OpenVDB writes them: LZ4 or stored, bytes shuffled or not.
//!
//! ```text
//! u8 version 2 | u8 codec version 1 | u8 flags | u8 type size | u32 bytes inside | u32 block size | u32 chunk size
//! i32 starts of the blocks | blocks, each one stream or one per byte of the type: i32 size, bytes
//! ```

use crate::import::error::{FormatFault, damaged};

const HEADER: usize = 16;
const SHUFFLED: u8 = 1;
const STORED: u8 = 2;
const BITS_SHUFFLED: u8 = 4;
const RESERVED: u8 = 8;
const NOT_SPLIT: u8 = 16;
const CODECS: [&str; 5] = ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"];
const LZ4: u8 = 1;

/// Types wider than this, and blocks with fewer values, are not split into streams.
const WIDEST_SPLIT: usize = 16;
const SHORTEST_SPLIT: usize = 128;

/// Unpacks a chunk into `out`, whose length is the expected size. `shuffled` is working memory.
pub(super) fn unpack(chunk: &[u8], out: &mut [u8], shuffled: &mut Vec<u8>) -> Result<(), FormatFault> {
    let header = Header::read(chunk, out.len())?;
    if out.is_empty() {
        return Ok(());
    }
    header.check()?;
    if header.flags & STORED != 0 {
        return match chunk.get(HEADER..) {
            Some(stored) if stored.len() == out.len() => {
                out.copy_from_slice(stored);
                Ok(())
            }
            _ => damaged("a stored Blosc chunk of the wrong size"),
        };
    }
    for (index, block) in out.chunks_mut(header.block_size).enumerate() {
        let start = header.block_start(chunk, index)?;
        if header.flags & SHUFFLED != 0 && header.type_size > 1 {
            shuffled.clear();
            shuffled.resize(block.len(), 0);
            header.block(chunk, start, shuffled)?;
            unshuffle(shuffled, header.type_size, block);
        } else {
            header.block(chunk, start, block)?;
        }
    }
    Ok(())
}

struct Header {
    codec_version: u8,
    flags: u8,
    type_size: usize,
    block_size: usize,
    blocks: usize,
}

impl Header {
    fn read(chunk: &[u8], expected: usize) -> Result<Self, FormatFault> {
        let Some(&[version, codec_version, flags, type_size, ref sizes @ ..]) = chunk.first_chunk::<HEADER>() else {
            return damaged("a Blosc chunk shorter than its header");
        };
        let size =
            |at: usize| sizes.iter().skip(at).take(4).rev().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte));
        let (inside, block_size, chunk_size) = (size(0), size(4), size(8));
        if version != 2 {
            return damaged(format!("Blosc version {version}, only 2 is known"));
        }
        if inside != expected || chunk_size != chunk.len() {
            return damaged(format!(
                "a Blosc chunk of {chunk_size} bytes with {inside} inside, {} with {expected} expected",
                chunk.len()
            ));
        }
        let blocks = inside.checked_div(block_size).map_or(0, |whole| whole + usize::from(inside % block_size != 0));
        Ok(Self { codec_version, flags, type_size: usize::from(type_size), block_size, blocks })
    }

    fn check(&self) -> Result<(), FormatFault> {
        if self.type_size == 0 || self.blocks == 0 || self.flags & RESERVED != 0 {
            return damaged("a Blosc chunk whose header makes no sense");
        }
        if self.flags & STORED != 0 {
            return Ok(());
        }
        let advice = "write the file with OpenVDB's own Blosc (LZ4), ZIP or no compression";
        if self.flags & BITS_SHUFFLED != 0 {
            return Err(FormatFault::Unsupported { found: "Blosc with shuffled bits".into(), advice });
        }
        if self.flags >> 5 != LZ4 {
            let name = CODECS.get(usize::from(self.flags >> 5)).unwrap_or(&"an unknown codec");
            return Err(FormatFault::Unsupported { found: format!("Blosc with {name}"), advice });
        }
        if self.codec_version != 1 {
            return damaged(format!("Blosc with LZ4 version {}, only 1 is known", self.codec_version));
        }
        Ok(())
    }

    /// Start of a block's first stream; blocks may not begin inside the table of starts.
    fn block_start(&self, chunk: &[u8], index: usize) -> Result<usize, FormatFault> {
        let table_end = self.blocks.checked_mul(4).and_then(|bytes| bytes.checked_add(HEADER));
        let start = usize::try_from(i32_at(chunk, HEADER + 4 * index)?);
        match (start, table_end) {
            (Ok(start), Some(table_end)) if start >= table_end => Ok(start),
            _ => damaged("a Blosc block that starts outside of its chunk"),
        }
    }

    /// Decodes the streams of one block, which follow each other from `at`.
    fn block(&self, chunk: &[u8], mut at: usize, out: &mut [u8]) -> Result<(), FormatFault> {
        // A shorter block, the last one, is never split.
        let whole = out.len() == self.block_size;
        let split = self.flags & NOT_SPLIT == 0
            && self.type_size <= WIDEST_SPLIT
            && self.block_size / self.type_size >= SHORTEST_SPLIT;
        let streams = if whole && split { self.type_size } else { 1 };
        if !out.len().is_multiple_of(streams) {
            return damaged("a Blosc block that its streams do not divide");
        }
        for part in out.chunks_exact_mut(out.len() / streams) {
            let size = usize::try_from(i32_at(chunk, at)?).ok();
            let stream = size.and_then(|size| chunk.get(at + 4..)?.get(..size));
            let Some(stream) = stream else {
                return damaged("a Blosc stream that ends outside of its chunk");
            };
            at += 4 + stream.len();
            // A stream that compression would not have shortened is stored as it is.
            if stream.len() == part.len() {
                part.copy_from_slice(stream);
            } else if !lz4_flex::block::decompress_into(stream, part).is_ok_and(|length| length == part.len()) {
                return damaged("an LZ4 stream that does not decompress to its size");
            }
        }
        Ok(())
    }
}

fn i32_at(chunk: &[u8], at: usize) -> Result<i32, FormatFault> {
    match chunk.get(at..).and_then(|rest| rest.first_chunk::<4>()) {
        Some(bytes) => Ok(i32::from_le_bytes(*bytes)),
        None => damaged("a Blosc chunk that ends early"),
    }
}

/// Reassembles the bytes of each value; those left over at the end keep their position.
fn unshuffle(shuffled: &[u8], type_size: usize, out: &mut [u8]) {
    let values = out.len() / type_size;
    let (whole, rest) = shuffled.split_at(values * type_size);
    if values > 0 {
        for (byte_number, plane) in whole.chunks_exact(values).enumerate() {
            for (value, byte) in out.chunks_exact_mut(type_size).zip(plane) {
                value[byte_number] = *byte;
            }
        }
    }
    out[values * type_size..].copy_from_slice(rest);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that repeat occasionally.
    fn sample(length: usize) -> Vec<u8> {
        (0..length).map(|i| if i % 7 < 4 { (i / 50) as u8 } else { (i * i % 251) as u8 }).collect()
    }

    fn shuffle(bytes: &[u8], type_size: usize) -> Vec<u8> {
        let values = bytes.len() / type_size;
        let mut out = vec![];
        for byte_number in 0..type_size {
            out.extend((0..values).map(|i| bytes[i * type_size + byte_number]));
        }
        out.extend(&bytes[values * type_size..]);
        out
    }

    fn pack(bytes: &[u8], type_size: usize, block_size: usize, flags: u8) -> Vec<u8> {
        let blocks: Vec<&[u8]> = bytes.chunks(block_size).collect();
        let (mut starts, mut body) = (vec![], vec![]);
        for block in &blocks {
            starts.extend(((HEADER + 4 * blocks.len() + body.len()) as i32).to_le_bytes());
            let block_bytes = if flags & SHUFFLED != 0 { shuffle(block, type_size) } else { block.to_vec() };
            let split = flags & NOT_SPLIT == 0 && type_size <= 16 && block_size / type_size >= 128;
            let streams = if split && block.len() == block_size { type_size } else { 1 };
            for stream in block_bytes.chunks_exact(block.len() / streams) {
                let mut packed = lz4_flex::block::compress(stream);
                if packed.len() >= stream.len() {
                    packed = stream.to_vec();
                }
                body.extend((packed.len() as i32).to_le_bytes());
                body.extend(packed);
            }
        }
        let mut chunk = vec![2, 1, flags | LZ4 << 5, type_size as u8];
        for size in [bytes.len(), block_size, HEADER + starts.len() + body.len()] {
            chunk.extend((size as u32).to_le_bytes());
        }
        [chunk, starts, body].concat()
    }

    fn unpacked(chunk: &[u8], length: usize) -> Result<Vec<u8>, FormatFault> {
        let mut out = vec![0xAA; length];
        unpack(chunk, &mut out, &mut vec![]).map(|()| out)
    }

    #[test]
    fn splits_blocks_and_leftovers() {
        for length in [1, 2, 127, 512, 1026, 4099, 65536] {
            for type_size in [1, 2, 4, 6, 12, 16, 17] {
                for block_size in [length, length.min(256 * type_size), length.min(96)] {
                    for flags in [0, SHUFFLED, NOT_SPLIT, SHUFFLED | NOT_SPLIT] {
                        let bytes = sample(length);
                        let splits = flags & NOT_SPLIT == 0 && type_size <= 16 && block_size / type_size >= 128;
                        let chunk = pack(&bytes, type_size, block_size, flags);
                        let what = format!("{length} bytes, type {type_size}, block {block_size}, flags {flags}");
                        match unpacked(&chunk, length) {
                            // No writer splits a block whose size the type does not divide: bytes would be lost.
                            Err(_) => assert!(splits && block_size % type_size != 0, "{what}"),
                            Ok(found) => assert_eq!(found, bytes, "{what}"),
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn stored_whatever_the_shuffle() {
        let bytes = sample(100);
        let mut chunk = vec![2, 1, STORED | SHUFFLED | NOT_SPLIT | LZ4 << 5, 4];
        for size in [100u32, 100, 116] {
            chunk.extend(size.to_le_bytes());
        }
        chunk.extend(&bytes);
        assert_eq!(unpacked(&chunk, 100).unwrap(), bytes);
        assert!(unpacked(&chunk[..115], 100).is_err());
        assert!(unpacked(&chunk, 99).is_err());
    }

    #[test]
    fn nothing_inside() {
        let empty = [2, 1, 0x33, 4, 0, 0, 0, 0, 1, 0, 0, 0, 16, 0, 0, 0];
        assert_eq!(unpacked(&empty, 0).unwrap(), []);
        assert!(unpacked(&empty, 4).is_err());
    }

    #[test]
    fn other_codecs_are_named() {
        let chunk = pack(&sample(512), 4, 512, SHUFFLED);
        for (codec, name) in [(0, "BloscLZ"), (2, "Snappy"), (3, "zlib"), (4, "Zstandard"), (6, "unknown codec")] {
            let mut other = chunk.clone();
            other[2] = other[2] & 31 | codec << 5;
            let message = unpacked(&other, 512).unwrap_err().to_string();
            assert!(message.contains(name), "{message}");
        }
    }

    #[test]
    fn every_edit_of_a_byte_ends() {
        let bytes = sample(1026);
        let chunk = pack(&bytes, 4, 512, SHUFFLED);
        for at in 0..chunk.len() {
            for value in [0, 1, 0x7F, 0x80, 0xFE, 0xFF] {
                let mut edited = chunk.clone();
                edited[at] = value;
                let _ = unpacked(&edited, bytes.len());
            }
            assert!(unpacked(&chunk[..at], bytes.len()).is_err(), "cut at {at}");
        }
    }

    #[test]
    fn lz4_never_writes_past_its_room() {
        let long_match = [0x1F, b'x', 1, 0, 255, 255, 255, 10, 0x50, 1, 2, 3, 4, 5];
        let exact = 1 + 4 + 15 + 3 * 255 + 10 + 5;
        for length in [0, 1, 4, exact - 1, exact, exact + 1] {
            let chunk = {
                let mut chunk = vec![2, 1, NOT_SPLIT | LZ4 << 5, 1];
                for size in [length as u32, length as u32, (HEADER + 8 + long_match.len()) as u32] {
                    chunk.extend(size.to_le_bytes());
                }
                chunk.extend(20i32.to_le_bytes());
                chunk.extend((long_match.len() as i32).to_le_bytes());
                chunk.extend(long_match);
                chunk
            };
            assert_eq!(unpacked(&chunk, length).is_ok(), length == exact || length == 0, "{length}");
        }
        let offset_zero = [0x10, b'x', 0, 0, 0x00];
        assert!(lz4_flex::block::decompress_into(&offset_zero, &mut [0; 5]).is_err());
        let before_the_start = [0x10, b'x', 2, 0, 0x00];
        assert!(lz4_flex::block::decompress_into(&before_the_start, &mut [0; 5]).is_err());
        let endless = [0xF0, 255, 255, 255];
        assert!(lz4_flex::block::decompress_into(&endless, &mut [0; 5]).is_err());
    }
}
