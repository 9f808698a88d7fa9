//! Errors of simulation files and folders.

use std::path::Path;

/// A fault in a file's content, without the file's name.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FormatFault {
    /// The bytes contradict themselves or their format.
    #[error("the file is damaged ({0}); write or copy it again")]
    Damaged(String),
    /// A known format, but an unsupported kind of it.
    #[error("{found} cannot be read; {advice}")]
    Unsupported {
        /// Content found.
        found: String,
        /// Advice on what to use instead.
        advice: &'static str,
    },
    /// More data than the memory budget allows.
    #[error("{what}: {found}, but at most {allowed} are allowed; use a smaller or coarser simulation")]
    TooLarge {
        /// The thing counted.
        what: &'static str,
        /// Number found.
        found: u64,
        /// Number allowed.
        allowed: u64,
    },
    /// No grid matches the requested name.
    #[error("there is no {wanted}; the file contains {there}: name one of those")]
    NoGrid {
        /// The requested name and kind.
        wanted: String,
        /// Names and types of the grids in the file.
        there: String,
    },
    /// A required value is NaN or infinite.
    #[error("grid {grid} holds values that are not finite numbers; simulate or export it again")]
    NotFinite {
        /// The grid.
        grid: String,
    },
    /// A grid's position in the world, or its shape, makes no sense.
    #[error(transparent)]
    Grid(Box<crate::Error>),
    /// The system failed while the file was read.
    #[error("cannot be read ({0}); copy it to a local disk and try again")]
    Unreadable(String),
    /// The system failed while the file was written.
    #[error("cannot be written ({0}); choose a folder that exists, is writable and has room")]
    NotWritten(String),
}

impl From<crate::Error> for FormatFault {
    fn from(error: crate::Error) -> Self {
        Self::Grid(Box::new(error))
    }
}

/// Reason why a simulation could not be read.
///
/// Every message is one line: which file, what was found, what is allowed, what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no such file or folder.
    #[error("{path}: there is no such file or folder; check the path")]
    Missing {
        /// The requested path.
        path: String,
    },
    /// The system refuses access to a file or folder.
    #[error("{path}: cannot be read ({reason}); check its permissions or copy it to a local disk")]
    Unreadable {
        /// The path.
        path: String,
        /// The system's message.
        reason: String,
    },
    /// Something is wrong with a file's content.
    #[error("{path}: {fault}")]
    File {
        /// The file.
        path: String,
        /// The fault found.
        fault: FormatFault,
    },
    /// An unsupported kind of file.
    #[error("{path}: files of this kind are not supported; use .vdb, .npz or .npy")]
    Kind {
        /// The file.
        path: String,
    },
    /// A folder without frames.
    #[error("{path}: no frames here; a folder of files such as name_0001.vdb, .npz or .npy is needed, {found}")]
    NoFrames {
        /// The folder.
        path: String,
        /// Contents of the folder.
        found: String,
    },
    /// A folder with frames of several sequences.
    #[error(
        "{path}: frames of several sequences ({found}); move one to a folder of its own, or choose one with --input \"NAME.####.vdb\""
    )]
    Mixed {
        /// The folder.
        path: String,
        /// The sorts and how many files each has.
        found: String,
    },
    /// Two files claim one frame.
    #[error("{path}: duplicate frame {number} ({first}, {second}); remove one of them")]
    Twice {
        /// The folder.
        path: String,
        /// The frame.
        number: i64,
        /// The name of one file.
        first: String,
        /// The name of the other.
        second: String,
    },
    /// Frame numbers far apart.
    #[error(
        "{path}: between frames {first} and {last}, {missing} are missing, but at most {allowed} may be; remove stray files"
    )]
    Gap {
        /// The folder.
        path: String,
        /// The lowest number.
        first: i64,
        /// The highest number.
        last: i64,
        /// Numbers without a file.
        missing: u64,
        /// Number that may be missing.
        allowed: u64,
    },
    /// Frames with uneven times.
    #[error("{path}: the frames' own times (time_s) are uneven, but steps must be even; give the rate with --rate")]
    UnevenTimes {
        /// The folder or file.
        path: String,
    },
    /// A frame that the sequence does not have.
    #[error("{path}: frame {index} was requested, but there are {found} (counting from 0); choose one that exists")]
    NoFrame {
        /// The folder or file.
        path: String,
        /// The requested frame.
        index: usize,
        /// Number of frames.
        found: usize,
    },
    /// An invalid row of a series.
    #[error("{path}: line {line}: {reason}")]
    Row {
        /// The file.
        path: String,
        /// The line, from 1.
        line: u64,
        /// The fault found, and what is allowed.
        reason: String,
    },
}

impl Error {
    /// Converter for a fault in the content of the file at `path`.
    pub fn of_file(path: &Path) -> impl Fn(FormatFault) -> Self + use<> {
        let path = shown_path(path);
        move |fault| Self::File { path: path.clone(), fault }
    }

    /// Converter for a system error about `path`.
    pub(super) fn of_system(path: &Path) -> impl Fn(std::io::Error) -> Self + use<> {
        let path = shown_path(path);
        move |error| match error.kind() {
            std::io::ErrorKind::NotFound => Self::Missing { path: path.clone() },
            kind => Self::Unreadable { path: path.clone(), reason: kind.to_string() },
        }
    }
}

/// Longest name in messages; longer ones are cut.
const LONGEST_NAME: usize = 80;

/// A name from a file, fit for one line of a message.
pub(super) fn shown(name: &str) -> String {
    let clean: String = name.chars().take(LONGEST_NAME).map(|c| if c.is_control() { '?' } else { c }).collect();
    if name.chars().nth(LONGEST_NAME).is_some() { clean + "…" } else { clean }
}

/// A path, fit for one line of a message.
pub(super) fn shown_path(path: &Path) -> String {
    path.display().to_string().chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}

/// Shorthand for what most checks find.
pub(super) fn damaged<T>(reason: impl Into<String>) -> Result<T, FormatFault> {
    Err(FormatFault::Damaged(reason.into()))
}
