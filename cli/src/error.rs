//! Errors that end a command early, each reported in one line.

use std::path::Path;

/// Reason why a command wrote no output.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// A sound file could not be read, used or written.
    #[error(transparent)]
    Recording(#[from] pyrophone_recording::Error),
    /// An option is out of range.
    #[error(transparent)]
    Option(pyrophone_synthesis::Error),
    /// An engine rejected a file.
    #[error("{path}: {source}")]
    File {
        /// The file.
        path: String,
        /// Its cause.
        source: pyrophone_synthesis::Error,
    },
    /// A parameter, preset or automation was rejected.
    #[error("{0}")]
    Settings(String),
    /// A flame could not be measured, or one of the options for that is out of range.
    #[error(transparent)]
    Flame(Box<pyrophone_flame::Error>),
    /// A frame could not be measured.
    #[error("{path}: {source}")]
    Frame {
        /// Its file.
        path: String,
        /// Its cause.
        source: Box<pyrophone_flame::Error>,
    },
    /// A simulation or series could not be read.
    #[error(transparent)]
    Import(Box<pyrophone_flame::import::Error>),
    /// Stopped half-way; the finished part is kept.
    #[error("{reason}; the {done} finished {what} are in {path}: run the command again to resume from there")]
    Unfinished {
        /// The reason.
        reason: Box<Self>,
        /// Number finished.
        done: usize,
        /// Frames or rows.
        what: &'static str,
        /// Path of the checkpoint.
        path: String,
    },
    /// An option conflicts with another option or with a file.
    #[error("{0}")]
    Conflict(String),
    /// Stopped by a signal, such as Ctrl-C's.
    #[error("cancelled; nothing was written")]
    Cancelled,
    /// Signal handlers could not be installed.
    #[error("Ctrl-C cannot be handled ({0}); run from an ordinary terminal")]
    Signal(#[from] std::io::Error),
}

impl Error {
    /// Converter for an engine's error about the sound in `path`.
    pub fn of_file(path: &Path) -> impl Fn(pyrophone_synthesis::Error) -> Self + use<> {
        let path = path.display().to_string();
        move |source| match source {
            pyrophone_synthesis::Error::Cancelled => Self::Cancelled,
            source @ pyrophone_synthesis::Error::OutOfRange { .. } => Self::Option(source),
            source => Self::File { path: path.clone(), source },
        }
    }
}

impl From<pyrophone_flame::Error> for Error {
    fn from(error: pyrophone_flame::Error) -> Self {
        Self::Flame(Box::new(error))
    }
}

impl From<pyrophone_flame::import::Error> for Error {
    fn from(error: pyrophone_flame::import::Error) -> Self {
        Self::Import(Box::new(error))
    }
}

impl From<pyrophone_fires::Error> for Error {
    fn from(error: pyrophone_fires::Error) -> Self {
        match error {
            pyrophone_fires::Error::Recording(pyrophone_recording::Error::Cancelled) => Self::Cancelled,
            pyrophone_fires::Error::Recording(error) => error.into(),
            pyrophone_fires::Error::Settings(error) => error.into(),
            error @ pyrophone_fires::Error::Engines { .. } => Self::Settings(error.to_string()),
        }
    }
}

impl From<pyrophone_settings::Error> for Error {
    fn from(error: pyrophone_settings::Error) -> Self {
        Self::Settings(error.to_string().replace(['\n', '\r'], " "))
    }
}
