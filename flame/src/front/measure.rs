//! Flux through the flame front, its area and its curvature (Chadwick & James 2011, §3).

use rayon::prelude::*;

use super::cells;
use super::refinement::Refinement;
use super::spline::{Lattice, Patch};
use super::tetrahedra::{Crossing, march, mark};
use crate::error::{Error, in_range};
use crate::frame::Frame;
use crate::grid::{Grid, Region, cross, dot, length};
use crate::velocity::Probe;

/// The surface on which a smoothed field equals `iso`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    iso: f64,
    refinement: Refinement,
}

/// Measurements of a flame front at one step, in world units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measure {
    /// Velocity flux through the front, volume per second; positive if the flame expands.
    pub flux: f64,
    /// The front's area.
    pub area: f64,
    /// Mean of the mean curvature over the area, per unit of length; positive for a ball of flame. 0 without a front;
    /// none unless requested, because it costs as much as everything else together.
    pub mean_curvature: Option<f64>,
    /// Number of triangles that were examined: those of both surfaces where two subdivisions are blended.
    pub triangles: u64,
}

/// Relative rounding error of the net flux, if as much flows in as out. It counts as zero: scaled to a peak, it would
/// be audible as noise.
const ROUNDING: f64 = 1e-9;

/// Blocks of cells that are measured in one task. Every block has its own sums, which are added in order, whichever
/// thread computed them.
const BLOCKS_PER_PART: usize = 32;

/// A corner of a triangle of the front.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Corner {
    /// Position on the lattice: cell times `refine` plus steps, and direction of the edge.
    pub place: ([i64; 3], usize),
    /// Position in index space.
    pub index: [f64; 3],
}

/// Sums over a part of the front.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    flux: f64,
    /// Sum of the absolute flux, in and out.
    passing: f64,
    area: f64,
    triangles: u64,
}

impl Sums {
    fn plus(self, other: Self) -> Self {
        Self {
            flux: self.flux + other.flux,
            passing: self.passing + other.passing,
            area: self.area + other.area,
            triangles: self.triangles + other.triangles,
        }
    }

    /// A share of the measurements; all triangles count.
    fn times(self, share: f64) -> Self {
        Self { flux: share * self.flux, passing: share * self.passing, area: share * self.area, ..self }
    }
}

impl Front {
    /// The surface at `iso` (-1e9 to 1e9), with each cell between voxels divided along each edge as the refinement says:
    /// a number (1-16), or [`Refinement::BySize`], which is accurate enough for sound.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] if `iso` or the refinement is outside its range.
    pub fn new(iso: f64, refinement: impl Into<Refinement>) -> Result<Self, Error> {
        in_range("the iso value", iso, -1e9, 1e9)?;
        Ok(Self { iso, refinement: refinement.into().checked()? })
    }

    /// The value at the front.
    pub fn iso(&self) -> f64 {
        self.iso
    }

    /// Flux and area of one step; zeros without a surface. The same frame gives the same numbers, bit for bit, on any
    /// number of threads; large frames are divided among the threads of the caller's pool.
    ///
    /// # Errors
    /// If the flame is unbounded (the field's background burns), if a value is not finite, or if the field's tiles are
    /// too large to be intended.
    pub fn measure(&self, frame: &Frame) -> Result<Measure, Error> {
        self.measure_by(frame, |keys, level, refine| {
            let parts = keys.par_chunks(BLOCKS_PER_PART);
            parts.flat_map_iter(|keys| measure_blocks(frame, keys, level, refine)).collect()
        })
    }

    /// The same numbers, on the caller's thread alone: for several frames at a time. A thread of a pool that waits for parts
    /// of its frame would begin another one meanwhile, and hold both in memory.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn measure_on_this_thread(&self, frame: &Frame) -> Result<Measure, Error> {
        self.measure_by(frame, |keys, level, refine| measure_blocks(frame, keys, level, refine))
    }

    /// Adds up what `blocks` measures in blocks of cells, given their keys, the level and the subdivisions.
    fn measure_by(
        &self,
        frame: &Frame,
        blocks: impl Fn(&[[i32; 3]], f64, usize) -> Vec<Sums>,
    ) -> Result<Measure, Error> {
        if !frame.velocity.is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let level = self.level(&frame.field)?;
        let keys = cells::candidates(&frame.field, level)?;
        let sums = |refine: usize| blocks(&keys, level, refine).into_iter().fold(Sums::default(), Sums::plus);
        let shares = self.refinement.shares(&frame.field, level);
        let parts = shares.into_iter().map(|(refine, share)| sums(refine).times(share));
        let Sums { mut flux, passing, area, triangles } = parts.fold(Sums::default(), Sums::plus);
        if flux.abs() <= ROUNDING * passing {
            flux = 0.0;
        }
        let is_finite = flux.is_finite() && area.is_finite();
        if is_finite { Ok(Measure { flux, area, mean_curvature: None, triangles }) } else { Err(NOT_FINITE) }
    }

    /// The space around the front: the flow anywhere else has no part in the flux.
    ///
    /// # Errors
    /// As [`measure`](Self::measure), as far as the field is concerned.
    pub fn region(&self, field: &Grid<1>) -> Result<Region, Error> {
        let level = self.level(field)?;
        Ok(Region::new(cells::crossed(field, cells::candidates(field, level)?, level), *field.transform()))
    }

    /// The same measurements with the front's curvature.
    ///
    /// # Errors
    /// As [`measure`](Self::measure).
    pub fn measure_with_curvature(&self, frame: &Frame) -> Result<Measure, Error> {
        let measure = self.measure(frame)?;
        let transform = frame.field.transform();
        let cofactors = transform.cofactors();
        let (mut bending, mut area) = (0.0, 0.0);
        self.walk(&frame.field, |cell, corners, patch| {
            let indices = corners.map(|corner| corner.index);
            let of_triangle = length(apply(area_vector(&indices), &cofactors));
            let within = std::array::from_fn(|axis| {
                indices.iter().map(|index| index[axis] - f64::from(cell[axis])).sum::<f64>() / 3.0
            });
            let (gradient, hessian) = patch.derivatives(within);
            let hessian = hessian.map(|row| transform.gradient_to_world(row));
            let columns = std::array::from_fn(|i| transform.gradient_to_world(hessian.map(|row| row[i])));
            bending += of_triangle * mean_curvature(transform.gradient_to_world(gradient), columns);
            area += of_triangle;
        })?;
        let mean_curvature = if area > 0.0 { bending / area } else { 0.0 };
        if mean_curvature.is_finite() {
            Ok(Measure { mean_curvature: Some(mean_curvature), ..measure })
        } else {
            Err(NOT_FINITE)
        }
    }

    /// The level of the surface of `field`.
    fn level(&self, field: &Grid<1>) -> Result<f64, Error> {
        if !field.is_finite() {
            return Err(Error::NotFinite { what: "field" });
        }
        // Rounding must not create a surface where the field equals the iso value: such a plateau does not burn. Voxels
        // are `f32` and cannot lie exactly on the shifted level.
        let level = self.iso + self.iso.abs() * maths::powi(2.0, -30);
        let background = f64::from(field.background()[0]);
        if background > level { Err(Error::Unbounded { background, iso: self.iso }) } else { Ok(level) }
    }

    /// Visits every triangle with its cell and the cell's spline, in an order that depends on the field alone.
    /// Triangles are counter-clockwise as seen from outside, in index space.
    pub(super) fn walk(
        &self,
        field: &Grid<1>,
        mut visit: impl FnMut([i32; 3], [Corner; 3], &Patch),
    ) -> Result<(), Error> {
        let level = self.level(field)?;
        let refine = self.refinement.of_mesh();
        let mut lattice = Lattice::new(refine);
        let mut rows = Vec::new();
        cells::visit(field, &cells::candidates(field, level)?, level, |cell, patch| {
            lattice.sample(patch);
            mark(&lattice.values, refine, level, &mut rows);
            let corner = |crossing: Crossing| Corner {
                place: (
                    std::array::from_fn(|axis| i64::from(cell[axis]) * refine as i64 + crossing.low[axis] as i64),
                    crossing.direction,
                ),
                index: index(cell, &crossing, refine as f64),
            };
            march(&lattice.values, &rows, refine, level, corner, |corners| visit(cell, corners, patch));
        });
        Ok(())
    }
}

/// Measures the surface in some blocks of cells, each separately, in index space except for the length of an area.
fn measure_blocks(frame: &Frame, keys: &[[i32; 3]], level: f64, refine: usize) -> Vec<Sums> {
    let transform = frame.field.transform();
    let sign = if transform.is_mirrored() { -1.0 } else { 1.0 };
    let cofactors = transform.cofactors().map(|row| row.map(|part| sign * part));
    let mut velocity = Probe::new(&frame.velocity, transform);
    let per_step = 1.0 / refine as f64;
    let mut lattice = Lattice::new(refine);
    let mut rows = Vec::new();
    let point = |crossing: Crossing| within_cell(&crossing, per_step);
    let mut measure = |key: &[i32; 3]| {
        let mut sums = Sums::default();
        cells::visit(&frame.field, std::slice::from_ref(key), level, |cell, patch| {
            lattice.sample(patch);
            mark(&lattice.values, refine, level, &mut rows);
            let cell = cell.map(f64::from);
            march(&lattice.values, &rows, refine, level, point, |corners| {
                let surface = apply(area_vector(&corners), &cofactors);
                let [a, b, c] = corners;
                let centre = std::array::from_fn(|axis| cell[axis] + (a[axis] + b[axis] + c[axis]) / 3.0);
                let flux = dot(velocity.velocity_at(centre), surface);
                sums.flux += flux;
                sums.passing += flux.abs();
                sums.area += length(surface);
                sums.triangles += 1;
            });
        });
        sums
    };
    keys.iter().map(&mut measure).collect()
}

const NOT_FINITE: Error = Error::NotFinite { what: "flux" };

/// Half the vector product of two of a triangle's edges.
pub(super) fn area_vector([a, b, c]: &[[f64; 3]; 3]) -> [f64; 3] {
    let (ab, ac): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    cross(ab, ac).map(|part| 0.5 * part)
}

/// A row vector times a matrix.
pub(super) fn apply(vector: [f64; 3], rows: &[[f64; 3]; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| vector[0] * rows[0][axis] + vector[1] * rows[1][axis] + vector[2] * rows[2][axis])
}

/// Position of an edge's crossing in its cell, 0-1 along each axis.
fn within_cell(crossing: &Crossing, per_step: f64) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let along = ((crossing.direction >> (2 - axis)) & 1) as f64 * crossing.share;
        (crossing.low[axis] as f64 + along) * per_step
    })
}

/// Index-space position of an edge's crossing; the same, bit for bit, from all cells at the edge.
fn index(cell: [i32; 3], crossing: &Crossing, refine: f64) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let low = f64::from(cell[axis]) + crossing.low[axis] as f64 / refine;
        if (crossing.direction >> (2 - axis)) & 1 == 1 { low + crossing.share / refine } else { low }
    })
}

/// Half the sum of the principal curvatures of a level surface, with the normal against the gradient.
fn mean_curvature(gradient: [f64; 3], hessian: [[f64; 3]; 3]) -> f64 {
    let steepness = length(gradient);
    let trace = hessian[0][0] + hessian[1][1] + hessian[2][2];
    let along = dot(gradient, hessian.map(|row| dot(row, gradient)));
    let bending = -(steepness * steepness * trace - along) / (2.0 * maths::powi(steepness, 3));
    // A cusp has no normal, and so no meaningful curvature.
    if bending.is_finite() { bending } else { 0.0 }
}
