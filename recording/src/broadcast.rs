//! Sound that knows where on the timeline it belongs: Broadcast Wave (EBU Tech 3285) and what FLAC has instead.

use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Seek, SeekFrom};
use std::path::Path;

use crate::error::one_line;
use crate::write::{check_channels, write_file};
use crate::{Error, flac_tags, wav};

/// Who is said to have made the file.
const ORIGINATOR: &str = "Pyrophone";

/// Length of the `bext` chunk in bytes, without a coding history.
pub(crate) const BEXT_BYTES: u32 = 602;

/// What a `bext` chunk must have at least to tell its place: all up to the version.
const LEAST_BEXT_BYTES: usize = 346;

/// Bytes of an iXML chunk that is kept.
pub(crate) const MOST_IXML_BYTES: u64 = 1 << 16;

/// Chunks that are looked at before the search is given up.
const MOST_CHUNKS: usize = 4096;

/// What a Broadcast Wave file says of itself.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Broadcast {
    /// What it is; of other than ASCII, and of more than 256 characters, the rest is left out.
    pub description: String,
    /// `yyyy-mm-dd`; nothing, for a file that is the same whenever it is made.
    pub date: Option<String>,
    /// `hh:mm:ss`.
    pub time: Option<String>,
    /// Where its first sample stands on the timeline, in samples since midnight.
    pub time_reference_samples: u64,
    /// What an iXML chunk says beside it, at most 64 KiB; WAV files alone have one.
    pub ixml: Option<String>,
}

impl Broadcast {
    /// What the file at `path` says of itself; nothing where it says nothing that can be read.
    pub fn of_file(path: &Path) -> Option<Self> {
        Self::read(&mut BufReader::new(File::open(path).ok()?))
    }

    /// What a file's bytes say of it: the `bext` chunk of a WAV file (RIFF, RF64 or BW64), or a FLAC file's comments.
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

/// Writes 32-bit float WAV as [`write_wav_f32`](crate::write_wav_f32) does, with a `bext` chunk of version 1 before the
/// sound.
///
/// Fails as that does, and where the file would reach 4 GiB.
pub fn write_broadcast_wav_f32(
    path: &Path,
    channels: &[Vec<f32>],
    sample_rate_hz: u32,
    broadcast: &Broadcast,
) -> Result<(), Error> {
    check_channels(path, channels, sample_rate_hz)?;
    wav::data_bytes(channels).map_err(|reason| Error::NotWritten { path: one_line(path), reason })?;
    write_file(path, |file| wav::write(&mut BufWriter::new(file), channels, sample_rate_hz, Some(broadcast)))
}

/// The chunk's fixed part; loudness and UMID are not stated.
pub(crate) fn bext(broadcast: &Broadcast) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(BEXT_BYTES as usize);
    let mut text = |text: &str, size: usize| {
        let ascii = text.bytes().filter(|byte| (0x20..0x7f).contains(byte));
        let mut field: Vec<u8> = ascii.take(size).collect();
        field.resize(size, 0);
        bytes.extend(field);
    };
    text(&broadcast.description, 256);
    text(ORIGINATOR, 32);
    text("", 32);
    text(broadcast.date.as_deref().unwrap_or_default(), 10);
    text(broadcast.time.as_deref().unwrap_or_default(), 8);
    // Low word first, as it happens to stand in a little-endian u64.
    bytes.extend(broadcast.time_reference_samples.to_le_bytes());
    bytes.extend(1u16.to_le_bytes());
    bytes.resize(BEXT_BYTES as usize, 0);
    bytes
}

/// Walks the chunks from behind the first four bytes of the file on.
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
                // Sound of unknown length: nothing behind it can be found.
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
