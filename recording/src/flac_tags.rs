//! A FLAC file's comments: its position on the timeline, and its loudspeakers.
//!
//! FLAC has no chunk for the position; `TIME_REFERENCE` and `DESCRIPTION` are the names under which programs that
//! convert Broadcast Wave files to FLAC store it.

use std::io::{Read, Seek};

use crate::broadcast::Broadcast;
use crate::channel_mask::channel_mask;

/// The number of a block of comments.
pub(crate) const COMMENTS: u8 = 4;

/// Vendor string.
const VENDOR: &str = "Pyrophone";

/// Largest block of comments that is read, in bytes.
const MOST_BYTES: u64 = 1 << 20;

/// The body of a block of comments.
pub(crate) fn comments(channels: usize, broadcast: Option<&Broadcast>) -> Vec<u8> {
    let mut comments = vec![];
    if channels > 2 {
        comments.push(format!("WAVEFORMATEXTENSIBLE_CHANNEL_MASK=0x{:04X}", channel_mask(channels)));
    }
    if let Some(broadcast) = broadcast {
        comments.push(format!("TIME_REFERENCE={}", broadcast.time_reference_samples));
        let text = [("DESCRIPTION", Some(&broadcast.description)), ("ORIGINATION_DATE", broadcast.date.as_ref())];
        let text = text.into_iter().chain([("ORIGINATION_TIME", broadcast.time.as_ref())]);
        let text = text.filter_map(|(key, value)| Some((key, value.filter(|value| !value.is_empty())?)));
        comments.extend(text.map(|(key, value)| format!("{key}={value}")));
    }
    let mut bytes = vec![];
    put(&mut bytes, VENDOR);
    bytes.extend((comments.len() as u32).to_le_bytes());
    comments.iter().for_each(|comment| put(&mut bytes, comment));
    bytes
}

fn put(bytes: &mut Vec<u8>, text: &str) {
    bytes.extend((text.len() as u32).to_le_bytes());
    bytes.extend(text.as_bytes());
}

/// The position that a file's comments state, read from after its first four bytes.
pub(crate) fn read(file: &mut (impl Read + Seek)) -> Option<Broadcast> {
    loop {
        let mut head = [0; 4];
        file.read_exact(&mut head).ok()?;
        let size = u64::from(u32::from_be_bytes([0, head[1], head[2], head[3]]));
        if head[0] & 0x7f == COMMENTS {
            let mut body = vec![];
            file.take(size.min(MOST_BYTES)).read_to_end(&mut body).ok()?;
            return parse(&body);
        }
        // The last block of all has the highest bit set.
        if head[0] & 0x80 != 0 {
            return None;
        }
        file.seek_relative(size as i64).ok()?;
    }
}

fn parse(body: &[u8]) -> Option<Broadcast> {
    let mut rest = body;
    next(&mut rest)?;
    let (count, after) = rest.split_first_chunk::<4>()?;
    rest = after;
    let mut broadcast = Broadcast::default();
    let mut has_place = false;
    for _ in 0..u32::from_le_bytes(*count) {
        let Some(comment) = next(&mut rest) else { break };
        let comment = String::from_utf8_lossy(comment);
        let Some((key, value)) = comment.split_once('=') else { continue };
        match key.to_ascii_uppercase().as_str() {
            "TIME_REFERENCE" => {
                broadcast.time_reference_samples = value.trim().parse().ok()?;
                has_place = true;
            }
            "DESCRIPTION" => broadcast.description = value.to_owned(),
            "ORIGINATION_DATE" => broadcast.date = Some(value.to_owned()),
            "ORIGINATION_TIME" => broadcast.time = Some(value.to_owned()),
            _ => {}
        }
    }
    has_place.then_some(broadcast)
}

/// The next text, without its length before it.
fn next<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, after) = rest.split_first_chunk::<4>()?;
    let (text, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    *rest = after;
    Some(text)
}
