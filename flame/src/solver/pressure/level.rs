//! One level of the multigrid: the operator and its smoother.

use rayon::prelude::*;

use crate::solver::parallel::{elements, planes, wide};

use crate::solver::domain::cell_index;

/// Boundary condition of the pressure at one end of an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum AxisBoundary {
    /// Zero on the face.
    Zero,
    /// No gradient across the face.
    Flat,
    /// Periodic: continues at the other end.
    Wrapped,
}

/// Smoothing steps before and after the coarser level.
const STEPS: usize = 3;

/// Smoothing steps that replace a solution on the coarsest level.
const STEPS_ON_COARSEST: usize = 60;

/// Part of the operator's spectrum (scaled by its diagonal, at most 2) that smoothing must damp: in three dimensions,
/// the part that a coarser level cannot represent begins at a third.
const DAMPED: std::ops::RangeInclusive<f64> = 1.0 / 3.0..=2.0;

/// Lower end of the spectrum damped on the coarsest level.
const DAMPED_ON_COARSEST: f64 = 0.01;

/// Negative Laplacian of second order on a box of cells.
#[derive(Debug)]
pub(super) struct Level {
    shape: [usize; 3],
    voxel_size_m: f64,
    ends: [[AxisBoundary; 2]; 3],
    /// 1 / h².
    scale: f32,
}

impl Level {
    pub fn new(shape: [usize; 3], voxel_size_m: f64, ends: [[AxisBoundary; 2]; 3]) -> Self {
        Self { shape, voxel_size_m, ends, scale: (1.0 / (voxel_size_m * voxel_size_m)) as f32 }
    }

    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    pub fn voxel_size_m(&self) -> f64 {
        self.voxel_size_m
    }

    pub fn cells(&self) -> usize {
        self.shape.iter().product()
    }

    /// `image` = negative Laplacian of `field`.
    pub fn apply(&self, field: &[f32], image: &mut [f32]) {
        let scale = self.scale;
        self.visit(field, image, |_, row, _| row.iter_mut().for_each(|value| *value *= scale));
    }

    /// Smooths `solution` from zero, ignoring its contents; `step` and `image` are working memory.
    pub fn smooth_from_zero(&self, right: &[f32], solution: &mut [f32], step: &mut [f32], image: &mut [f32]) {
        self.chebyshev_from_zero(right, solution, step, image, STEPS, *DAMPED.start());
    }

    /// Smooths `solution` from its present values.
    pub fn smooth(&self, right: &[f32], solution: &mut [f32], step: &mut [f32], image: &mut [f32]) {
        self.chebyshev(right, solution, step, image, 0..STEPS, *DAMPED.start());
    }

    /// Approximate solution for the coarsest level.
    pub fn solve_small(&self, right: &[f32], solution: &mut [f32], step: &mut [f32], image: &mut [f32]) {
        self.chebyshev_from_zero(right, solution, step, image, STEPS_ON_COARSEST, DAMPED_ON_COARSEST);
    }

    /// The iteration from zero, whose first step needs no neighbours.
    fn chebyshev_from_zero(
        &self,
        right: &[f32],
        solution: &mut [f32],
        step: &mut [f32],
        image: &mut [f32],
        steps: usize,
        lowest: f64,
    ) {
        let add = (1.0 / (0.5 * (DAMPED.end() + lowest))) as f32;
        let [_, ny, nz] = self.shape;
        let cells = planes(solution, ny * nz).zip(planes(step, ny * nz)).zip(right.par_chunks(ny * nz));
        cells.enumerate().for_each(|(i, ((solution, step), right))| {
            wide(|| {
                for j in 0..ny {
                    let row = j * nz..(j + 1) * nz;
                    let (solution, step, right) = (&mut solution[row.clone()], &mut step[row.clone()], &right[row]);
                    let across = self.own(0, i) + self.own(1, j);
                    let diagonal = |k: usize| across + self.own(2, k);
                    let (inner, edges) = (across + 2.0, [diagonal(0), diagonal(nz - 1)]);
                    for k in 0..nz {
                        step[k] = add * right[k] / (inner * self.scale);
                    }
                    for (k, diagonal) in [0, nz - 1].into_iter().zip(edges) {
                        step[k] = add * right[k] / (diagonal * self.scale);
                    }
                    solution.copy_from_slice(step);
                }
            })
        });
        self.chebyshev(right, solution, step, image, 1..steps, lowest);
    }

    /// Contribution of a cell's two neighbours along an axis to the operator's diagonal.
    fn own(&self, axis: usize, position: usize) -> f32 {
        let one = |upper: bool| {
            neighbour(position, self.shape[axis], upper, self.ends[axis]).map_or_else(|extra| extra, |_| 1.0)
        };
        one(false) + one(true)
    }

    /// Chebyshev's iteration on the operator scaled by its diagonal (Saad, *Iterative Methods for Sparse Linear
    /// Systems*, algorithm 12.1). It is a polynomial in the operator, and therefore symmetric, as conjugate gradients
    /// require.
    fn chebyshev(
        &self,
        right: &[f32],
        solution: &mut [f32],
        step: &mut [f32],
        image: &mut [f32],
        steps: std::ops::Range<usize>,
        lowest: f64,
    ) {
        let (middle, half) = (0.5 * (DAMPED.end() + lowest), 0.5 * (DAMPED.end() - lowest));
        let ratio = middle / half;
        let mut rho = 1.0 / ratio;
        for index in 0..steps.end {
            let (keep, add) = if index == 0 {
                (0.0, 1.0 / middle)
            } else {
                let next = 1.0 / (2.0 * ratio - rho);
                let factors = (next * rho, 2.0 * next / half);
                rho = next;
                factors
            };
            if index < steps.start {
                continue;
            }
            let (keep, add, scale) = (keep as f32, add as f32, self.scale);
            // image = the new step, stored separately from the solution that is read.
            self.visit(solution, image, |start, row, [first, inner, last]| {
                let cells = start..start + row.len();
                let (step, right) = (&step[cells.clone()], &right[cells]);
                let stepped = |k: usize, sum: f32, diagonal: f32| {
                    keep * step[k] + add * (right[k] - sum * scale) / (diagonal * scale)
                };
                let end = row.len() - 1;
                let ends = [stepped(0, row[0], first), stepped(end, row[end], last)];
                for (k, value) in row.iter_mut().enumerate() {
                    *value = stepped(k, *value, inner);
                }
                (row[0], row[end]) = (ends[0], ends[1]);
            });
            elements(solution).zip(elements(step)).zip(&*image).for_each(|((solution, step), image)| {
                *step = *image;
                *solution += *image;
            });
        }
    }

    /// Puts the sum of every cell's differences to its neighbours into `image`, and calls `each` for every row of it
    /// with the index of its first cell and the operator's diagonal (both still without 1/h²) for the first cell, the
    /// inner cells and the last.
    fn visit(&self, field: &[f32], image: &mut [f32], each: impl Fn(usize, &mut [f32], [f32; 3]) + Sync) {
        let [nx, ny, nz] = self.shape;
        let plane = ny * nz;
        planes(image, plane).enumerate().for_each(|(i, image)| {
            wide(|| {
                for j in 0..ny {
                    let row = cell_index(self.shape, i, j, 0);
                    let centre = &field[row..row + nz];
                    // Contributions of the four neighbouring rows: each row with its weight, and this cell's own
                    // weight.
                    let mut own = 0.0f32;
                    let mut rows: [&[f32]; 4] = [centre; 4];
                    let mut weights = [0.0f32; 4];
                    for (slot, axis, upper) in [(0, 0, false), (1, 0, true), (2, 1, false), (3, 1, true)] {
                        let (position, size) = if axis == 0 { (i, nx) } else { (j, ny) };
                        match neighbour(position, size, upper, self.ends[axis]) {
                            Ok(other) => {
                                let start = if axis == 0 {
                                    cell_index(self.shape, other, j, 0)
                                } else {
                                    cell_index(self.shape, i, other, 0)
                                };
                                rows[slot] = &field[start..start + nz];
                                weights[slot] = 1.0;
                                own += 1.0;
                            }
                            Err(extra) => own += extra,
                        }
                    }
                    let out = &mut image[j * nz..(j + 1) * nz];
                    let across = |k: usize| {
                        weights[0] * rows[0][k]
                            + weights[1] * rows[1][k]
                            + weights[2] * rows[2][k]
                            + weights[3] * rows[3][k]
                    };
                    let edge = |k: usize| {
                        let (mut diagonal, mut sum) = (own, across(k));
                        for upper in [false, true] {
                            match neighbour(k, nz, upper, self.ends[2]) {
                                Ok(other) => {
                                    diagonal += 1.0;
                                    sum += centre[other];
                                }
                                Err(extra) => diagonal += extra,
                            }
                        }
                        (diagonal * centre[k] - sum, diagonal)
                    };
                    let [first, last] = [0, nz - 1].map(edge);
                    let inner = own + 2.0;
                    let (centre, [a, b, c, d]) = (&centre[..nz], rows.map(|row| &row[..nz]));
                    for k in 1..nz - 1 {
                        let across = weights[0] * a[k] + weights[1] * b[k] + weights[2] * c[k] + weights[3] * d[k];
                        out[k] = inner * centre[k] - (across + centre[k - 1] + centre[k + 1]);
                    }
                    (out[0], out[nz - 1]) = (first.0, last.0);
                    each(row, out, [first.1, inner, last.1]);
                }
            })
        });
    }
}

/// The neighbour's position, or, at an end without one, the end's contribution to the diagonal.
fn neighbour(position: usize, size: usize, upper: bool, ends: [AxisBoundary; 2]) -> Result<usize, f32> {
    match (upper, position) {
        (false, 1..) => Ok(position - 1),
        (true, _) if position + 1 < size => Ok(position + 1),
        _ => match ends[usize::from(upper)] {
            AxisBoundary::Zero => Err(2.0),
            AxisBoundary::Flat => Err(0.0),
            AxisBoundary::Wrapped => Ok(if upper { 0 } else { size - 1 }),
        },
    }
}
