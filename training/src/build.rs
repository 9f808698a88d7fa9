//! From a part of a recording to its dictionary.

use pyrophone_recording::{Cut, Recording, resample};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;

/// Stage of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Resampling of the part to the engines' sample rate.
    Resampling,
    /// Building of its dictionary.
    Indexing,
}

/// Reason why there is no dictionary.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The part is empty, or cannot be resampled.
    #[error(transparent)]
    Recording(pyrophone_recording::Error),
    /// The engines reject it.
    #[error("{name}: {source}")]
    Engine {
        /// The recording's name.
        name: String,
        /// The engines' error.
        source: pyrophone_synthesis::Error,
    },
    /// `progress` has called it off.
    #[error("cancelled")]
    Cancelled,
}

impl From<pyrophone_recording::Error> for Error {
    fn from(error: pyrophone_recording::Error) -> Self {
        match error {
            pyrophone_recording::Error::Cancelled => Self::Cancelled,
            other => Self::Recording(other),
        }
    }
}

/// The dictionary of the part `cut` of a recording, for engines of a structure at a sample rate in Hz. `progress`
/// receives the stage and its finished share (0-1), and returns whether to continue.
///
/// The paper's method uses a recording unchanged; the companded one removes everything below hearing.
///
/// # Errors
/// [`Error::Recording`] if the part is empty or its gain out of range, [`Error::Engine`] if it is too short or contains
/// values that are not finite, [`Error::Cancelled`].
pub fn build(
    recording: &Recording,
    cut: &Cut,
    sample_rate_hz: f64,
    structure: &EngineConfig,
    progress: &(dyn Fn(Stage, f32) -> bool + Sync),
) -> Result<RecordingDictionary, Error> {
    let part = match structure.dynamics {
        MatchingMode::Paper => cut.as_recorded(recording)?,
        MatchingMode::Companded => cut.apply(recording)?,
    };
    let resampled = resample(&part, sample_rate_hz.round() as u32, &|done| progress(Stage::Resampling, done))?;
    let in_double = |channel: &Vec<f32>| channel.iter().map(|sample| f64::from(*sample)).collect();
    let channels: Vec<Vec<f64>> = resampled.channels.iter().map(in_double).collect();
    let shape = PyramidConfig::at_rate(structure, sample_rate_hz);
    let indexing = |done: f32| progress(Stage::Indexing, done);
    let made = RecordingDictionary::new(structure.dynamics, &channels, sample_rate_hz, &shape, &indexing);
    made.map_err(|error| match error {
        pyrophone_synthesis::Error::Cancelled => Error::Cancelled,
        source => Error::Engine { name: recording.name.clone(), source },
    })
}
