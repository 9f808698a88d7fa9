//! WAV from a pipe, whose writer did not know its length when it wrote the header.

/// Sizes from here on mean "unknown": all ones, or the largest 31-bit number, minus a header.
const UNKNOWN_BYTES: u32 = 0x7fff_f000;

/// Corrects the length in the header of a WAV file that was written to a pipe.
///
/// Nothing else is changed: a known length that is not reached still indicates that the pipe was interrupted.
pub fn settle_length(bytes: &mut [u8]) {
    if !(bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WAVE")) {
        return;
    }
    let mut at = 12;
    let mut frame_bytes = 1;
    while let Some(head) = bytes.get(at..).and_then(|rest| rest.first_chunk::<8>()) {
        let size = u32::from_le_bytes([head[4], head[5], head[6], head[7]]);
        let body = at + 8;
        if head.starts_with(b"fmt ") {
            let align = bytes.get(body + 12..body + 14).and_then(|align| align.first_chunk::<2>());
            frame_bytes = align.map_or(1, |align| usize::from(u16::from_le_bytes(*align))).max(1);
        }
        if head.starts_with(b"data") {
            if size == 0 || size >= UNKNOWN_BYTES {
                let there = bytes.len() - body;
                // An incomplete frame is not sound.
                let whole = u32::try_from(there - there % frame_bytes).unwrap_or(u32::MAX);
                bytes[at + 4..body].copy_from_slice(&whole.to_le_bytes());
            }
            return;
        }
        at = body.saturating_add(size as usize + size as usize % 2);
    }
}
