//! Output of sound: a WAV or FLAC file, or standard output.

use std::io::IsTerminal;
use std::path::Path;

use pyrophone_recording::{
    Broadcast, check_finite, check_flac, check_not_among, check_writable, round_to_24_bit, samples_hash,
    write_broadcast_wav_f32, write_flac_24, write_wav_f32, write_wav_f32_to,
};

use crate::error::Error;
use crate::level::Level;
use crate::notes::note;
use crate::summary::Sound;

/// Argument for standard input or output.
pub const STANDARD: &str = "-";

/// Extensions of WAV files; a name without an extension is a WAV file too.
const WAV: [&str; 3] = ["", "wav", "wave"];

/// Kinds of output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Container {
    Wav,
    Flac,
    /// WAV, to standard output.
    Standard,
}

/// True if `path` means standard input or output.
pub fn is_standard(path: &Path) -> bool {
    path.as_os_str() == STANDARD
}

/// Rejects, before any work is done, an output that would overwrite one of its sources, has an unsupported format, or
/// cannot be written; also rejects more than one input from standard input.
pub fn check(output: &Path, sources: &[&Path]) -> Result<(), Error> {
    if sources.iter().filter(|source| is_standard(source)).count() > 1 {
        return Err(Error::Conflict(
            "two inputs are -, but standard input holds one sound; name a file for the other".into(),
        ));
    }
    if is_standard(output) {
        if std::io::stdout().is_terminal() {
            let message = "--output is -, but standard output is a terminal; redirect it to a file or a pipe";
            return Err(Error::Conflict(message.into()));
        }
        return Ok(());
    }
    check_not_among(output, sources)?;
    kind(output)?;
    check_file(output)
}

/// Rejects any other file that could not be written.
pub fn check_file(output: &Path) -> Result<(), Error> {
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|folder| !folder.is_dir()) {
        let message = format!("{}: there is no folder {}; create it first", output.display(), folder.display());
        return Err(Error::Conflict(message));
    }
    Ok(check_writable(output)?)
}

/// Rejects, once they are known, a channel count and rate that the file format does not support.
pub fn check_format(output: &Path, channels: usize, sample_rate_hz: u32) -> Result<(), Error> {
    match kind(output)? {
        Container::Flac => Ok(check_flac(output, channels, sample_rate_hz)?),
        Container::Wav | Container::Standard => Ok(()),
    }
}

/// Writes a sound meant for listening; notes a level that is too high or too low.
pub fn write(
    output: &Path,
    channels: Vec<Vec<f32>>,
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> Result<Sound, Error> {
    let sound = write_signal(output, channels, sample_rate_hz, broadcast)?;
    sound.level.note_extremes();
    Ok(sound)
}

/// Writes a signal of any level.
pub fn write_signal(
    output: &Path,
    mut channels: Vec<Vec<f32>>,
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> Result<Sound, Error> {
    check_finite(output, &channels)?;
    let level = Level::of_channels(&channels, sample_rate_hz);
    match (kind(output)?, broadcast) {
        (Container::Standard, _) => {
            write_wav_f32_to(&mut std::io::stdout().lock(), "standard output", &channels, sample_rate_hz, broadcast)?;
        }
        (Container::Flac, _) => {
            let clipped = round_to_24_bit(&mut channels);
            write_flac_24(output, &channels, sample_rate_hz, broadcast)?;
            if clipped > 0 {
                note(&format!(
                    "{clipped} samples beyond full scale are clipped, because FLAC cannot hold them; WAV would keep them"
                ));
            }
        }
        (Container::Wav, Some(broadcast)) => write_broadcast_wav_f32(output, &channels, sample_rate_hz, broadcast)?,
        (Container::Wav, None) => write_wav_f32(output, &channels, sample_rate_hz)?,
    }
    Ok(Sound {
        samples: channels.first().map_or(0, Vec::len),
        sample_rate_hz,
        channels: channels.len(),
        level,
        hash: samples_hash(&channels),
    })
}

fn kind(output: &Path) -> Result<Container, Error> {
    if is_standard(output) {
        return Ok(Container::Standard);
    }
    let extension = output.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match extension.as_str() {
        "flac" => Ok(Container::Flac),
        known if WAV.contains(&known) => Ok(Container::Wav),
        other => Err(Error::Conflict(format!(
            "{}: .{} files cannot be written; name the output .wav (32-bit float) or .flac (24 bit)",
            output.display(),
            other.replace(['\n', '\r'], " ")
        ))),
    }
}

/// Creates a folder and its parents if needed.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let (path, reason) = (folder.display().to_string(), error.kind().to_string());
        Error::Recording(pyrophone_recording::Error::NotWritten { path, reason })
    })
}
