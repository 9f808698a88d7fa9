//! Frames as `.npz` archives, for NumPy and this crate's reader.

use std::io::{Seek, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, System, ZipWriter};

use super::arrays::{ORIGIN, TIME, VOXEL_SIZE};
use crate::import::error::FormatFault;
use crate::import::npy::header_bytes;

/// Members with more bytes need the wide fields of zip64.
const MOST_NARROW_BYTES: u64 = u32::MAX as u64 - (1 << 16);

/// Compression level, 0 to 9: the default of zip programs.
const LEVEL: i64 = 6;

/// One step of a simulation on a box of voxels.
#[derive(Debug, Clone, Copy)]
pub struct DenseFrame<'a> {
    /// Voxels along x, y, z.
    pub shape: [usize; 3],
    /// Burning field, z fastest.
    pub flame: &'a [[f32; 1]],
    /// Velocity in world units per second, z fastest.
    pub velocity: &'a [[f32; 3]],
    /// Voxel edge in world units.
    pub voxel_size: f64,
    /// Centre of the first voxel in world units.
    pub origin: [f64; 3],
    /// Time of the step in seconds.
    pub time_s: Option<f64>,
}

/// Writes a frame: arrays `flame` (x, y, z) and `velocity` (x, y, z, 3) of float32, `voxel_size`, `origin` and, if
/// known, `time_s` of float64. Equal frames give equal bytes.
///
/// # Errors
/// If an array does not have as many values as its shape states, or if writing to `out` fails.
pub fn write_frame(out: impl Write + Seek, frame: &DenseFrame) -> Result<(), FormatFault> {
    let [x, y, z] = frame.shape;
    let voxels = x.checked_mul(y).and_then(|area| area.checked_mul(z));
    if let Some(found) = [frame.flame.len(), frame.velocity.len()].into_iter().find(|found| Some(*found) != voxels) {
        return Err(crate::Error::Shape { shape: frame.shape, found }.into());
    }
    let mut archive = ZipWriter::new(out);
    let flame = frame.flame.as_flattened();
    member(&mut archive, "flame", "<f4", &[x, y, z], flame.iter().map(|value| value.to_le_bytes()))?;
    let velocity = frame.velocity.as_flattened();
    member(&mut archive, "velocity", "<f4", &[x, y, z, 3], velocity.iter().map(|value| value.to_le_bytes()))?;
    member(&mut archive, VOXEL_SIZE, "<f8", &[], [frame.voxel_size.to_le_bytes()].into_iter())?;
    member(&mut archive, ORIGIN, "<f8", &[3], frame.origin.iter().map(|value| value.to_le_bytes()))?;
    if let Some(time_s) = frame.time_s {
        member(&mut archive, TIME, "<f8", &[], [time_s.to_le_bytes()].into_iter())?;
    }
    let mut out = archive.finish().map_err(failure)?;
    out.flush().map_err(failure)
}

/// Writes one array.
fn member<const BYTES: usize>(
    archive: &mut ZipWriter<impl Write + Seek>,
    name: &str,
    descr: &str,
    shape: &[usize],
    numbers: impl ExactSizeIterator<Item = [u8; BYTES]>,
) -> Result<(), FormatFault> {
    // No trace of the clock or the machine.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .compression_level(Some(LEVEL))
        .last_modified_time(DateTime::default())
        .unix_permissions(0o644)
        .system(System::Unix)
        .large_file((numbers.len() as u64).saturating_mul(BYTES as u64) > MOST_NARROW_BYTES);
    archive.start_file(format!("{name}.npy"), options).map_err(failure)?;
    archive.write_all(&header_bytes(descr, shape)).map_err(failure)?;
    let mut piece = Vec::with_capacity(PIECE_BYTES);
    for number in numbers {
        piece.extend(number);
        if piece.len() >= PIECE_BYTES {
            archive.write_all(&piece).map_err(failure)?;
            piece.clear();
        }
    }
    archive.write_all(&piece).map_err(failure)
}

/// Approximate size in bytes of the pieces in which numbers are written.
const PIECE_BYTES: usize = 1 << 16;

fn failure(error: impl std::fmt::Display) -> FormatFault {
    FormatFault::NotWritten(error.to_string())
}
