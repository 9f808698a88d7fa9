//! WAV from a pipe, whose writer did not know its length when it wrote the header.

/// From this size on it is no length but a writer's "unknown": all ones, or the most that fits 31 bits, less a header.
const UNKNOWN_BYTES: u32 = 0x7fff_f000;

/// Puts the true length into the header of a WAV file that was written to a pipe.
///
/// Nothing else is changed: a length that is known and not reached still tells that the pipe was cut off.
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
                // A frame that is not whole is no sound.
                let whole = u32::try_from(there - there % frame_bytes).unwrap_or(u32::MAX);
                bytes[at + 4..body].copy_from_slice(&whole.to_le_bytes());
            }
            return;
        }
        at = body.saturating_add(size as usize + size as usize % 2);
    }
}
