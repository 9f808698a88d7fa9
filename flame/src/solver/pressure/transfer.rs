//! Transfer between a level and the next coarser one.

use rayon::prelude::*;

use crate::solver::parallel::{planes, wide};

use super::level::AxisBoundary;
use crate::solver::domain::cell_index;

/// Linear interpolation from cells of twice the edge, and its transpose.
#[derive(Debug)]
pub(super) struct Transfer {
    fine: [usize; 3],
    coarse: [usize; 3],
    /// For each axis and fine position: two coarse positions with their weights.
    up: [Vec<[(usize, f32); 2]>; 3],
    /// For each axis and coarse position: the fine positions that it affects, with the same weights.
    down: [Vec<Vec<(usize, f32)>>; 3],
}

impl Transfer {
    /// A transfer from `fine`, whose sizes are all even.
    pub fn new(fine: [usize; 3], ends: &[[AxisBoundary; 2]; 3]) -> Self {
        let coarse = fine.map(|size| size / 2);
        let up: [Vec<[(usize, f32); 2]>; 3] =
            std::array::from_fn(|axis| (0..fine[axis]).map(|i| taps(i, coarse[axis], ends[axis])).collect());
        let down = std::array::from_fn(|axis| {
            let mut reached = vec![vec![]; coarse[axis]];
            for (i, taps) in up[axis].iter().enumerate() {
                for (c, weight) in taps {
                    reached[*c].push((i, *weight));
                }
            }
            reached
        });
        Self { fine, coarse, up, down }
    }

    /// Adds the interpolated `coarse` field to `fine`.
    pub fn add_prolonged(&self, coarse: &[f32], fine: &mut [f32]) {
        let [_, ny, nz] = self.fine;
        planes(fine, ny * nz).zip(&self.up[0]).for_each(|(plane, along_x)| {
            wide(|| {
                for (row, along_y) in plane.chunks_exact_mut(nz).zip(&self.up[1]) {
                    for (x, weight_x) in along_x {
                        for (y, weight_y) in along_y {
                            let weight = weight_x * weight_y;
                            let start = cell_index(self.coarse, *x, *y, 0);
                            let source = &coarse[start..start + self.coarse[2]];
                            for (value, [(z0, w0), (z1, w1)]) in row.iter_mut().zip(&self.up[2]) {
                                *value += weight * (w0 * source[*z0] + w1 * source[*z1]);
                            }
                        }
                    }
                }
            })
        });
    }

    /// The weighted mean of `fine` around every coarse cell.
    pub fn restrict(&self, fine: &[f32], coarse: &mut [f32]) {
        let [_, cy, cz] = self.coarse;
        planes(coarse, cy * cz).zip(&self.down[0]).for_each(|(plane, along_x)| {
            wide(|| {
                plane.fill(0.0);
                for (row, along_y) in plane.chunks_exact_mut(cz).zip(&self.down[1]) {
                    for (x, weight_x) in along_x {
                        for (y, weight_y) in along_y {
                            // An eighth, because the transpose sums over eight times as many cells.
                            let weight = 0.125 * weight_x * weight_y;
                            let start = cell_index(self.fine, *x, *y, 0);
                            let source = &fine[start..start + self.fine[2]];
                            for (value, along_z) in row.iter_mut().zip(&self.down[2]) {
                                *value += weight * along_z.iter().map(|(z, w)| w * source[*z]).sum::<f32>();
                            }
                        }
                    }
                }
            })
        });
    }
}

/// The two coarse cells around fine cell `i`: its own, and the nearer neighbour.
fn taps(i: usize, size: usize, ends: [AxisBoundary; 2]) -> [(usize, f32); 2] {
    let own = i / 2;
    let upper = i % 2 == 1;
    let inside = if upper { own + 1 < size } else { own > 0 };
    let other = if inside {
        (if upper { own + 1 } else { own - 1 }, 0.25)
    } else {
        match ends[usize::from(upper)] {
            AxisBoundary::Zero => (own, -0.25),
            AxisBoundary::Flat => (own, 0.25),
            AxisBoundary::Wrapped => (if upper { 0 } else { size - 1 }, 0.25),
        }
    };
    [(own, 0.75), other]
}
