//! Summary of a command's results, for `--json`.
//!
//! The shape is a promise to scripts: keys are only ever added. Values that do not apply or are unknown are `null`.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::level::Level;

/// Results of a command.
#[derive(Debug, Default)]
pub struct Outcome {
    /// The output requested with `--output`.
    pub output: Option<PathBuf>,
    /// The sound in it.
    pub sound: Option<Sound>,
    /// All other files that were written.
    pub files: Vec<PathBuf>,
    /// The engines' latency, already cut off the output.
    pub latency_samples: Option<usize>,
}

/// A sound that was written.
#[derive(Debug, Clone)]
pub struct Sound {
    /// Samples of each channel.
    pub samples: usize,
    /// Its sample rate.
    pub sample_rate_hz: u32,
    /// Its channels.
    pub channels: usize,
    /// Peak and loudness.
    pub level: Level,
    /// BLAKE3 of its samples, from [`pyrophone_recording::samples_hash`].
    pub hash: String,
}

/// The JSON object.
#[derive(Serialize)]
struct Summary<'a> {
    command: &'a str,
    output: Option<String>,
    files: Vec<String>,
    seconds: Option<f64>,
    sample_rate_hz: Option<u32>,
    channels: Option<usize>,
    peak_dbfs: Option<f64>,
    lufs: Option<f64>,
    latency_samples: Option<usize>,
    hash: Option<&'a str>,
    notes: &'a [String],
}

impl Outcome {
    /// Results with a sound in the requested file.
    pub fn with_sound(output: &Path, sound: Sound) -> Self {
        Self { output: Some(output.to_owned()), sound: Some(sound), ..Self::default() }
    }

    /// Adds more files.
    pub fn with_files(mut self, files: Vec<PathBuf>) -> Self {
        self.files.extend(files);
        self
    }

    /// The summary as JSON, ending with a newline.
    pub fn to_json(&self, command: &str, notes: &[String]) -> String {
        let sound = self.sound.as_ref();
        let text = |path: &PathBuf| path.display().to_string();
        json(&Summary {
            command,
            output: self.output.as_ref().map(text),
            files: self.files.iter().map(text).collect(),
            seconds: sound.map(|sound| sound.samples as f64 / f64::from(sound.sample_rate_hz)),
            sample_rate_hz: sound.map(|sound| sound.sample_rate_hz),
            channels: sound.map(|sound| sound.channels),
            peak_dbfs: sound.and_then(|sound| sound.level.peak_dbfs()).map(hundredths),
            lufs: sound.and_then(|sound| sound.level.lufs).map(hundredths),
            latency_samples: self.latency_samples,
            hash: sound.map(|sound| sound.hash.as_str()),
            notes,
        })
    }
}

/// Writes text to standard output. A closed pipe, as with `| head`, is not worth an error.
pub fn print(text: &str) {
    let _ = std::io::stdout().write_all(text.as_bytes());
}

/// JSON of a value made of texts, numbers and lists, which always has a JSON form.
pub fn json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

/// Rounds to hundredths: finer than audible differences of level, and the same on any machine.
fn hundredths(value: f64) -> f64 {
    // Adding 0 turns a rounded -0 into 0.
    (100.0 * value).round() / 100.0 + 0.0
}
