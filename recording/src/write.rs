//! Files that appear complete or not at all.

use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crate::broadcast::Broadcast;
use crate::channel_mask::channel_mask;
use crate::error::{clean, one_line};
use crate::{Error, wav};

/// Writes 32-bit float WAV: `channels` of equal length, 1 to [`MAX_CHANNELS`](crate::MAX_CHANNELS), with unchanged
/// sample values (no normalising, no dither, no clipping).
///
/// # Errors
/// If channels are missing, too many or unequal, or if the file cannot be written; an existing file at `path` is then
/// unchanged.
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

/// Offset of the channel mask in the extensible header that more than two channels have.
const MASK_AT: u64 = 40;

/// Sets the loudspeakers of the channels.
fn set_channel_mask(file: &mut std::fs::File, channels: usize) -> std::io::Result<()> {
    if channels <= 2 {
        return Ok(());
    }
    file.seek(SeekFrom::Start(MASK_AT))?;
    file.write_all(&channel_mask(channels).to_le_bytes())
}

/// Writes 32-bit float WAV as [`write_wav_f32`](crate::write_wav_f32) does, with a `bext` chunk of version 1 before the
/// sound.
///
/// # Errors
/// As that function, and if the file would reach 4 GiB.
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

/// Writes the same sound to any byte writer, such as a pipe, with a `bext` chunk if `broadcast` is given; `name` is
/// used in messages.
///
/// # Errors
/// As [`write_wav_f32`]; anything written before an error remains written.
pub fn write_wav_f32_to(
    out: &mut impl Write,
    name: &str,
    channels: &[Vec<f32>],
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> Result<(), Error> {
    let failure = |reason: String| Error::NotWritten { path: clean(name), reason: clean(&reason) };
    check_channels(Path::new(name), channels, sample_rate_hz)?;
    wav::data_bytes(channels).map_err(failure)?;
    let written = wav::write(&mut BufWriter::new(out), channels, sample_rate_hz, broadcast);
    written.map_err(|error| failure(error.kind().to_string()))
}

/// The channels' length; fails if they are missing, too many or unequal.
pub(crate) fn check_channels(path: &Path, channels: &[Vec<f32>], sample_rate_hz: u32) -> Result<usize, Error> {
    crate::format::check_layout(channels.len(), Some(sample_rate_hz), &one_line(path))?;
    let expected = channels[0].len();
    if let Some((channel, samples)) = channels.iter().enumerate().find(|(_, samples)| samples.len() != expected) {
        return Err(Error::UnequalChannels { path: one_line(path), channel, found: samples.len(), expected });
    }
    Ok(expected)
}

/// Checks samples before they are written to `path`.
///
/// # Errors
/// [`Error::Overflow`] if a value is not finite, because the input was too loud.
pub fn check_finite(path: &Path, channels: &[Vec<f32>]) -> Result<(), Error> {
    for (channel, samples) in channels.iter().enumerate() {
        if let Some(index) = samples.iter().position(|sample| !sample.is_finite()) {
            return Err(Error::Overflow { path: one_line(path), channel, index, value: samples[index] });
        }
    }
    Ok(())
}

/// Checks that an output does not replace one of its inputs, under whatever name.
///
/// # Errors
/// [`Error::Overwrites`] if the file at `output` is one of `sources`.
pub fn check_not_among(output: &Path, sources: &[&Path]) -> Result<(), Error> {
    let Ok(target) = output.canonicalize() else { return Ok(()) };
    let same = |source: &&&Path| source.canonicalize().is_ok_and(|source| source == target);
    match sources.iter().find(same) {
        Some(source) => Err(Error::Overwrites { path: one_line(output), source_path: one_line(source) }),
        None => Ok(()),
    }
}

/// Writes a file under a temporary name in the same folder and moves it into place once it is complete. A link is
/// followed.
///
/// # Errors
/// [`Error::NotWritten`], also if `path` is not a file (a folder, a device, a pipe); nothing new is then left behind.
pub fn write_file<E: std::fmt::Display>(
    path: &Path,
    write: impl FnOnce(&mut std::fs::File) -> Result<(), E>,
) -> Result<(), Error> {
    let failure = |reason: String| Error::NotWritten { path: one_line(path), reason: clean(&reason) };
    let target = place_of(path)?;
    let mut file = part(&target).map_err(|error| failure(error.kind().to_string()))?;
    write(file.as_file_mut()).map_err(|error| failure(error.to_string()))?;
    file.as_file_mut().flush().map_err(|error| failure(error.to_string()))?;
    file.persist(&target).map_err(|error| failure(error.error.kind().to_string()))?;
    Ok(())
}

/// Checks that a file can be written to `path`; nothing is left behind.
///
/// # Errors
/// The errors with which [`write_file`] would fail at the end of the work.
pub fn check_writable(path: &Path) -> Result<(), Error> {
    let target = place_of(path)?;
    match part(&target) {
        Ok(_) => Ok(()),
        Err(error) => Err(Error::NotWritten { path: one_line(path), reason: error.kind().to_string() }),
    }
}

/// Path of the file itself, with links resolved; fails if the move would replace something else.
fn place_of(path: &Path) -> Result<PathBuf, Error> {
    let failure = |reason: String| Error::NotWritten { path: one_line(path), reason };
    match path.metadata() {
        Ok(there) if there.is_dir() => Err(failure("a folder of this name exists".into())),
        Ok(there) if !there.is_file() => Err(failure("it is a device or a pipe, not a file".into())),
        Ok(_) => path.canonicalize().map_err(|error| failure(error.kind().to_string())),
        Err(_) if path.is_symlink() => Err(failure("it is a broken link".into())),
        Err(_) => Ok(path.to_path_buf()),
    }
}

/// A file under a temporary name in the same folder, which is deleted unless it is moved. The system's messages about
/// it contain a path that nobody typed, so only the kind of an error is useful.
fn part(target: &Path) -> std::io::Result<tempfile::NamedTempFile> {
    let folder = match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    };
    let mut builder = tempfile::Builder::new();
    builder.prefix(".pyrophone-").suffix(".part");
    // Temporary files are private by default; a finished one should be as readable as any other file, subject to the
    // user's mask.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}
