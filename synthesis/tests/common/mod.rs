//! Reading the reference data.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

#[path = "../../../tests/src/skip.rs"]
pub mod skip;

/// The reference data's folder; where there is none, says so (and fails under `CI=true`).
pub fn reference_dir() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from);
    if folder.join("signals").is_dir() {
        return Some(folder);
    }
    let missing = format!("no reference data at {}: set PYROPHONE_REFERENCE", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
    skip::skip(&missing);
    None
}

/// A file of little-endian doubles.
pub fn read_f64(path: &Path) -> Vec<f64> {
    let bytes = std::fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(!bytes.is_empty(), "{} is empty", path.display());
    bytes.chunks_exact(8).map(|x| f64::from_le_bytes(x.try_into().unwrap())).collect()
}

/// Channels and sample rate in Hz of a float WAV file.
pub fn read_wav(path: &Path) -> (Vec<Vec<f64>>, u32) {
    let mut reader = hound::WavReader::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let spec = reader.spec();
    let mut channels = vec![Vec::new(); usize::from(spec.channels)];
    for (i, sample) in reader.samples::<f32>().enumerate() {
        channels[i % usize::from(spec.channels)].push(f64::from(sample.unwrap()));
    }
    assert!(!channels[0].is_empty(), "{} is empty", path.display());
    (channels, spec.sample_rate)
}
