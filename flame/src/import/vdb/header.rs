//! Header of a grid: its descriptor, metadata and transform.

use super::cursor::Cursor;
use super::values::{ACTIVE_MASK, BLOSC, FLAGGED_VERSION, ZIP};
use crate::grid::Transform;
use crate::import::error::{FormatFault, damaged, shown};

/// Largest number of entries in a metadata map.
const MOST_ENTRIES: usize = 4096;

/// Separator between the user's name for a grid and the number that makes it unique.
const UNIQUE_MARK: char = '\u{1e}';

/// First version in which a frustum's box is stored as doubles.
const DOUBLE_BOX_VERSION: u32 = 221;

/// Descriptor of a grid.
pub(super) struct Descriptor {
    pub unique_name: String,
    pub tree: String,
    /// Unique name of the grid whose tree this one shares; empty if it has its own.
    pub parent: String,
    /// Offsets of the body, the leaves' values and the next descriptor; meaningless in a file without offsets.
    pub positions: [i64; 3],
}

impl Descriptor {
    pub fn read(cursor: &mut Cursor) -> Result<Self, FormatFault> {
        let (unique_name, tree, parent) = (cursor.text()?, cursor.text()?, cursor.text()?);
        Ok(Self { unique_name, tree, parent, positions: [cursor.i64()?, cursor.i64()?, cursor.i64()?] })
    }

    /// Name of the grid, as the user knows it.
    pub fn name(&self) -> &str {
        self.unique_name.split(UNIQUE_MARK).next().unwrap_or_default()
    }

    /// Start and end of the body; fails unless both come after `here` and before the file's end, so that no file can
    /// make the reader go round in circles.
    pub fn extent(&self, here: usize, file_end: usize) -> Result<(usize, usize), FormatFault> {
        let [start, leaves, end] = self.positions.map(usize::try_from);
        match (start, leaves, end) {
            (Ok(start), Ok(leaves), Ok(end))
                if here <= start
                    && start <= end
                    && end <= file_end
                    && (!self.parent.is_empty() || (start <= leaves && leaves <= end)) =>
            {
                Ok((start, end))
            }
            _ => {
                damaged(format!("grid {} from byte {} to {}", shown(self.name()), self.positions[0], self.positions[2]))
            }
        }
    }
}

/// Metadata of a grid.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub compression: u32,
    pub metadata: Metadata,
    /// Transform from indices to the world, or the reason why it is unusable.
    pub transform: Result<Transform, FormatFault>,
}

impl Header {
    /// Reads a header. `file_compression` is the compression of all grids, in old files.
    pub fn read(cursor: &mut Cursor, version: u32, file_compression: u32) -> Result<Self, FormatFault> {
        let compression = if version >= FLAGGED_VERSION { cursor.u32()? } else { file_compression };
        if compression & !(ZIP | ACTIVE_MASK | BLOSC) != 0 {
            return damaged(format!("compression flags {compression:#x}"));
        }
        let metadata = Metadata::read(cursor)?;
        let transform = map(cursor, version, true)?;
        Ok(Self { compression, metadata, transform })
    }
}

/// The relevant entries of a metadata map.
#[derive(Debug, Clone, Default)]
pub(super) struct Metadata {
    pub half: bool,
    pub class: String,
    pub in_voxels: bool,
    /// Largest extent of the grid in voxels; only Blender's files state it.
    pub cells: Option<[i32; 3]>,
    /// True if Blender wrote it.
    pub is_blender: bool,
}

impl Metadata {
    pub fn read(cursor: &mut Cursor) -> Result<Self, FormatFault> {
        let count = cursor.u32()? as usize;
        if count > MOST_ENTRIES {
            return damaged(format!("{count} entries of metadata, at most {MOST_ENTRIES} are allowed"));
        }
        cursor.check_room("entries of metadata", count, 12)?;
        let mut metadata = Self::default();
        for _ in 0..count {
            let (name, kind, size) = (cursor.text()?, cursor.text()?, cursor.u32()?);
            let bytes = cursor.read_bytes(size as usize)?;
            match (name.as_str(), kind.as_str()) {
                ("is_saved_as_half_float", "bool") => metadata.half = truth(&name, bytes)?,
                ("is_local_space", "bool") => metadata.in_voxels = truth(&name, bytes)?,
                ("file_base_resolution", _) => {
                    metadata.is_blender = true;
                    metadata.cells = three(bytes);
                }
                ("class", "string") => metadata.class = String::from_utf8_lossy(bytes).trim().to_owned(),
                _ => {}
            }
        }
        Ok(metadata)
    }
}

fn three(bytes: &[u8]) -> Option<[i32; 3]> {
    let bytes: &[u8; 12] = bytes.try_into().ok()?;
    Some(std::array::from_fn(|n| i32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * n + byte]))))
}

fn truth(name: &str, bytes: &[u8]) -> Result<bool, FormatFault> {
    match bytes {
        [byte] => Ok(*byte != 0),
        _ => damaged(format!("{name} of {} bytes, 1 is expected", bytes.len())),
    }
}

/// Reads a transform map: the outer failure loses the position in the file, the inner one only the grid. A frustum
/// contains another map, but not a second frustum.
fn map(cursor: &mut Cursor, version: u32, may_be_frustum: bool) -> Result<Result<Transform, FormatFault>, FormatFault> {
    let name = cursor.text()?;
    let none = [0.0; 3];
    Ok(match name.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let [x, y, z, ..] = cursor.f64s::<15>()?;
            scale([x, y, z], none)
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let [tx, ty, tz, x, y, z, ..] = cursor.f64s::<18>()?;
            scale([x, y, z], [tx, ty, tz])
        }
        "TranslationMap" => scale([1.0; 3], cursor.f64s()?),
        "AffineMap" | "UnitaryMap" => affine(cursor.f64s()?),
        "NonlinearFrustumMap" if may_be_frustum => {
            cursor.read_bytes(6 * if version < DOUBLE_BOX_VERSION { 4 } else { 8 })?;
            cursor.f64s::<2>()?;
            let _ = map(cursor, version, false)?;
            let advice = "export the grid with a box-shaped (linear) transform";
            Err(FormatFault::Unsupported { found: "a grid in a camera's frustum".into(), advice })
        }
        _ => return damaged(format!("a transform of unknown kind \"{}\"", shown(&name))),
    })
}

fn scale(edges: [f64; 3], translation: [f64; 3]) -> Result<Transform, FormatFault> {
    let [x, y, z] = edges;
    Ok(Transform::new([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]], translation)?)
}

/// The transform of a matrix for row vectors, whose last row is the translation.
fn affine(matrix: [f64; 16]) -> Result<Transform, FormatFault> {
    let [a, b, c, u, d, e, f, v, g, h, i, w, x, y, z, one] = matrix;
    if [u, v, w, one] != [0.0, 0.0, 0.0, 1.0] {
        return damaged("a transform with perspective");
    }
    Ok(Transform::new([[a, b, c], [d, e, f], [g, h, i]], [x, y, z])?)
}
