//! A fingerprint of all source that a dictionary depends on, which distinguishes files stored by an earlier build from
//! those of this one.

use std::collections::BTreeSet;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};

/// Sources from a file's bytes to a dictionary: decoding and resampling, transforms, learning, and this crate.
const SOURCES: [&str; 4] = ["../recording/src", "../maths/src", "../synthesis/src", "src"];

fn main() {
    let mut hasher = DefaultHasher::new();
    for folder in SOURCES {
        println!("cargo:rerun-if-changed={folder}");
        let mut files = BTreeSet::new();
        collect(Path::new(folder), &mut files);
        assert!(!files.is_empty(), "there is no source below {folder}");
        for file in &files {
            // Only the text counts: the location of a checkout does not matter.
            file.hash(&mut hasher);
            fs::read(file).unwrap_or_default().hash(&mut hasher);
        }
    }
    println!("cargo:rustc-env=PYROPHONE_BUILD_FINGERPRINT={:016x}", hasher.finish());
}

fn collect(folder: &Path, files: &mut BTreeSet<PathBuf>) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            collect(&path, files);
        } else {
            files.insert(path);
        }
    }
}
