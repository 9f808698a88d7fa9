//! Flux through the flame front, its area and its curvature (Chadwick & James 2011, §3).

use super::cells;
use super::spline::{Lattice, Patch};
use super::tetrahedra::{Crossing, march};
use crate::error::{Error, in_range};
use crate::frame::Frame;
use crate::grid::{Grid, cross, dot, length};

/// The surface on which a smoothed field equals `iso`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Front {
    iso: f64,
    refine: usize,
}

/// What a flame front measures at one step, in world units.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Measure {
    /// Velocity flux through the front, volume per second; positive where the flame expands.
    pub flux: f64,
    /// The front's area.
    pub area: f64,
    /// Mean over the area of the mean curvature, per unit of length; positive for a ball of flame. 0 where there is no
    /// front.
    pub mean_curvature: f64,
    /// Triangles that the front was made of.
    pub triangles: u64,
}

/// What is left of all that passes the front, in and out, where as much goes in as comes out. It is nothing, and must not
/// be taken for something small: scaled to a peak it would be heard as noise.
const ROUNDING: f64 = 1e-9;

/// A triangle of the front.
pub(super) struct Triangle {
    /// Its corners, as places on the lattice: cell times `refine`, plus steps.
    pub corners: [([i64; 3], usize); 3],
    /// Its corners' indices.
    pub indices: [[f64; 3]; 3],
    /// Its centre as fractions of its cell.
    pub within: [f64; 3],
}

impl Front {
    /// The surface at `iso` (-1e9 to 1e9), each cell between voxels cut in `refine` (1-16) along each edge. 3 is near
    /// enough for sound: errors fall with the square of `refine`, work grows with it or faster.
    pub fn new(iso: f64, refine: usize) -> Result<Self, Error> {
        in_range("the iso value", iso, -1e9, 1e9)?;
        in_range("the refinement", refine as f64, 1.0, 16.0)?;
        Ok(Self { iso, refine })
    }

    /// The value at the front.
    pub fn iso(&self) -> f64 {
        self.iso
    }

    /// Flux, area and curvature of one step; zeros where there is no surface. The same frame gives the same numbers, bit
    /// for bit.
    ///
    /// Fails where the flame has no bounds (the field's background burns), where a value is not finite, and where the
    /// field's tiles are too large to be meant.
    pub fn measure(&self, frame: &Frame) -> Result<Measure, Error> {
        if !frame.velocity.is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let transform = frame.field.transform();
        let mirrored = if transform.is_mirrored() { -1.0 } else { 1.0 };
        let mut sum = Measure::default();
        let (mut bending, mut passing) = (0.0, 0.0);
        self.walk(&frame.field, |triangle, patch| {
            let [a, b, c] = triangle.indices.map(|index| transform.to_world(index));
            let (ab, ac): ([f64; 3], [f64; 3]) =
                (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
            let surface = cross(ab, ac).map(|part| 0.5 * mirrored * part);
            let area = length(surface);
            let centre = std::array::from_fn(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
            let flux = dot(frame.velocity.at(centre), surface);
            sum.flux += flux;
            passing += flux.abs();
            sum.area += area;
            sum.triangles += 1;
            let (gradient, hessian) = patch.derivatives(triangle.within);
            let hessian = hessian.map(|row| transform.gradient_to_world(row));
            let columns = std::array::from_fn(|i| transform.gradient_to_world(hessian.map(|row| row[i])));
            bending += area * mean_curvature(transform.gradient_to_world(gradient), columns);
        })?;
        if sum.flux.abs() <= ROUNDING * passing {
            sum.flux = 0.0;
        }
        if sum.area > 0.0 {
            sum.mean_curvature = bending / sum.area;
        }
        let finite = [sum.flux, sum.area, sum.mean_curvature].iter().all(|value| value.is_finite());
        if finite { Ok(sum) } else { Err(Error::NotFinite { what: "flux" }) }
    }

    /// Hands over every triangle with the spline of its cell, in an order that depends on the field alone. Triangles
    /// turn counter-clockwise as seen from outside, in index space.
    pub(super) fn walk(&self, field: &Grid<1>, mut visit: impl FnMut(&Triangle, &Patch)) -> Result<(), Error> {
        if !field.is_finite() {
            return Err(Error::NotFinite { what: "field" });
        }
        // Rounding must not make surface where the field rests on the iso value: such a plateau does not burn. Voxels
        // are `f32` and cannot lie on the level itself.
        let level = self.iso + self.iso.abs() * 2f64.powi(-30);
        let background = f64::from(field.background()[0]);
        if background > level {
            return Err(Error::Unbounded { background, iso: self.iso });
        }
        let refine = self.refine as f64;
        let mut lattice = Lattice::new(self.refine);
        cells::visit(field, level, |cell, patch| {
            lattice.sample(patch);
            march(&lattice.values, self.refine, level, |crossings| {
                let indices = crossings.map(|crossing| index(cell, &crossing, refine));
                let within = std::array::from_fn(|axis| {
                    indices.iter().map(|index| index[axis] - f64::from(cell[axis])).sum::<f64>() / 3.0
                });
                let corners = crossings.map(|Crossing { low, direction, .. }| {
                    let place = |axis: usize| i64::from(cell[axis]) * self.refine as i64 + low[axis] as i64;
                    (std::array::from_fn(place), direction)
                });
                visit(&Triangle { corners, indices, within }, patch);
            });
        })
    }
}

/// Index at which an edge is crossed; the same, bit for bit, from all cells at the edge.
fn index(cell: [i32; 3], crossing: &Crossing, refine: f64) -> [f64; 3] {
    std::array::from_fn(|axis| {
        let low = f64::from(cell[axis]) + crossing.low[axis] as f64 / refine;
        if (crossing.direction >> (2 - axis)) & 1 == 1 { low + crossing.share / refine } else { low }
    })
}

/// Half the sum of the principal curvatures of a level surface, the normal against the gradient.
fn mean_curvature(gradient: [f64; 3], hessian: [[f64; 3]; 3]) -> f64 {
    let steepness = length(gradient);
    let trace = hessian[0][0] + hessian[1][1] + hessian[2][2];
    let along = dot(gradient, hessian.map(|row| dot(row, gradient)));
    let bending = -(steepness * steepness * trace - along) / (2.0 * steepness.powi(3));
    // At a cusp there is no normal, and no curvature to speak of.
    if bending.is_finite() { bending } else { 0.0 }
}
