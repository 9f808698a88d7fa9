//! Broadcast Wave files: sound that knows where on the timeline it belongs (EBU Tech 3285).

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::Error;
use crate::error::one_line;
use crate::write::{check_channels, write_file};

/// Who is said to have made the file.
const ORIGINATOR: &str = "Pyrophone";

/// Length of the `bext` chunk in bytes, without a coding history.
const BEXT_BYTES: u32 = 602;

/// Bytes before the samples, from the file's first.
const HEAD_BYTES: u32 = 12 + (8 + 18) + (8 + 4) + (8 + BEXT_BYTES) + 8;

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
    let samples = check_channels(path, channels, sample_rate_hz)?;
    let bytes = 4 * samples as u64 * channels.len() as u64;
    let data_bytes = u32::try_from(bytes).ok().filter(|bytes| *bytes <= u32::MAX - HEAD_BYTES).ok_or_else(|| {
        let reason = format!("{bytes} bytes of sound do not fit a WAV file");
        Error::NotWritten { path: one_line(path), reason }
    })?;
    write_file(path, |file| write_all(file, channels, data_bytes, sample_rate_hz, broadcast))
}

fn write_all(
    file: &mut File,
    channels: &[Vec<f32>],
    data_bytes: u32,
    sample_rate_hz: u32,
    broadcast: &Broadcast,
) -> std::io::Result<()> {
    let mut file = BufWriter::new(file);
    let count = channels.len() as u16;
    let samples = data_bytes / (4 * u32::from(count));
    file.write_all(b"RIFF")?;
    file.write_all(&(HEAD_BYTES - 8 + data_bytes).to_le_bytes())?;
    file.write_all(b"WAVE")?;
    chunk(&mut file, b"fmt ", 18)?;
    // Floats of IEEE 754, and no extra bytes of format.
    file.write_all(&3u16.to_le_bytes())?;
    file.write_all(&count.to_le_bytes())?;
    file.write_all(&sample_rate_hz.to_le_bytes())?;
    file.write_all(&(sample_rate_hz * 4 * u32::from(count)).to_le_bytes())?;
    file.write_all(&(4 * count).to_le_bytes())?;
    file.write_all(&32u16.to_le_bytes())?;
    file.write_all(&0u16.to_le_bytes())?;
    chunk(&mut file, b"fact", 4)?;
    file.write_all(&samples.to_le_bytes())?;
    chunk(&mut file, b"bext", BEXT_BYTES)?;
    file.write_all(&bext(broadcast))?;
    chunk(&mut file, b"data", data_bytes)?;
    for index in 0..samples as usize {
        for samples in channels {
            file.write_all(&samples[index].to_le_bytes())?;
        }
    }
    file.flush()
}

fn chunk(file: &mut impl Write, id: &[u8; 4], bytes: u32) -> std::io::Result<()> {
    file.write_all(id)?;
    file.write_all(&bytes.to_le_bytes())
}

/// The chunk's fixed part; loudness and UMID are not stated.
fn bext(broadcast: &Broadcast) -> Vec<u8> {
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
