//! Size of everything in the window, which the user chooses for all instances; stored beside the presets.

use std::path::{Path, PathBuf};

use crate::{Library, user_file};

/// Name of the file in the user's folder; not a preset's.
const NAME: &str = "window-scale.txt";
/// Choices in percent of the size that the system asks for; the first is the default.
pub const SCALES_PERCENT: [u16; 6] = [100, 110, 125, 150, 175, 200];

/// A file with one of [`SCALES_PERCENT`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScaleFile {
    file: PathBuf,
}

impl ScaleFile {
    /// The user's file; none if the user has no home.
    pub fn of_user() -> Option<Self> {
        Some(Self::new(Library::of_user()?.folder()))
    }

    /// The file in `folder`, which need not exist yet.
    pub fn new(folder: &Path) -> Self {
        Self { file: folder.join(NAME) }
    }

    /// The scale in percent; anything but a choice reads as 100.
    pub fn read(&self) -> u16 {
        let percent = user_file::read(&self.file).trim().parse().unwrap_or(SCALES_PERCENT[0]);
        if SCALES_PERCENT.contains(&percent) { percent } else { SCALES_PERCENT[0] }
    }

    /// Stores the scale.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, percent: u16) -> std::io::Result<()> {
        user_file::write(&self.file, &format!("{percent}\n"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_is_kept_and_garbage_is_100_percent() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = ScaleFile::new(&folder.path().join("not yet"));
        assert_eq!(file.read(), 100);
        file.write(150).expect("written");
        assert_eq!(file.read(), 150);
        for garbage in ["", "x", "-1", "160", "1e9", "150 %"] {
            std::fs::write(&file.file, garbage).expect("written");
            assert_eq!(file.read(), 100, "{garbage}");
        }
    }
}
