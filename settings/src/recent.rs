//! Recently loaded recordings, stored beside the user's presets.

use std::path::{Path, PathBuf};

use crate::{Library, user_file};

/// Name of the list in the user's folder; not a preset's.
const NAME: &str = "recent-recordings.txt";
/// Largest number of stored recordings.
pub const MOST: usize = 12;

/// A file with one path a line, the latest first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recent {
    file: PathBuf,
}

impl Recent {
    /// The user's list; none if the user has no home.
    pub fn of_user() -> Option<Self> {
        Some(Self::new(Library::of_user()?.folder()))
    }

    /// The list in `folder`, which need not exist yet.
    pub fn new(folder: &Path) -> Self {
        Self { file: folder.join(NAME) }
    }

    /// The paths, the latest first. A list that cannot be read is empty.
    pub fn list(&self) -> Vec<String> {
        let text = user_file::read(&self.file);
        text.lines().filter(|line| !line.trim().is_empty()).take(MOST).map(str::to_owned).collect()
    }

    /// Puts a path first, and returns the new list. Failure to write it is not reported: the list is a convenience.
    pub fn add(&self, path: &str) -> Vec<String> {
        let mut paths = self.list();
        if path.trim().is_empty() || path.contains(['\n', '\r']) {
            return paths;
        }
        paths.retain(|known| known != path);
        paths.insert(0, path.to_owned());
        paths.truncate(MOST);
        let _ = user_file::write(&self.file, &paths.join("\n"));
        paths
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn the_latest_stands_first_once_and_old_ones_go() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let recent = Recent::new(&folder.path().join("not yet"));
        assert_eq!(recent.list(), [""; 0]);
        for path in ["/a.wav", "/b.wav", "/a.wav", "", "/two\nlines.wav"] {
            recent.add(path);
        }
        assert_eq!(recent.list(), ["/a.wav", "/b.wav"]);
        for number in 0..20 {
            assert_eq!(recent.add(&format!("/{number}.wav"))[0], format!("/{number}.wav"));
        }
        assert_eq!((recent.list().len(), recent.list()[0].as_str()), (MOST, "/19.wav"));
        assert_eq!(fs::read_dir(folder.path().join("not yet")).expect("made").count(), 1, "nothing is left over");
    }

    #[test]
    fn unreadable_list_of_recent_files_is_ignored() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let recent = Recent::new(folder.path());
        fs::write(folder.path().join(NAME), [0xff, 0xfe, 0x00]).expect("written");
        assert_eq!(recent.list(), [""; 0]);
        assert_eq!(recent.add("/a.wav"), ["/a.wav"]);
        fs::remove_file(folder.path().join(NAME)).expect("removed");
        fs::create_dir(folder.path().join(NAME)).expect("made");
        assert_eq!(recent.add("/a.wav"), ["/a.wav"], "it is told though it cannot be kept");
    }
}
