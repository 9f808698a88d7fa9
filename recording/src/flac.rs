//! FLAC out: 24 bits, lossless from there on.

use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::Path;

use flacenc::bitsink::ByteSink;
use flacenc::component::{BitRepr, MetadataBlockData, Stream, StreamInfo};
use flacenc::config;
use flacenc::encode_fixed_size_frame;
use flacenc::error::{Verified, Verify};
use flacenc::source::{Context, Fill, FrameBuf};

use crate::error::one_line;
use crate::write::{check_channels, write_file};
use crate::{Broadcast, Error, flac_tags};

/// Most channels that a FLAC file has.
pub const MAX_FLAC_CHANNELS: usize = 8;
/// Highest sample rate in Hz that the encoder supports.
pub const MAX_FLAC_RATE_HZ: u32 = 96_000;

const BITS: usize = 24;
/// Full scale as an integer.
const FULL_SCALE: f64 = (1 << (BITS - 1)) as f64;
/// Samples per frame of the format; the usual number.
const FRAME_SAMPLES: usize = 4096;

/// Rounds samples to 24 bits; returns the number of samples beyond full scale, which are clipped.
pub fn round_to_24_bit(channels: &mut [Vec<f32>]) -> usize {
    let mut clipped = 0;
    for sample in channels.iter_mut().flatten() {
        clipped += usize::from(sample.abs() > 1.0);
        *sample = (f64::from(quantised(*sample)) / FULL_SCALE) as f32;
    }
    clipped
}

/// Checks that FLAC can store a sound.
///
/// # Errors
/// [`Error::NotForFlac`] if there are too many channels, or if the rate is too high for the encoder.
pub fn check_flac(path: &Path, channels: usize, sample_rate_hz: u32) -> Result<(), Error> {
    if channels <= MAX_FLAC_CHANNELS && sample_rate_hz <= MAX_FLAC_RATE_HZ {
        return Ok(());
    }
    Err(Error::NotForFlac { path: one_line(path), channels, sample_rate_hz })
}

/// Writes 24-bit FLAC: `channels` of equal length, 1 to [`MAX_FLAC_CHANNELS`], rounded as by [`round_to_24_bit`]; the
/// position on the timeline, if there is one, is stored in the comments.
///
/// # Errors
/// As [`write_wav_f32`](crate::write_wav_f32), and if there are more channels or the rate is higher than
/// [`MAX_FLAC_RATE_HZ`].
pub fn write_flac_24(
    path: &Path,
    channels: &[Vec<f32>],
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> Result<(), Error> {
    check_channels(path, channels, sample_rate_hz)?;
    check_flac(path, channels.len(), sample_rate_hz)?;
    write_file(path, |file| encode(file, channels, sample_rate_hz, broadcast))
}

/// Full scale and beyond become the largest possible numbers.
fn quantised(sample: f32) -> i32 {
    (f64::from(sample) * FULL_SCALE).round().clamp(-FULL_SCALE, FULL_SCALE - 1.0) as i32
}

/// Frame by frame, so that an hour of sound is not in memory a second time; data known only at the end is then written
/// into the head.
fn encode(
    file: &mut std::fs::File,
    channels: &[Vec<f32>],
    sample_rate_hz: u32,
    broadcast: Option<&Broadcast>,
) -> Result<(), String> {
    let count = channels.len();
    let samples = channels.first().map_or(0, Vec::len);
    let config = encoder()?;
    let mut info = StreamInfo::new(sample_rate_hz as usize, count, BITS).map_err(said)?;
    let mut frame = FrameBuf::with_size(count, FRAME_SAMPLES).map_err(said)?;
    let mut context = Context::new(BITS, count);
    let comments = flac_tags::comments(count, broadcast);
    let mut out = BufWriter::new(file);
    out.write_all(&head(&info, &comments)?).map_err(said)?;
    for (number, start) in (0..samples).step_by(FRAME_SAMPLES).enumerate() {
        let end = samples.min(start + FRAME_SAMPLES);
        let interleaved: Vec<i32> =
            (start..end).flat_map(|index| channels.iter().map(move |samples| quantised(samples[index]))).collect();
        frame.fill_interleaved(&interleaved).map_err(said)?;
        context.fill_interleaved(&interleaved).map_err(said)?;
        let encoded = encode_fixed_size_frame(&config, &frame, number, &info).map_err(said)?;
        info.update_frame_info(&encoded);
        out.write_all(&bytes_of(&encoded)?).map_err(said)?;
    }
    info.set_block_sizes(FRAME_SAMPLES, FRAME_SAMPLES).map_err(said)?;
    info.set_total_samples(samples);
    info.set_md5_digest(&context.md5_digest());
    out.seek(SeekFrom::Start(0)).map_err(said)?;
    out.write_all(&head(&info, &comments)?).map_err(said)?;
    out.flush().map_err(said)
}

fn encoder() -> Result<Verified<config::Encoder>, String> {
    config::Encoder::default().into_verified().map_err(|(_, error)| error.to_string())
}

/// Everything before the first frame; equally long at the start and at the end of encoding.
fn head(info: &StreamInfo, comments: &[u8]) -> Result<Vec<u8>, String> {
    let mut stream = Stream::with_stream_info(info.clone());
    stream.add_metadata_block(MetadataBlockData::new_unknown(flac_tags::COMMENTS, comments).map_err(said)?);
    bytes_of(&stream)
}

fn bytes_of(part: &impl BitRepr) -> Result<Vec<u8>, String> {
    let mut sink = ByteSink::new();
    part.write(&mut sink).map_err(said)?;
    Ok(sink.into_inner())
}

fn said(error: impl std::fmt::Display) -> String {
    error.to_string()
}
