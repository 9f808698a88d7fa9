//! `pyrophone flux` and `flux-merge`: what is measured, kept, put together and refused.

mod film;
mod frames;
mod rates;
mod refusals;
mod series;
mod shards;

use std::fs::File;
use std::path::Path;

use crate::common::pyrophone;
use pyrophone_flame::flux::Flux;
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use tempfile::TempDir;

/// Voxels along an edge.
const SIZE: usize = 16;

/// A ball of flame that breathes, in a flow away from its middle.
fn flame(path: &Path, number: i64, voxel_size: f64) {
    let radius = 5.0 + 0.7 * (number as f64 * 0.9).sin();
    let from_middle = |n: usize| -> [f64; 3] {
        [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64 - 0.5 * (SIZE - 1) as f64)
    };
    let away = |n: usize| from_middle(n).iter().map(|x| x * x).sum::<f64>().sqrt();
    let count = SIZE * SIZE * SIZE;
    let frame = DenseFrame {
        shape: [SIZE; 3],
        flame: &(0..count).map(|n| [(0.5 + 0.25 * (radius - away(n))).clamp(0.0, 1.0) as f32]).collect::<Vec<_>>(),
        velocity: &(0..count).map(|n| from_middle(n).map(|x| x as f32)).collect::<Vec<_>>(),
        voxel_size,
        origin: [0.0; 3],
        time_s: Some(number as f64 / 360.0),
    };
    write_frame(File::create(path).unwrap(), &frame).unwrap();
}

/// A folder with `flame/flame_0003.npz` to `flame_0022.npz`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("flame")).unwrap();
    for number in 3..=22 {
        flame(&frame(folder.path(), number), number, 0.1);
    }
    folder
}

fn frame(folder: &Path, number: i64) -> std::path::PathBuf {
    folder.join("flame").join(format!("flame_{number:04}.npz"))
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

fn table(folder: &Path, name: &str) -> Flux {
    Flux::read_csv(&std::fs::read_to_string(folder.join(name)).unwrap(), name).unwrap()
}

/// Standard error of a run that succeeds.
fn notes(folder: &Path, arguments: &str) -> String {
    let output = pyrophone(folder, arguments);
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments}: {notes}");
    assert!(notes.lines().all(|line| line.starts_with("note: ")), "{notes}");
    notes
}
