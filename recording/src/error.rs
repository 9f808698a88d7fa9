//! Errors of sound files.

use std::path::Path;

use crate::{MAX_CHANNELS, MAX_EMBEDDED_BYTES, MAX_FILE_BYTES, MAX_SAMPLE_RATE_HZ, MAX_SAMPLES};
use crate::{MAX_FLAC_CHANNELS, MAX_FLAC_RATE_HZ};
use crate::{MAX_SECONDS, MIN_SAMPLE_RATE_HZ};

/// Reason why a file could not be read, used or written.
///
/// Every message is one line: which file, what was found, what is allowed, what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no such file.
    #[error("{path}: there is no such file; check the path, or choose the file again")]
    Missing {
        /// The requested path.
        path: String,
    },
    /// The path names a folder.
    #[error("{path}: this is a folder, but one sound file is needed; choose a file inside it")]
    Folder {
        /// The requested path.
        path: String,
    },
    /// The system refuses access.
    #[error("{path}: no permission to read this file; change its permissions or copy it elsewhere")]
    NoPermission {
        /// The requested path.
        path: String,
    },
    /// The system failed to read for another reason.
    #[error("{path}: cannot be read ({reason}); copy it to a local disk and try again")]
    Unreadable {
        /// The requested path.
        path: String,
        /// The system's message.
        reason: String,
    },
    /// The region of a recording is none.
    #[error("{name}: its region from {start_s} s to {end_s} s is empty; choose an end after the start")]
    Region {
        /// The file.
        name: String,
        /// The start in seconds.
        start_s: f64,
        /// The end in seconds.
        end_s: f64,
    },
    /// A gain beyond the limit.
    #[error("the recording's gain is {found_db} dB, but must lie within ±{most_db} dB; choose a smaller gain")]
    Gain {
        /// The gain in dB.
        found_db: f64,
        /// The most that is allowed.
        most_db: f64,
    },
    /// The file holds no bytes.
    #[error("{name}: the file is empty (0 bytes); export or copy it again")]
    Empty {
        /// The file.
        name: String,
    },
    /// The file is larger than any recording allowed.
    #[error(
        "{name}: the file has {found_bytes} bytes, but at most {MAX_FILE_BYTES} are allowed; use a shorter excerpt"
    )]
    FileTooLarge {
        /// The file.
        name: String,
        /// Its size.
        found_bytes: u64,
    },
    /// The bytes are of no sound format known.
    #[error("{name}: not a sound file ({found}); use WAV, RF64, Wave64, AIFF, CAF, FLAC, Ogg Vorbis or MP3")]
    NotAudio {
        /// The file.
        name: String,
        /// Apparent contents.
        found: String,
    },
    /// A sound format, but an unsupported kind of it.
    #[error("{name}: {found} is not supported; convert it to WAV (8 to 32-bit integer, 32 or 64-bit float) or FLAC")]
    Unsupported {
        /// The file.
        name: String,
        /// The format or coding found.
        found: String,
    },
    /// The file contradicts itself or its format.
    #[error("{name}: the file is damaged ({reason}); export or copy it again")]
    Damaged {
        /// The file.
        name: String,
        /// The fault found.
        reason: String,
    },
    /// The file ends before its sound does.
    #[error("{name}: the file is truncated: only {found} of {declared} {unit} are present; export or copy it again")]
    Truncated {
        /// The file.
        name: String,
        /// Amount present.
        found: u64,
        /// Amount declared by its header.
        declared: u64,
        /// Unit: `bytes of sound` or `samples`.
        unit: &'static str,
    },
    /// Sample rate or channel count changes in the middle of the sound.
    #[error(
        "{name}: its {what} changes from {from} to {to} after {at_s:.3} s, but must stay the same; split the file there, or convert it"
    )]
    Changes {
        /// The file.
        name: String,
        /// The quantity that changes.
        what: &'static str,
        /// Its first value.
        from: u32,
        /// Its next value.
        to: u32,
        /// Seconds of sound before.
        at_s: f64,
    },
    /// Sample rate or channel count differs between the streams that a file is joined from.
    #[error(
        "{name}: its {what} changes from {from} to {to} between two of its streams, but must stay the same; split the file there, or convert it"
    )]
    ChangesBetween {
        /// The file.
        name: String,
        /// The quantity that changes.
        what: &'static str,
        /// Its value in the first stream.
        from: u32,
        /// Its next value.
        to: u32,
    },
    /// A sample is NaN or infinite.
    #[error(
        "{name}: sample {index} of channel {channel} is {value}, not a finite number; repair or re-export the file"
    )]
    NotFinite {
        /// The file.
        name: String,
        /// Channel of the first such sample, from 0.
        channel: usize,
        /// Its index in the channel, from 0.
        index: usize,
        /// `NaN`, `inf` or `-inf`.
        value: f32,
    },
    /// The header declares no channels.
    #[error("{name}: the file has 0 channels, but 1 to {MAX_CHANNELS} are needed; export it again")]
    NoChannels {
        /// The file.
        name: String,
    },
    /// More channels than the engines support.
    #[error("{name}: the file has {found} channels, but at most {MAX_CHANNELS} are allowed; mix it down or split it")]
    TooManyChannels {
        /// The file.
        name: String,
        /// Its channels.
        found: usize,
    },
    /// A sample rate of zero or beyond reason.
    #[error(
        "{name}: the sample rate is {found_hz} Hz, but must lie between {MIN_SAMPLE_RATE_HZ} and {MAX_SAMPLE_RATE_HZ} Hz; export the file at a usual rate such as 48000 Hz"
    )]
    SampleRate {
        /// The file.
        name: String,
        /// Its rate.
        found_hz: u32,
    },
    /// A complete file without any sound in it.
    #[error("{name}: the file holds 0 samples of sound, but at least 1 is needed; export it again")]
    NoSamples {
        /// The file.
        name: String,
    },
    /// More seconds than allowed.
    #[error("{name}: the sound is {found_s:.0} s long, but at most {MAX_SECONDS} s are allowed; use a shorter excerpt")]
    TooLong {
        /// The file.
        name: String,
        /// Its length, as far as it was read.
        found_s: f64,
    },
    /// More samples, over all channels, than memory is given for.
    #[error(
        "{name}: the sound has {found} samples over all channels, but at most {MAX_SAMPLES} are allowed; use a shorter excerpt, fewer channels or a lower rate"
    )]
    TooManySamples {
        /// The file.
        name: String,
        /// Its samples, as far as they were counted.
        found: u64,
    },
    /// Channels to write differ in length.
    #[error(
        "{path}: channel {channel} has {found} samples, channel 0 has {expected}; all channels must be equally long"
    )]
    UnequalChannels {
        /// The file to write.
        path: String,
        /// The channel that differs.
        channel: usize,
        /// Its length.
        found: usize,
        /// The length of channel 0.
        expected: usize,
    },
    /// A file could not be written; no partial file was left behind.
    #[error("{path}: cannot be written ({reason}); choose a folder that exists, is writable and has room")]
    NotWritten {
        /// The file to write.
        path: String,
        /// The system's message.
        reason: String,
    },
    /// More channels than FLAC supports, or a higher rate than its encoder does.
    #[error(
        "{path}: FLAC is written with 1 to {MAX_FLAC_CHANNELS} channels at up to {MAX_FLAC_RATE_HZ} Hz, but these are {channels} at {sample_rate_hz} Hz; write a .wav file"
    )]
    NotForFlac {
        /// The file to write.
        path: String,
        /// Channels found.
        channels: usize,
        /// Rate found.
        sample_rate_hz: u32,
    },
    /// An output would overwrite one of its sources.
    #[error("{path}: the output would overwrite {source_path}, which it is made from; choose another name")]
    Overwrites {
        /// The file to write.
        path: String,
        /// The file that it would overwrite.
        source_path: String,
    },
    /// A sample to write is not finite.
    #[error(
        "{path}: not written, because sample {index} of channel {channel} would be {value}; the input is too loud; lower its level"
    )]
    Overflow {
        /// The file to write.
        path: String,
        /// Channel of the first such sample, from 0.
        channel: usize,
        /// Its index in the channel, from 0.
        index: usize,
        /// `NaN`, `inf` or `-inf`.
        value: f32,
    },
    /// A file is too large to be embedded in a session.
    #[error(
        "the recording's file has {found_bytes} bytes, but at most {MAX_EMBEDDED_BYTES} can be embedded in a session; use a shorter or compressed file"
    )]
    EmbedTooLarge {
        /// Size of the file.
        found_bytes: usize,
    },
    /// An embedded recording cannot be unpacked.
    #[error("the recording embedded in the session is damaged ({reason}); load it from its file again")]
    EmbedDamaged {
        /// The fault found.
        reason: String,
    },
    /// Called off by the progress callback.
    #[error("cancelled")]
    Cancelled,
}

/// A path as one line of text, whatever characters it contains.
pub(crate) fn one_line(path: &Path) -> String {
    clean(&path.to_string_lossy())
}

/// `text` without control characters, which would break a message into lines.
pub(crate) fn clean(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}
