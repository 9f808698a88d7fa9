//! The files of a simulation, and their identity for resumed runs.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use pyrophone_flame::import::Sequence;
use pyrophone_recording::content_hash;

/// Hexadecimal digits of a hash that are kept.
const DIGITS: usize = 16;

/// All files of a simulation, requested or not.
pub fn files(sequence: &Sequence) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = (0..sequence.len()).map(|index| sequence.path_of(index).into()).collect();
    files.extend(files.first().map(|path| arrays_beside(path)).unwrap_or_default());
    files
}

/// Identity of files in their present state, independent of their folder: a hash of names, sizes and modification times
/// in seconds.
pub fn identity(files: &[PathBuf]) -> String {
    let mut list = String::new();
    for path in files {
        let metadata = path.metadata();
        let size = metadata.as_ref().map_or(0, std::fs::Metadata::len);
        let time = metadata.and_then(|metadata| metadata.modified()).ok();
        // Whole seconds: what is finer does not survive a copy to every kind of disk.
        let time_s = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok()).map_or(0, |time| time.as_secs());
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        list += &format!("{name} {size} {time_s}\n");
    }
    content_hash(list.as_bytes()).chars().take(DIGITS).collect()
}

/// Files of some frames.
pub fn files_of(sequence: &Sequence, indices: &[usize]) -> Vec<PathBuf> {
    let paths: Vec<PathBuf> = indices.iter().map(|index| sequence.path_of(*index).into()).collect();
    let arrays = paths.first().map(|path| arrays_beside(path)).unwrap_or_default();
    if arrays.is_empty() { paths } else { arrays }
}

/// All arrays in the same folder, in order: a frame of arrays has several files, of which a sequence names the first.
/// Empty if `path` is no array.
fn arrays_beside(path: &Path) -> Vec<PathBuf> {
    let is_array = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy"));
    let folder = path.parent().filter(|_| is_array(path));
    let entries = folder.and_then(|folder| folder.read_dir().ok()).into_iter().flatten().flatten();
    let is_hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let paths = entries.map(|entry| entry.path());
    let mut arrays: Vec<PathBuf> = paths.filter(|path| is_array(path) && !is_hidden(path)).collect();
    arrays.sort_unstable();
    arrays
}
