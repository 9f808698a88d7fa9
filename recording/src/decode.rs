//! From a file's bytes to samples.

use std::io::{Cursor, ErrorKind, Read};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;

use symphonia::core::audio::SampleBuffer;
use symphonia::core::codecs::{
    CODEC_TYPE_FLAC, CODEC_TYPE_MP1, CODEC_TYPE_MP2, CODEC_TYPE_MP3, CODEC_TYPE_NULL, CODEC_TYPE_VORBIS,
    CodecParameters, CodecType, DecoderOptions,
};
use symphonia::core::errors::Error as DecoderError;
use symphonia::core::formats::{FormatOptions, FormatReader};
use symphonia::core::io::{MediaSourceStream, MediaSourceStreamOptions};
use symphonia::core::meta::{Limit, MetadataOptions};
use symphonia::core::probe::Hint;

use crate::error::{clean, one_line};
use crate::{Error, MAX_FILE_BYTES, MAX_SAMPLES, MAX_SECONDS, Progress, Recording, container, content_hash};

/// Reads a whole file into memory.
///
/// Fails where it is missing, a folder, not readable, empty, or larger than
/// [`MAX_FILE_BYTES`](crate::MAX_FILE_BYTES).
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

/// Reads and decodes a sound file: WAV, AIFF, CAF (linear PCM), FLAC, Ogg Vorbis or MP3.
///
/// Integer samples become fractions of full scale; 32-bit floats stay as they are, bit for bit.
/// Fails as [`read`] and [`decode_bytes`] do.
pub fn decode(path: &Path, progress: Progress) -> Result<Recording, Error> {
    decode_shared(read(path)?, &file_name(path), progress)
}

/// Decodes a sound file held in memory; `name` stands in messages and hints at the format.
///
/// Fails on bytes that are no sound, of an unsupported kind, damaged or truncated, and on sound
/// outside the limits of this crate or with a sample that is not finite.
pub fn decode_bytes(bytes: &[u8], name: &str, progress: Progress) -> Result<Recording, Error> {
    decode_shared(bytes.to_vec(), &clean(name), progress)
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| one_line(path), |name| clean(&name.to_string_lossy()))
}

fn decode_shared(bytes: Vec<u8>, name: &str, progress: Progress) -> Result<Recording, Error> {
    if bytes.is_empty() {
        return Err(Error::Empty { name: name.into() });
    }
    container::check(&bytes, name)?;
    let content_hash = content_hash(&bytes);
    let mut bytes = bytes;
    container::repair(&mut bytes);
    let bytes = FileBytes(Arc::new(bytes));
    // Decoders of compressed formats assert what a damaged file may break.
    let decoded = catch_unwind(AssertUnwindSafe(|| Decoding::run(bytes, name, progress)));
    let broken = |_| Error::Damaged { name: name.into(), reason: "its decoder gave up".into() };
    let (channels, sample_rate_hz) = decoded.map_err(broken)??;
    check_finite(&channels, name)?;
    Ok(Recording { channels, sample_rate_hz, name: name.into(), content_hash })
}

fn check_finite(channels: &[Vec<f32>], name: &str) -> Result<(), Error> {
    let first_bad = |(channel, samples): (usize, &Vec<f32>)| {
        samples.iter().position(|sample| !sample.is_finite()).map(|index| (index, channel, samples[index]))
    };
    match channels.iter().enumerate().filter_map(first_bad).min_by_key(|(index, channel, _)| (*index, *channel)) {
        Some((index, channel, value)) => Err(Error::NotFinite { name: name.into(), channel, index, value }),
        None => Ok(()),
    }
}

/// The file, shared with a decoder that wants to own its source.
#[derive(Clone)]
struct FileBytes(Arc<Vec<u8>>);

impl AsRef<[u8]> for FileBytes {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

struct Decoding<'a> {
    name: &'a str,
    progress: Progress<'a>,
    sample_rate_hz: u32,
    channels: Vec<Vec<f32>>,
}

impl<'a> Decoding<'a> {
    fn run(bytes: FileBytes, name: &'a str, progress: Progress<'a>) -> Result<(Vec<Vec<f32>>, u32), Error> {
        let mut format = probe(&bytes, name)?;
        let track = format
            .tracks()
            .iter()
            .find(|track| track.codec_params.codec != CODEC_TYPE_NULL)
            .ok_or_else(|| Error::NotAudio { name: name.into(), found: "it has no sound track".into() })?;
        let (track_id, parameters) = (track.id, track.codec_params.clone());
        let mut decoding =
            Self { name, progress, sample_rate_hz: parameters.sample_rate.unwrap_or(0), channels: vec![] };
        if let Some(samples) = declared_samples(&parameters) {
            decoding.check_length(samples, parameters.channels.map_or(1, |channels| channels.count()))?;
        }
        decoding.decode_track(format.as_mut(), track_id, &parameters)?;
        decoding.check_complete(&parameters)?;
        Ok((decoding.channels, decoding.sample_rate_hz))
    }

    fn decode_track(
        &mut self,
        format: &mut dyn FormatReader,
        track_id: u32,
        parameters: &CodecParameters,
    ) -> Result<(), Error> {
        let mut decoder = symphonia::default::get_codecs()
            .make(parameters, &DecoderOptions { verify: false })
            .map_err(|error| self.refuse(error))?;
        let mut last_failure = None;
        loop {
            let packet = match format.next_packet() {
                Ok(packet) if packet.track_id() == track_id => packet,
                Ok(_) => continue,
                Err(DecoderError::IoError(error)) if error.kind() == ErrorKind::UnexpectedEof => break,
                Err(error) => return Err(self.refuse(error)),
            };
            match decoder.decode(&packet) {
                Ok(decoded) if decoded.frames() == 0 => continue,
                Ok(decoded) => {
                    let spec = *decoded.spec();
                    let mut interleaved = SampleBuffer::<f32>::new(decoded.capacity() as u64, spec);
                    interleaved.copy_interleaved_ref(decoded);
                    self.append(interleaved.samples(), spec.channels.count(), spec.rate)?;
                }
                // A lossy stream that was cut from a longer one opens with packets that cannot be
                // decoded without those before them.
                Err(DecoderError::DecodeError(reason)) if is_lossy(parameters.codec) => last_failure = Some(reason),
                Err(error) => return Err(self.refuse(error)),
            }
            let known = parameters.n_frames.filter(|total| *total > 0);
            let done = known.map_or(0.0, |total| self.channels.first().map_or(0, Vec::len) as f32 / total as f32);
            if !(self.progress)(done.min(1.0)) {
                return Err(Error::Cancelled);
            }
        }
        match last_failure {
            Some(reason) if self.channels.is_empty() => Err(self.damaged(reason)),
            _ => Ok(()),
        }
    }

    fn append(&mut self, interleaved: &[f32], channels: usize, rate_hz: u32) -> Result<(), Error> {
        container::check_layout(channels, Some(rate_hz), self.name)?;
        if self.channels.is_empty() {
            self.sample_rate_hz = rate_hz;
            self.channels = vec![vec![]; channels];
        } else if channels != self.channels.len() || rate_hz != self.sample_rate_hz {
            return Err(self.damaged("its channels or its sample rate change in mid-file"));
        }
        let samples = (self.channels[0].len() + interleaved.len() / channels) as u64;
        self.check_length(samples, channels)?;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            channel.extend(interleaved.iter().skip(index).step_by(channels));
        }
        Ok(())
    }

    fn check_length(&self, samples: u64, channels: usize) -> Result<(), Error> {
        let name = || self.name.to_string();
        let found = samples.saturating_mul(channels as u64);
        let found_s = samples as f64 / f64::from(self.sample_rate_hz.max(1));
        if found_s > f64::from(MAX_SECONDS) {
            return Err(Error::TooLong { name: name(), found_s });
        }
        if found > MAX_SAMPLES as u64 {
            return Err(Error::TooManySamples { name: name(), found });
        }
        Ok(())
    }

    /// Where a format states its exact length, that much must have come out.
    fn check_complete(&self, parameters: &CodecParameters) -> Result<(), Error> {
        let found = self.channels.first().map_or(0, Vec::len) as u64;
        match declared_samples(parameters) {
            Some(declared) if found < declared => {
                Err(Error::Truncated { name: self.name.into(), found, declared, unit: "samples" })
            }
            _ if found == 0 => Err(Error::NoSamples { name: self.name.into() }),
            _ => Ok(()),
        }
    }

    fn damaged(&self, reason: &str) -> Error {
        Error::Damaged { name: self.name.into(), reason: clean(reason) }
    }

    fn refuse(&self, error: DecoderError) -> Error {
        refuse(error, self.name)
    }
}

fn probe(bytes: &FileBytes, name: &str) -> Result<Box<dyn FormatReader>, Error> {
    let stream = MediaSourceStream::new(Box::new(Cursor::new(bytes.clone())), MediaSourceStreamOptions::default());
    let mut hint = Hint::new();
    if let Some((_, extension)) = name.rsplit_once('.') {
        hint.with_extension(extension);
    }
    let format_options = FormatOptions { enable_gapless: true, ..Default::default() };
    let metadata_options =
        MetadataOptions { limit_metadata_bytes: Limit::Maximum(1 << 20), limit_visual_bytes: Limit::Maximum(0) };
    match symphonia::default::get_probe().format(&hint, stream, &format_options, &metadata_options) {
        Ok(probed) => Ok(probed.format),
        Err(DecoderError::IoError(error)) if error.kind() == ErrorKind::UnexpectedEof => Err(not_audio(bytes, name)),
        Err(DecoderError::Unsupported("core (probe): no suitable format reader found")) => Err(not_audio(bytes, name)),
        Err(error) => Err(refuse(error, name)),
    }
}

fn refuse(error: DecoderError, name: &str) -> Error {
    let name = name.to_string();
    match error {
        DecoderError::Unsupported(found) => {
            Error::Unsupported { name, found: format!("its kind of sound ({})", clean(found)) }
        }
        DecoderError::DecodeError(reason) => Error::Damaged { name, reason: clean(reason) },
        DecoderError::ResetRequired => Error::Damaged { name, reason: "a second stream follows the first".into() },
        other => Error::Damaged { name, reason: clean(&other.to_string()) },
    }
}

fn is_lossy(codec: CodecType) -> bool {
    matches!(codec, CODEC_TYPE_VORBIS | CODEC_TYPE_MP1 | CODEC_TYPE_MP2 | CODEC_TYPE_MP3)
}

/// The exact length in samples per channel, where the format has one and [`container`] has not
/// checked it already.
fn declared_samples(parameters: &CodecParameters) -> Option<u64> {
    parameters.n_frames.filter(|samples| parameters.codec == CODEC_TYPE_FLAC && *samples > 0)
}

/// What bytes that no reader took seem to be: most often a file of the wrong kind was chosen.
fn not_audio(bytes: &FileBytes, name: &str) -> Error {
    let bytes = bytes.as_ref();
    const MARKS: &[(&[u8], &str)] = &[
        (b"\x89PNG", "it is a PNG picture"),
        (b"\xff\xd8\xff", "it is a JPEG picture"),
        (b"%PDF", "it is a PDF document"),
        (b"PK\x03\x04", "it is a ZIP archive"),
        (b"\x1aE\xdf\xa3", "it is a Matroska or WebM film"),
        (b"fLaC", "its FLAC header breaks off"),
        (b"OggS", "its Ogg header breaks off"),
    ];
    let found = if let Some((_, found)) = MARKS.iter().find(|(mark, _)| bytes.starts_with(mark)) {
        (*found).to_string()
    } else if bytes.get(4..8) == Some(b"ftyp") {
        return Error::Unsupported { name: name.into(), found: "MP4 or M4A".into() };
    } else if bytes.iter().take(512).all(|byte| matches!(byte, b'\t' | b'\n' | b'\r' | 0x20..=0x7e | 0x80..)) {
        "it looks like text".to_string()
    } else {
        format!("{} bytes of no known sound format", bytes.len())
    };
    Error::NotAudio { name: name.into(), found }
}
