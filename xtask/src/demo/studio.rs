//! Bounces, and what the page shows of a sound: files to hear, pictures to see.

use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Result;
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::{Recording, write_file, write_wav_f32};
use pyrophone_settings::{Automation, Id, Values};

use super::analysis::Spectrum;
use super::page::Row;
use super::plots::{ASH, Curve, EMBER, FLAME_BLUE, spectrogram, spectrum};
use crate::bounce::{Request, learned, play, reference};

/// Peak of what is made for listening, in dB of full scale.
const LISTENING_PEAK_DB: f64 = -1.0;

/// A sound and its spectrum.
pub struct Sound {
    channels: Vec<Vec<f32>>,
    sample_rate_hz: u32,
    spectrum: Spectrum,
}

impl Sound {
    /// A sound at its rate.
    pub fn of(channels: Vec<Vec<f32>>, sample_rate_hz: u32) -> Self {
        let spectrum = Spectrum::of(&channels, sample_rate_hz);
        Self { channels, sample_rate_hz, spectrum }
    }

    fn peak(&self) -> f64 {
        self.channels.iter().flatten().fold(0.0, |peak, x| f64::from(x.abs()).max(peak))
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
        /// Exponent of the noise, where it is what counts.
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
pub struct Burnt {
    /// The result.
    pub sound: Sound,
    /// Time for reading and indexing the recording.
    pub loading: Duration,
    /// Time for playing.
    pub playing: Duration,
    /// Length of the input in seconds.
    seconds: f64,
}

impl Burnt {
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
    pub fn burn(&self, job: &Job<'_>) -> Result<Burnt> {
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
        Ok(Burnt {
            sound: Sound::of(played.channels, job.input.sample_rate_hz),
            loading: played.loading,
            playing: played.playing,
            seconds: job.input.duration_s(),
        })
    }

    /// Writes a sound's files and gives its row of the page; `slug` names the files, `note` is HTML.
    pub fn row(&self, slug: &str, name: &str, note: &str, sound: &Sound, beside: &Beside<'_>) -> Result<Row> {
        eprintln!("  {name}");
        let gain_db = LISTENING_PEAK_DB - 20.0 * sound.peak().max(1e-9).log10();
        write_wav_f32(&self.folder.join(format!("{slug}.float.wav")), &sound.channels, sound.sample_rate_hz)?;
        self.write_listening_copy(slug, sound, gain_db)?;
        spectrogram(&self.folder.join(format!("{slug}.spectrogram.png")), &sound.channels, sound.sample_rate_hz)?;
        let (curves, alpha) = curves(sound, beside);
        spectrum(&self.folder.join(format!("{slug}.spectrum.png")), &curves, alpha)?;
        Ok(Row {
            slug: slug.to_owned(),
            name: name.to_owned(),
            note: note.to_owned(),
            is_source: !matches!(beside, Beside::Result { .. }),
            facts: vec![format!("gain {gain_db:+.1} dB").replace('-', "−")],
        })
    }

    /// 16-bit, so that every browser plays it; rounded with triangular dither of two steps.
    fn write_listening_copy(&self, slug: &str, sound: &Sound, gain_db: f64) -> Result<()> {
        let spec = hound::WavSpec {
            channels: sound.channels.len() as u16,
            sample_rate: sound.sample_rate_hz,
            bits_per_sample: 16,
            sample_format: hound::SampleFormat::Int,
        };
        let gain = 10f64.powf(gain_db / 20.0) * f64::from(i16::MAX);
        let dither = pyrophone_synthesis::noise::White::new(0, 0);
        let dither = |n: i64| dither.at(n) * 0.5 / 3f64.sqrt();
        let samples = sound.channels.first().map_or(0, Vec::len);
        write_file(&self.folder.join(format!("{slug}.wav")), |file| {
            let mut writer = hound::WavWriter::new(std::io::BufWriter::new(file), spec)?;
            let mut count = 0;
            for index in 0..samples {
                for channel in &sound.channels {
                    let x = f64::from(channel[index]) * gain + dither(2 * count) + dither(2 * count + 1);
                    count += 1;
                    writer.write_sample(x.round() as i16)?;
                }
            }
            writer.finalize()
        })?;
        Ok(())
    }
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
                // The recording's own level says nothing about the result: what counts is the shape.
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
