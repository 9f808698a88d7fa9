//! Blender's adaptive domain: the position of a frame's box in the whole domain, and the true size of its voxels.
//!
//! Mantaflow divides the whole domain's size by the cells of the box that the smoke fills at that frame, and calls the
//! result the voxel size; it does not state the box's position at all. Both are in the cache's `config` folder, in a
//! gzip stream of numbers for each frame (Blender's `MANTA::writeConfiguration`).

use std::fs::File;
use std::io::Read;
use std::path::Path;

use flate2::read::GzDecoder;

use crate::grid::Transform;

/// Number of bytes up to the last value that is read.
const BYTES: usize = 172;

/// Offsets of three integers each: cells of the frame's box, cells of the whole domain, lowest cell of the box.
const CELLS: usize = 4;
const BASE_CELLS: usize = 148;
const LOWEST_CELL: usize = 160;

/// Largest plausible number of cells along an edge.
const MOST_CELLS: i32 = 1 << 16;

/// The part of a domain that a frame holds, in cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct DomainBox {
    /// Its own cells.
    cells: [i32; 3],
    /// Cells of the whole domain.
    base: [i32; 3],
    /// Its lowest cell in the whole domain.
    lowest: [i32; 3],
}

impl DomainBox {
    /// The box of the frame in `data/fluid_data_0001.vdb`, from `config/config_0001.uni`; none if that file is missing
    /// or makes no sense, or if the box is the whole domain.
    pub fn beside(frame: &Path) -> Option<Self> {
        let name = frame.file_stem()?.to_str()?;
        let digits = &name[name.trim_end_matches(|c: char| c.is_ascii_digit()).len()..];
        let folder = frame.parent()?.parent()?.join("config");
        let file = File::open(folder.join(format!("config_{digits}.uni"))).ok()?;
        let mut bytes = [0; BYTES];
        GzDecoder::new(file).read_exact(&mut bytes).ok()?;
        let whole = Self { cells: cells(&bytes, CELLS)?, base: cells(&bytes, BASE_CELLS)?, lowest: [0; 3] };
        let found = Self { lowest: cells(&bytes, LOWEST_CELL)?, ..whole };
        let fits = |axis: usize| {
            found.cells[axis] > 0 && found.lowest[axis].checked_add(found.cells[axis]) <= Some(found.base[axis])
        };
        let is_part = found.cells != found.base || found.lowest != [0; 3];
        (is_part && (0..3).all(fits)).then_some(found)
    }

    /// The transform of a grid of `grid_cells` whose file states voxels of `edge`; none if the grid does not belong to
    /// this box. Noise has several voxels per cell.
    pub fn transform(&self, grid_cells: [i32; 3], edge: f64) -> Option<Transform> {
        let parts = grid_cells[0].checked_div(self.cells[0]).filter(|parts| *parts > 0)?;
        if (0..3).any(|axis| self.cells[axis].checked_mul(parts) != Some(grid_cells[axis])) {
            return None;
        }
        let longest = |cells: [i32; 3]| f64::from(cells.into_iter().max().unwrap_or(1));
        let domain = edge * longest(grid_cells);
        let cell = domain / longest(self.base);
        Transform::uniform(cell / f64::from(parts), self.lowest.map(|lowest| cell * f64::from(lowest))).ok()
    }
}

fn cells(bytes: &[u8; BYTES], at: usize) -> Option<[i32; 3]> {
    let number = |n: usize| bytes.get(at + 4 * n..)?.first_chunk().map(|bytes| i32::from_le_bytes(*bytes));
    let cells = [number(0)?, number(1)?, number(2)?];
    cells.iter().all(|cells| (0..=MOST_CELLS).contains(cells)).then_some(cells)
}
