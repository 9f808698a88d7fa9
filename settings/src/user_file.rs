//! Small text files of the user that several instances read and write.

use std::fs;
use std::io::Write;
use std::path::Path;

/// A larger file is none of ours.
const LARGEST_BYTES: u64 = 1 << 20;

/// The file's text; empty if the file is missing or unreadable.
pub fn read(file: &Path) -> String {
    let is_ours = fs::metadata(file).is_ok_and(|found| found.is_file() && found.len() <= LARGEST_BYTES);
    if is_ours { fs::read_to_string(file).unwrap_or_default() } else { String::new() }
}

/// Writes the file completely or not at all, and creates its folder if needed.
pub fn write(file: &Path, text: &str) -> std::io::Result<()> {
    let folder = file.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let beside = folder.join(format!(".{name}.{}", std::process::id()));
    let written = fs::File::create(&beside).and_then(|mut created| created.write_all(text.as_bytes()));
    let done = written.and_then(|()| fs::rename(&beside, file));
    if done.is_err() {
        // It may not exist.
        let _ = fs::remove_file(&beside);
    }
    done
}
