//! Fields with a closed form, and the reference data.
#![allow(dead_code, missing_docs)]

#[path = "../../../tests/src/skip.rs"]
mod skip;

use std::path::{Path, PathBuf};

use pyrophone_flame::Frame;
use pyrophone_flame::grid::{Grid, Transform};
use pyrophone_flame::velocity::{Placement, Velocity};

/// The folder of the reference flame; where there is none, says so (and fails under `CI=true`).
pub fn flame_cache() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from).join("flame_cache");
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no reference data at {}: set PYROPHONE_REFERENCE", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
    skip::skip(&missing);
    None
}

/// A field of `size` voxels along each edge, from its indices.
pub fn field(size: usize, transform: Transform, value: impl Fn([f64; 3]) -> f64) -> Grid<1> {
    Grid::dense([size; 3], &array(size, |index| [value(index) as f32]), transform).unwrap()
}

/// A flow of `size` voxels along each edge, from its indices.
pub fn flow(size: usize, transform: Transform, value: impl Fn([f64; 3]) -> [f64; 3]) -> Velocity {
    let values = array(size, |index| value(index).map(|part| part as f32));
    Velocity::Vectors(Grid::dense([size; 3], &values, transform).unwrap(), Placement::Collocated)
}

/// The same flow everywhere, infinitely far.
pub fn wind(value: [f32; 3]) -> Velocity {
    Velocity::Vectors(Grid::new(value, Transform::uniform(1.0, [0.0; 3]).unwrap()), Placement::Collocated)
}

pub fn frame(field: Grid<1>, velocity: Velocity) -> Frame {
    Frame { number: 1, field, velocity }
}

fn array<T>(size: usize, value: impl Fn([f64; 3]) -> T) -> Vec<T> {
    let count = size * size * size;
    (0..count).map(|n| value([n / (size * size), n / size % size, n % size].map(|i| i as f64))).collect()
}
