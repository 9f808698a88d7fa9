//! From a file's bytes to samples.

use std::io::{ErrorKind, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use crate::error::{clean, one_line};
use crate::format::{self, Described, Sound, damaged};
use crate::{Error, MAX_FILE_BYTES, Note, Progress, Recording, content_hash, packets};

/// Share of the channels' mean power below which the power of their mean indicates that they cancel.
const CANCELLING_SHARE: f64 = 0.01;

/// Number of samples processed together.
const BLOCK: usize = 4096;

/// Reads a whole file into memory.
///
/// # Errors
/// If it is missing, a folder, unreadable, empty, or larger than [`MAX_FILE_BYTES`](crate::MAX_FILE_BYTES).
pub fn read(path: &Path) -> Result<Vec<u8>, Error> {
    let shown = || one_line(path);
    let failure = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => Error::Missing { path: shown() },
        ErrorKind::PermissionDenied => Error::NoPermission { path: shown() },
        ErrorKind::IsADirectory => Error::Folder { path: shown() },
        _ => Error::Unreadable { path: shown(), reason: clean(&error.to_string()) },
    };
    let metadata = std::fs::metadata(path).map_err(failure)?;
    if metadata.is_dir() {
        return Err(Error::Folder { path: shown() });
    }
    // A pipe or a device may never end, and cannot be found again under its name.
    if !metadata.is_file() {
        return Err(Error::Unreadable { path: shown(), reason: "not a regular file".into() });
    }
    if metadata.len() > MAX_FILE_BYTES {
        return Err(Error::FileTooLarge { name: file_name(path), found_bytes: metadata.len() });
    }
    let mut bytes = Vec::with_capacity(metadata.len() as usize);
    let file = std::fs::File::open(path).map_err(failure)?;
    file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes).map_err(failure)?;
    if bytes.is_empty() {
        return Err(Error::Empty { name: file_name(path) });
    }
    Ok(bytes)
}

/// Reads and decodes a sound file: WAV (also RF64 and Wave64), AIFF, CAF, FLAC, Ogg or MP3.
///
/// Integer samples become fractions of full scale; 32-bit floats are unchanged, bit for bit.
///
/// # Errors
/// As [`read`] and [`decode_bytes`].
pub fn decode(path: &Path, progress: Progress) -> Result<Recording, Error> {
    let bytes = read(path)?;
    decode_named(&bytes, content_hash(&bytes), &file_name(path), progress)
}

/// Decodes a sound file in memory; `name` is used in messages.
///
/// # Errors
/// If the bytes are not sound, of an unsupported kind, damaged or truncated, or if the sound is outside the limits of
/// this crate or has a sample that is not finite.
pub fn decode_bytes(bytes: &[u8], name: &str, progress: Progress) -> Result<Recording, Error> {
    decode_known(bytes, &content_hash(bytes), name, progress)
}

/// The same for bytes whose [`content_hash`] is known: hashing a long file takes as long as reading it.
///
/// # Errors
/// Those of [`decode_bytes`].
pub fn decode_known(bytes: &[u8], content_hash: &str, name: &str, progress: Progress) -> Result<Recording, Error> {
    decode_named(bytes, content_hash.to_owned(), &clean(name), progress)
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| one_line(path), |name| clean(&name.to_string_lossy()))
}

fn decode_named(bytes: &[u8], content_hash: String, name: &str, progress: Progress) -> Result<Recording, Error> {
    if bytes.is_empty() {
        return Err(Error::Empty { name: name.into() });
    }
    let (mut described, sound) = format::read(bytes, name)?;
    let channels = match &sound {
        Sound::Pcm(pcm) => pcm.decode(&described, name, progress)?,
        Sound::Packets(links) => {
            // Decoders of compressed formats contain assertions that a damaged file may trigger.
            let decoded = catch_unwind(AssertUnwindSafe(|| packets::decode(links, &mut described, name, progress)));
            decoded.map_err(|_| damaged(name, "its decoder failed"))??
        }
    };
    check_finite(&channels, name)?;
    let Described { sample_rate_hz, mut notes, .. } = described;
    notes.extend(note_of(&channels));
    Ok(Recording { channels, sample_rate_hz, name: name.into(), content_hash, notes })
}

/// Note on a sound that is useless although its file is sound.
fn note_of(channels: &[Vec<f32>]) -> Option<Note> {
    // Anything below the smallest normal number cannot be sound from any medium.
    if channels.iter().all(|samples| largest(samples) < f32::MIN_POSITIVE.to_bits()) {
        return Some(Note::Silent);
    }
    (channels.len() > 1 && cancel(channels)).then_some(Note::ChannelsCancel)
}

/// True if channels cancel in their sum.
fn cancel(channels: &[Vec<f32>]) -> bool {
    let square = |sample: f64| sample * sample;
    let (mut power, mut power_of_sum) = (0.0, 0.0);
    let mut sums = vec![0.0; BLOCK];
    // Block by block: the sums stay in the processor's cache while the channels pass.
    for start in (0..channels.first().map_or(0, Vec::len)).step_by(BLOCK) {
        sums.fill(0.0);
        for samples in channels {
            for (sum, sample) in sums.iter_mut().zip(&samples[start..]) {
                *sum += f64::from(*sample);
                power += square(f64::from(*sample));
            }
        }
        power_of_sum += sums.iter().map(|sum| square(*sum)).sum::<f64>();
    }
    power_of_sum < CANCELLING_SHARE * channels.len() as f64 * power
}

/// Bits of the largest magnitude; those of infinity or more if a sample is not finite. Magnitudes have the same order
/// as their bits, and integers can be compared many at a time.
fn largest(samples: &[f32]) -> u32 {
    samples.iter().map(|sample| sample.abs().to_bits()).max().unwrap_or(0)
}

fn check_finite(channels: &[Vec<f32>], name: &str) -> Result<(), Error> {
    if channels.iter().all(|samples| largest(samples) < f32::INFINITY.to_bits()) {
        return Ok(());
    }
    let first_bad = |(channel, samples): (usize, &Vec<f32>)| {
        samples.iter().position(|sample| !sample.is_finite()).map(|index| (index, channel, samples[index]))
    };
    match channels.iter().enumerate().filter_map(first_bad).min_by_key(|(index, channel, _)| (*index, *channel)) {
        Some((index, channel, value)) => Err(Error::NotFinite { name: name.into(), channel, index, value }),
        None => Ok(()),
    }
}
