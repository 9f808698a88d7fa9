#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod broadcast;
mod channel_mask;
mod cut;
mod decode;
mod embed;
mod error;
mod flac;
mod flac_tags;
mod format;
mod g711;
mod note;
mod packets;
mod pcm;
mod resample;
mod stream;
mod subsonic;
mod wav;
mod write;

pub use broadcast::Broadcast;
pub use cut::{Cut, MAX_GAIN_DB};
pub use decode::{decode, decode_bytes, decode_known, read};
pub use embed::{MAX_EMBEDDED_BYTES, embed, unembed};
pub use error::Error;
pub use flac::{MAX_FLAC_CHANNELS, MAX_FLAC_RATE_HZ, check_flac, round_to_24_bit, write_flac_24};
pub use note::Note;
pub use resample::resample;
pub use stream::settle_length;
pub use write::{
    check_finite, check_not_among, check_writable, write_broadcast_wav_f32, write_file, write_wav_f32, write_wav_f32_to,
};

/// Largest number of channels of a recording.
pub const MAX_CHANNELS: usize = 10;
/// Lowest sample rate of a recording in Hz.
pub const MIN_SAMPLE_RATE_HZ: u32 = 1_000;
/// Highest sample rate of a recording in Hz.
pub const MAX_SAMPLE_RATE_HZ: u32 = 768_000;
/// Longest recording in seconds.
pub const MAX_SECONDS: u32 = 3_600;
/// Most samples of a recording, all channels together: 2 GiB of memory. One hour of stereo at
/// 48 kHz fits.
pub const MAX_SAMPLES: usize = 1 << 29;
/// Largest file that is read, in bytes: the size of [`MAX_SAMPLES`] in 32-bit float.
pub const MAX_FILE_BYTES: u64 = 4 * MAX_SAMPLES as u64 + (1 << 20);

/// Progress callback: receives the finished share of the work (0-1) and returns whether to continue. `false` ends the
/// work with [`Error::Cancelled`].
pub type Progress<'a> = &'a dyn Fn(f32) -> bool;

/// Callback for callers that neither watch nor cancel.
pub fn no_progress(_done: f32) -> bool {
    true
}

/// A decoded sound file: at least one sample, all of them finite.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Samples per channel, full scale at ±1; 1 to [`MAX_CHANNELS`] channels of equal length.
    pub channels: Vec<Vec<f32>>,
    /// Sample rate in Hz.
    pub sample_rate_hz: u32,
    /// The file's name without its folder.
    pub name: String,
    /// BLAKE3 of the file's bytes, 64 hexadecimal digits.
    pub content_hash: String,
    /// Notes for the user.
    pub notes: Vec<Note>,
}

impl Recording {
    /// Length in samples per channel.
    pub fn len_samples(&self) -> usize {
        self.channels.first().map_or(0, Vec::len)
    }

    /// Length in seconds.
    pub fn duration_s(&self) -> f64 {
        self.len_samples() as f64 / f64::from(self.sample_rate_hz)
    }
}

/// BLAKE3 of `bytes`, 64 hexadecimal digits: the identity of a recording, wherever it is stored.
pub fn content_hash(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex().to_string()
}

/// BLAKE3 of samples, 64 hexadecimal digits: frame by frame and channel by channel, as little-endian 32-bit floats. It
/// does not depend on the file format.
pub fn samples_hash(channels: &[Vec<f32>]) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut frame = Vec::with_capacity(4 * channels.len());
    for index in 0..channels.iter().map(Vec::len).min().unwrap_or(0) {
        frame.clear();
        frame.extend(channels.iter().flat_map(|samples| samples[index].to_le_bytes()));
        hasher.update(&frame);
    }
    hasher.finalize().to_hex().to_string()
}
