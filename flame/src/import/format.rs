//! Formats of frames, by file extension.

use std::path::Path;

/// Formats of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Format {
    Vdb,
    Npz,
    Npy,
}

impl Format {
    /// The format of a file, by its extension.
    pub fn of_path(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "vdb" => Some(Self::Vdb),
            "npz" => Some(Self::Npz),
            "npy" => Some(Self::Npy),
            _ => None,
        }
    }

    /// Extension of such files, with its dot.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vdb => ".vdb",
            Self::Npz => ".npz",
            Self::Npy => ".npy",
        }
    }
}
