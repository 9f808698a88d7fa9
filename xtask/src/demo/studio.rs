//! Bounces, and the page's presentation of a sound: audio files and pictures.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::{Context, Result};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::{Recording, write_wav_f32};
use pyrophone_settings::{Automation, Id, Values};

use super::loudness::{Listening, matched};
use super::page::{Pair, Row, Side};
use super::plots::{ASH, Curve, EMBER, FLAME_BLUE, spectrogram, spectrum};
use crate::bounce::{Request, learned, play, reference};
use pyrophone_analysis::Spectrum;

/// Rights in a result.
const RIGHTS_OF_RESULT: &str = "those in the sounds it was made from";

/// A sound, its spectrum, and its licence.
pub struct Sound {
    channels: Vec<Vec<f32>>,
    sample_rate_hz: u32,
    spectrum: Spectrum,
    rights: String,
}

impl Sound {
    /// A sound at its rate; `rights` is the licence that it is under.
    pub fn new(channels: Vec<Vec<f32>>, sample_rate_hz: u32, rights: &str) -> Self {
        let spectrum = Spectrum::of_channels(&channels, sample_rate_hz);
        Self { channels, sample_rate_hz, spectrum, rights: rights.to_owned() }
    }

    fn seconds(&self) -> f64 {
        self.channels.first().map_or(0, Vec::len) as f64 / f64::from(self.sample_rate_hz)
    }

    /// A 16-bit WAV file, which every browser plays; rounded with triangular dither of two steps.
    fn listening_copy(&self, gain_db: f64) -> Result<Vec<u8>> {
        let spec = hound::WavSpec {
            channels: self.channels.len() as u16,
            sample_rate: self.sample_rate_hz,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let gain = 10f64.powf(gain_db / 20.0) * f64::from(i16::MAX);
        let dither = pyrophone_synthesis::dsp::White::new(0, 0);
        let dither = |n: i64| dither.sample_at(n) * 0.5 / 3f64.sqrt();
        let mut file = std::io::Cursor::new(vec![]);
        let mut writer = hound::WavWriter::new(&mut file, spec)?;
        let mut count = 0;
        for index in 0..self.channels.first().map_or(0, Vec::len) {
            for channel in &self.channels {
                let x = f64::from(channel[index]) * gain + dither(2 * count) + dither(2 * count + 1);
                count += 1;
                writer.write_sample(x.round() as i16)?;
            }
        }
        writer.finalize()?;
        Ok(file.into_inner())
    }
}

/// Signals drawn behind a sound's spectrum.
pub enum Beside<'a> {
    /// Nothing: it is an input.
    Input,
    /// Nothing: it is a recording.
    Training,
    /// Input and recording of a result.
    Result {
        /// The flame signal.
        input: &'a Sound,
        /// The recording, where one was used.
        training: Option<&'a Sound>,
        /// Exponent of the noise, where it matters.
        alpha: Option<f64>,
    },
}

/// One bounce.
pub struct Job<'a> {
    /// The flame signal.
    pub input: &'a Recording,
    /// The recording's file.
    pub training: Option<&'a Path>,
    /// Values of all parameters.
    pub values: &'a Values,
    /// Channels of the result, 1 or 2.
    pub output_channels: usize,
}

/// Result of a job.
pub struct RenderedJob {
    /// The result.
    pub sound: Sound,
    /// Time for reading and indexing the recording.
    pub loading: Duration,
    /// Time for playing.
    pub playing: Duration,
    /// Length of the input in seconds.
    seconds: f64,
}

impl RenderedJob {
    /// Speed: seconds of sound per second of computing.
    pub fn speed(&self) -> String {
        let factor = self.seconds / self.playing.as_secs_f64().max(1e-6);
        format!("{factor:.0} × real time")
    }
}

/// Folder of the page's files.
pub struct Studio {
    folder: PathBuf,
}

impl Studio {
    /// A studio that writes into this folder.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The page's folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Bounces through the CLAP plugin.
    pub fn render(&self, job: &Job<'_>) -> Result<RenderedJob> {
        let needs_learning = Id::DynamicRange.parameter().to_text(job.values.get(Id::DynamicRange)) == "learned";
        let played = play(&Request {
            format: Format::Clap,
            values: job.values,
            automation: &Automation::default(),
            main: job.input,
            sidechain: &[],
            training: job.training.map(reference).transpose()?,
            learned: if needs_learning { Some(learned(job.values, job.input, &[])?) } else { None },
            block: BlockSize::Fixed(512),
            offline: true,
            reference_padding: false,
            output_channels: job.output_channels,
        })?;
        Ok(RenderedJob {
            sound: Sound::new(played.channels, job.input.sample_rate_hz, RIGHTS_OF_RESULT),
            loading: played.loading,
            playing: played.playing,
            seconds: job.input.duration_s(),
        })
    }

    /// Writes a sound's files and gives its row of the page; `slug` names the files, `note` is HTML.
    pub fn row(&self, slug: &str, name: &str, note: &str, sound: &Sound, beside: &Beside<'_>) -> Result<Row> {
        eprintln!("  {name}");
        let [listening] = Self::listening([sound])?;
        write_wav_f32(&self.folder.join(format!("{slug}.float.wav")), &sound.channels, sound.sample_rate_hz)?;
        self.write(&format!("{slug}.wav"), &sound.listening_copy(listening.gain_db)?)?;
        spectrogram(&self.folder.join(format!("{slug}.spectrogram.png")), &sound.channels, sound.sample_rate_hz)?;
        let (curves, alpha) = curves(sound, beside);
        spectrum(&self.folder.join(format!("{slug}.spectrum.png")), &curves, alpha)?;
        Ok(Row {
            slug: slug.to_owned(),
            name: name.to_owned(),
            note: note.to_owned(),
            is_source: !matches!(beside, Beside::Result { .. }),
            duration_ms: (1000.0 * sound.seconds()).round() as u64,
            facts: vec![played_at(listening)],
            rights: sound.rights.clone(),
        })
    }

    /// Two sounds at one loudness, to switch between while they play; `slugs` name their rows, whose pictures they share.
    pub fn pair(&self, sounds: [&Sound; 2], slugs: [&str; 2]) -> Result<Pair> {
        let listening = Self::listening(sounds)?;
        let side = |n: usize| -> Result<Side> {
            let wav = STANDARD.encode(sounds[n].listening_copy(listening[n].gain_db)?);
            Ok(Side { slug: slugs[n].to_owned(), fact: played_at(listening[n]), wav })
        };
        Ok(Pair { sides: [side(0)?, side(1)?] })
    }

    /// Gains that match the loudness of sounds.
    fn listening<const N: usize>(sounds: [&Sound; N]) -> Result<[Listening; N]> {
        let sounds = sounds.map(|sound| (sound.channels.as_slice(), sound.sample_rate_hz));
        let found = matched(&sounds)?;
        found.try_into().ok().context("as many loudnesses as sounds")
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<()> {
        let path = self.folder.join(name);
        std::fs::write(&path, bytes).with_context(|| path.display().to_string())
    }
}

/// The loudness of a player, and its gain, in words.
fn played_at(Listening { gain_db, lufs }: Listening) -> String {
    let loudness = lufs.map_or_else(|| "too quiet for LUFS".to_owned(), |lufs| format!("{lufs:.1} LUFS"));
    format!("{loudness} at gain {gain_db:+.1} dB").replace('-', "−")
}

/// The curves of a sound's spectrum plot, its own last and so on top.
fn curves<'a>(sound: &'a Sound, beside: &Beside<'a>) -> (Vec<Curve<'a>>, Option<f64>) {
    let curve = |name, sound: &'a Sound, gain_db, color, is_main| {
        let spectrum = &sound.spectrum;
        Curve { name, spectrum, gain_db, color, is_main }
    };
    match beside {
        Beside::Input => (vec![curve("input", sound, 0.0, FLAME_BLUE, true)], None),
        Beside::Training => (vec![curve("recording", sound, 0.0, ASH, true)], None),
        Beside::Result { input, training, alpha } => {
            let mut curves = vec![];
            if let Some(training) = training {
                // The recording's own level says nothing about the result: only the shape matters.
                let loudness = |sound: &Sound| 10.0 * sound.spectrum.power(250.0, 16_000.0).max(1e-20).log10();
                curves.push(curve(
                    "recording, level matched",
                    training,
                    loudness(sound) - loudness(training),
                    ASH,
                    false,
                ));
            }
            curves.push(curve("input", input, 0.0, FLAME_BLUE, false));
            curves.push(curve("result", sound, 0.0, EMBER, true));
            (curves, *alpha)
        }
    }
}
