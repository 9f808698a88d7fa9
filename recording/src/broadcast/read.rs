//! Reading a file's position on the timeline, from its chunks or comments.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use super::{BEXT_BYTES, Broadcast, MOST_IXML_BYTES};
use crate::flac_tags;

/// Least bytes of a `bext` chunk that state its position: all up to the version.
const LEAST_BEXT_BYTES: usize = 346;

/// Number of chunks after which the search ends.
const MOST_CHUNKS: usize = 4096;

impl Broadcast {
    /// Metadata of the file at `path`; none if there is none that can be read.
    pub fn of_file(path: &Path) -> Option<Self> {
        Self::read(&mut BufReader::new(File::open(path).ok()?))
    }

    /// Metadata from a file's bytes: the `bext` chunk of a WAV file (RIFF, RF64 or BW64), or a FLAC file's comments.
    pub fn read(file: &mut (impl Read + Seek)) -> Option<Self> {
        let mut head = [0; 4];
        file.read_exact(&mut head).ok()?;
        match &head {
            b"RIFF" | b"RF64" | b"BW64" => read_wav(file),
            b"fLaC" => flac_tags::read(file),
            _ => None,
        }
    }
}

/// Walks the chunks that follow the first four bytes of the file.
fn read_wav(file: &mut (impl Read + Seek)) -> Option<Broadcast> {
    file.seek(SeekFrom::Start(12)).ok()?;
    let (mut long_data_bytes, mut broadcast, mut ixml) = (None, None, None);
    for _ in 0..MOST_CHUNKS {
        let mut head = [0; 8];
        if file.read_exact(&mut head).is_err() {
            break;
        }
        let (id, size) = (&head[..4], u64::from(u32::from_le_bytes([head[4], head[5], head[6], head[7]])));
        let mut rest = size + size % 2;
        match id {
            b"bext" => {
                let mut body = vec![];
                file.by_ref().take(size.min(u64::from(BEXT_BYTES))).read_to_end(&mut body).ok()?;
                file.seek_relative(i64::try_from(rest).ok()? - body.len() as i64).ok()?;
                broadcast = Some(parse(&body)?);
                continue;
            }
            b"iXML" if size <= MOST_IXML_BYTES => {
                let mut body = vec![];
                file.by_ref().take(size).read_to_end(&mut body).ok()?;
                ixml = String::from_utf8(body).ok();
                rest -= size;
            }
            // 64-bit files have the length of their sound here.
            b"ds64" if size >= 16 => {
                let mut sizes = [0; 16];
                file.read_exact(&mut sizes).ok()?;
                long_data_bytes = sizes[8..].first_chunk().map(|bytes| u64::from_le_bytes(*bytes));
                rest -= 16;
            }
            b"data" if size == u64::from(u32::MAX) => {
                // Sound of unknown length: nothing after it can be found.
                let Some(bytes) = long_data_bytes.and_then(|bytes: u64| bytes.checked_next_multiple_of(2)) else {
                    break;
                };
                rest = bytes;
            }
            _ => {}
        }
        if file.seek_relative(i64::try_from(rest).ok()?).is_err() {
            break;
        }
    }
    broadcast.map(|broadcast| Broadcast { ixml, ..broadcast })
}

fn parse(body: &[u8]) -> Option<Broadcast> {
    let body = body.get(..LEAST_BEXT_BYTES)?;
    let text = |field: &[u8]| {
        let end = field.iter().position(|byte| *byte == 0).unwrap_or(field.len());
        String::from_utf8_lossy(&field[..end]).trim().to_owned()
    };
    let some_text = |field: &[u8]| Some(text(field)).filter(|text| !text.is_empty());
    Some(Broadcast {
        description: text(&body[..256]),
        date: some_text(&body[320..330]),
        time: some_text(&body[330..338]),
        time_reference_samples: u64::from_le_bytes(*body[338..].first_chunk()?),
        ixml: None,
    })
}
