//! Files that appear whole or not at all.

use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use crate::Error;
use crate::error::{clean, one_line};

/// Writes 32-bit float WAV: `channels` of equal length, 1 to [`MAX_CHANNELS`](crate::MAX_CHANNELS),
/// sample values as they are (no normalising, no dither, no clipping).
///
/// Fails where channels are missing, too many or unequal, and where the file cannot be written; then
/// whatever stood at `path` before still stands there.
pub fn write_wav_f32(path: &Path, channels: &[Vec<f32>], sample_rate_hz: u32) -> Result<(), Error> {
    let expected = check_channels(path, channels, sample_rate_hz)?;
    let spec = hound::WavSpec {
        channels: channels.len() as u16,
        sample_rate: sample_rate_hz,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    write_file(path, |file| {
        let mut writer = hound::WavWriter::new(BufWriter::new(&mut *file), spec)?;
        for index in 0..expected {
            for samples in channels {
                writer.write_sample(samples[index])?;
            }
        }
        writer.finalize()?;
        set_channel_mask(file, channels.len())?;
        Ok::<(), hound::Error>(())
    })
}

/// Place of the channel mask in the extensible header that more than two channels have.
const MASK_AT: u64 = 40;

/// Says which loudspeakers the channels are for: the usual layout of so many (left, right, centre, LFE, rear, side, top).
/// Without it programs would take them in the order of the mask's bits.
fn set_channel_mask(file: &mut std::fs::File, channels: usize) -> std::io::Result<()> {
    let mask: u32 = match channels {
        0..=2 => return Ok(()),
        3 => 0x7,
        4 => 0x33,
        5 => 0x37,
        6 => 0x3f,
        7 => 0x637,
        8 => 0x63f,
        9 => 0x5637,
        10 => 0x563f,
        _ => 0,
    };
    file.seek(SeekFrom::Start(MASK_AT))?;
    file.write_all(&mask.to_le_bytes())
}

/// The channels' length; fails where they are missing, too many or unequal.
pub(crate) fn check_channels(path: &Path, channels: &[Vec<f32>], sample_rate_hz: u32) -> Result<usize, Error> {
    crate::container::check_layout(channels.len(), Some(sample_rate_hz), &one_line(path))?;
    let expected = channels[0].len();
    if let Some((channel, samples)) = channels.iter().enumerate().find(|(_, samples)| samples.len() != expected) {
        return Err(Error::UnequalChannels { path: one_line(path), channel, found: samples.len(), expected });
    }
    Ok(expected)
}

/// Fails where what is to be written to `path` holds values that are not finite: its input was too loud.
pub fn check_finite(path: &Path, channels: &[Vec<f32>]) -> Result<(), Error> {
    for (channel, samples) in channels.iter().enumerate() {
        if let Some(index) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(Error::Overflow { path: one_line(path), channel, index, value: samples[index] });
        }
    }
    Ok(())
}

/// Fails where the file at `output` is one of `sources`, under whatever name.
pub fn check_not_among(output: &Path, sources: &[&Path]) -> Result<(), Error> {
    let Ok(place) = output.canonicalize() else { return Ok(()) };
    let same = |source: &&&Path| source.canonicalize().is_ok_and(|source| source == place);
    match sources.iter().find(same) {
        Some(source) => Err(Error::Overwrites { path: one_line(output), source_path: one_line(source) }),
        None => Ok(()),
    }
}

/// Writes a file under a temporary name in the same folder and moves it into place once it is whole. A link is
/// followed.
///
/// Fails with [`Error::NotWritten`], also where something stands at `path` that is not a file (a folder, a device,
/// a pipe); then nothing new is left behind.
pub fn write_file<E: std::fmt::Display>(
    path: &Path,
    write: impl FnOnce(&mut std::fs::File) -> Result<(), E>,
) -> Result<(), Error> {
    let failure = |reason: String| Error::NotWritten { path: one_line(path), reason: clean(&reason) };
    // The move would put a file in the place of whatever stands there.
    let place = match path.metadata() {
        Ok(there) if there.is_dir() => return Err(failure("a folder of this name exists".into())),
        Ok(there) if !there.is_file() => return Err(failure("it is a device or a pipe, not a file".into())),
        Ok(_) => path.canonicalize().map_err(|error| failure(error.kind().to_string()))?,
        Err(_) if path.is_symlink() => return Err(failure("it is a link to nothing".into())),
        Err(_) => path.to_path_buf(),
    };
    let path = place.as_path();
    let folder = match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pyrophone-").suffix(".part");
    // Temporary files are private by default; a finished one is as readable as any other file, as far as the
    // user's mask allows.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // What the system says of the temporary file names a path that nobody has typed.
    let mut file = builder.tempfile_in(folder).map_err(|error| failure(error.kind().to_string()))?;
    write(file.as_file_mut()).map_err(|error| failure(error.to_string()))?;
    file.as_file_mut().flush().map_err(|error| failure(error.to_string()))?;
    file.persist(path).map_err(|error| failure(error.error.kind().to_string()))?;
    Ok(())
}
