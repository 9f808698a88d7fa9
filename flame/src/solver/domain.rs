//! The simulated box: its cells, and the boundary conditions at its six sides.

use crate::error::{Error, in_range};
use crate::grid::Transform;

/// Fewest and most cells along an axis.
const CELLS: std::ops::RangeInclusive<usize> = 4..=1024;

/// Largest number of cells: the limit of a few gigabytes of fields.
const MOST_CELLS: usize = 1 << 26;

/// Boundary condition at one side of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Side {
    /// Ambient pressure: gas leaves and enters freely.
    Open,
    /// A wall without friction.
    Wall,
    /// Gas enters (positive: along the axis) at this mean speed in m/s.
    Inflow(f64),
    /// Periodic: gas that leaves here enters at the opposite side, which must be periodic too.
    Periodic,
}

/// A box of cubic cells. Cell (i, j, k) has its centre at (i, j, k) in index units; z points up, and varies fastest in
/// memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    shape: [usize; 3],
    voxel_size_m: f64,
    sides: [[Side; 2]; 3],
}

impl Domain {
    /// A box of `shape` cells (4-1024 along each axis), with the lower and upper side of each axis.
    ///
    /// # Errors
    /// If a number is out of range, or if only one side of an axis is periodic.
    pub fn new(shape: [usize; 3], voxel_size_m: f64, sides: [[Side; 2]; 3]) -> Result<Self, Error> {
        for size in shape {
            in_range("number of cells along an axis", size as f64, *CELLS.start() as f64, *CELLS.end() as f64)?;
        }
        let cells: usize = shape.iter().product();
        in_range("number of cells", cells as f64, 1.0, MOST_CELLS as f64)?;
        in_range("voxel size in m", voxel_size_m, 1e-5, 100.0)?;
        for pair in sides {
            if (pair[0] == Side::Periodic) != (pair[1] == Side::Periodic) {
                return Err(Error::OneSidedPeriod);
            }
            for side in pair {
                if let Side::Inflow(speed) = side {
                    in_range("speed of inflow in m/s", speed, -1000.0, 1000.0)?;
                }
            }
        }
        Ok(Self { shape, voxel_size_m, sides })
    }

    /// Cells along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Edge of a cell in metres.
    pub fn voxel_size_m(&self) -> f64 {
        self.voxel_size_m
    }

    /// Centre of the first cell in m: the box stands on z = 0, its axis at x = y = 0.
    pub fn origin_m(&self) -> [f64; 3] {
        let h = self.voxel_size_m;
        let [nx, ny, _] = self.shape.map(|size| size as f64);
        [0.5 * h * (1.0 - nx), 0.5 * h * (1.0 - ny), 0.5 * h]
    }

    /// Transform from cells to the world.
    pub(crate) fn transform(&self) -> Result<Transform, Error> {
        Transform::uniform(self.voxel_size_m, self.origin_m())
    }

    /// The lower and upper side of each axis.
    pub fn sides(&self) -> &[[Side; 2]; 3] {
        &self.sides
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.shape.iter().product()
    }

    /// True if an axis is periodic.
    pub fn is_periodic(&self, axis: usize) -> bool {
        self.sides[axis][0] == Side::Periodic
    }

    /// True if gas cannot leave anywhere.
    pub fn is_closed(&self) -> bool {
        !self.sides.iter().flatten().any(|side| *side == Side::Open)
    }

    /// Shape of the array of faces across `axis`: one more than cells. On a periodic axis the last face is the first.
    pub fn face_shape(&self, axis: usize) -> [usize; 3] {
        let mut shape = self.shape;
        shape[axis] += 1;
        shape
    }

    /// The cells on both sides of the faces (i, j, 0), (i, j, 1), ... across `axis`.
    #[inline(always)]
    pub(crate) fn face_row(&self, axis: usize, i: usize, j: usize) -> FaceRow {
        let beside =
            |of: usize, position: usize| if of == axis { self.beside(axis, position) } else { (position, position) };
        let (x, y) = (beside(0, i), beside(1, j));
        FaceRow {
            before: cell_index(self.shape, x.0, y.0, 0),
            after: cell_index(self.shape, x.1, y.1, 0),
            along: (axis == 2).then(|| (self.shape[2], self.is_periodic(2))),
        }
    }

    /// The cells before and after a face across `axis`; at an end of the box, both are the last cell there.
    fn beside(&self, axis: usize, face: usize) -> (usize, usize) {
        beside(face, self.shape[axis], self.is_periodic(axis))
    }
}

/// A row of faces; see [`Domain::face_row`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct FaceRow {
    before: usize,
    after: usize,
    /// Faces across the row itself: number of cells, and true for a periodic row.
    along: Option<(usize, bool)>,
}

impl FaceRow {
    /// Indices of the cells before and after face k.
    #[inline(always)]
    pub fn cells(&self, k: usize) -> (usize, usize) {
        let (before, after) = match self.along {
            Some((size, periodic)) => beside(k, size, periodic),
            None => (k, k),
        };
        (self.before + before, self.after + after)
    }
}

#[inline(always)]
fn beside(face: usize, size: usize, periodic: bool) -> (usize, usize) {
    let before = match face {
        0 if periodic => size - 1,
        0 => 0,
        _ => face - 1,
    };
    let after = match face {
        _ if face < size => face,
        _ if periodic => 0,
        _ => size - 1,
    };
    (before, after)
}

/// Offset of element (i, j, k) in an array of `shape`.
#[inline(always)]
pub(crate) fn cell_index(shape: [usize; 3], i: usize, j: usize, k: usize) -> usize {
    (i * shape[1] + j) * shape[2] + k
}
