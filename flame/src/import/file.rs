//! Files of frames.

use std::fs::File;
use std::path::Path;

use super::budget::check_file_size;
use super::error::{Error, shown_path};

/// Opens a regular file, not a device or a pipe, and returns its size.
pub(super) fn open(path: &Path) -> Result<(File, u64), Error> {
    let file = File::open(path).map_err(Error::of_system(path))?;
    let metadata = file.metadata().map_err(Error::of_system(path))?;
    if !metadata.is_file() {
        let reason = "it is not a file".into();
        return Err(Error::Unreadable { path: shown_path(path), reason });
    }
    check_file_size(metadata.len()).map_err(Error::of_file(path))?;
    Ok((file, metadata.len()))
}
