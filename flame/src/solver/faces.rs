//! Velocities on the faces of the cells (a MAC grid), where their divergence is exact.

use rayon::prelude::*;

use super::parallel::{elements, largest, planes, wide};

use super::domain::{Domain, Side, cell_index};

/// Velocity components in m/s, each on the faces across its own axis.
#[derive(Debug, Clone)]
pub(crate) struct Faces {
    pub components: [Vec<f32>; 3],
}

impl Faces {
    pub fn new(domain: &Domain) -> Self {
        let zeros = |axis| vec![0.0; domain.face_shape(axis).iter().product()];
        Self { components: [zeros(0), zeros(1), zeros(2)] }
    }

    /// Sets the velocities that walls and inflows prescribe, and makes the ends of periodic axes equal. `profile` gives
    /// an inflow's speed beyond its mean, in m/s, at the cell of a face.
    pub fn apply_sides(&mut self, domain: &Domain, profile: impl Fn(usize, usize, [usize; 3]) -> f32 + Sync) {
        for axis in 0..3 {
            let shape = domain.face_shape(axis);
            let last = shape[axis] - 1;
            for (end, side) in domain.sides()[axis].iter().enumerate() {
                let face = if end == 0 { 0 } else { last };
                for_each_on_plane(shape, axis, face, |position, index| match *side {
                    Side::Open => {}
                    Side::Wall => self.components[axis][index] = 0.0,
                    Side::Inflow(speed) => self.components[axis][index] = speed as f32 + profile(axis, end, position),
                    Side::Periodic => {
                        if end == 1 {
                            let mut first = position;
                            first[axis] = 0;
                            let first = cell_index(shape, first[0], first[1], first[2]);
                            self.components[axis][index] = self.components[axis][first];
                        }
                    }
                });
            }
        }
    }

    /// Velocities at the centres, for tracing and for everything that needs all components in one place.
    pub fn to_centres(&self, domain: &Domain, centres: &mut [[f32; 4]]) {
        let [_, ny, nz] = domain.shape();
        let shapes = [0, 1, 2].map(|axis| domain.face_shape(axis));
        let [u, v, w] = &self.components;
        planes(centres, ny * nz).enumerate().for_each(|(i, plane)| {
            wide(|| {
                for j in 0..ny {
                    let starts = [cell_index(shapes[0], i, j, 0), cell_index(shapes[0], i + 1, j, 0)];
                    let sides = [cell_index(shapes[1], i, j, 0), cell_index(shapes[1], i, j + 1, 0)];
                    let up = cell_index(shapes[2], i, j, 0);
                    for (k, centre) in plane[j * nz..(j + 1) * nz].iter_mut().enumerate() {
                        *centre = [
                            0.5 * (u[starts[0] + k] + u[starts[1] + k]),
                            0.5 * (v[sides[0] + k] + v[sides[1] + k]),
                            0.5 * (w[up + k] + w[up + k + 1]),
                            0.0,
                        ];
                    }
                }
            })
        });
    }

    /// Velocities at the centres of the cells from `cell` onwards along z.
    pub fn row_to_centres(&self, domain: &Domain, [i, j, k]: [usize; 3], centres: &mut [[f32; 3]]) {
        let [u, v, w] = &self.components;
        let shapes = [0, 1, 2].map(|axis| domain.face_shape(axis));
        let starts = [cell_index(shapes[0], i, j, k), cell_index(shapes[0], i + 1, j, k)];
        let sides = [cell_index(shapes[1], i, j, k), cell_index(shapes[1], i, j + 1, k)];
        let up = cell_index(shapes[2], i, j, k);
        for (n, centre) in centres.iter_mut().enumerate() {
            *centre = [
                0.5 * (u[starts[0] + n] + u[starts[1] + n]),
                0.5 * (v[sides[0] + n] + v[sides[1] + n]),
                0.5 * (w[up + n] + w[up + n + 1]),
            ];
        }
    }

    /// Adds an acceleration given at the centres, over `dt_s`.
    pub fn accelerate(&mut self, domain: &Domain, acceleration: &[[f32; 4]], dt_s: f32) {
        for (axis, component) in self.components.iter_mut().enumerate() {
            let [_, ny, nz] = domain.face_shape(axis);
            planes(component, ny * nz).enumerate().for_each(|(i, plane)| {
                wide(|| {
                    for (j, row) in plane.chunks_exact_mut(nz).enumerate() {
                        let cells = domain.face_row(axis, i, j);
                        for (k, value) in row.iter_mut().enumerate() {
                            let (before, after) = cells.cells(k);
                            *value += 0.5 * dt_s * (acceleration[before][axis] + acceleration[after][axis]);
                        }
                    }
                })
            });
        }
    }

    /// Divergence of the flow minus `source`, in 1/s per cell.
    pub fn divergence(&self, domain: &Domain, source: &[f32], divergence: &mut [f32]) {
        let [_, ny, nz] = domain.shape();
        let shapes = [0, 1, 2].map(|axis| domain.face_shape(axis));
        let scale = (1.0 / domain.voxel_size_m()) as f32;
        let [u, v, w] = &self.components;
        planes(divergence, ny * nz).zip(source.par_chunks(ny * nz)).enumerate().for_each(|(i, (plane, source))| {
            wide(|| {
                for j in 0..ny {
                    let x = [cell_index(shapes[0], i, j, 0), cell_index(shapes[0], i + 1, j, 0)];
                    let y = [cell_index(shapes[1], i, j, 0), cell_index(shapes[1], i, j + 1, 0)];
                    let z = cell_index(shapes[2], i, j, 0);
                    for k in 0..nz {
                        let leaving =
                            (u[x[1] + k] - u[x[0] + k]) + (v[y[1] + k] - v[y[0] + k]) + (w[z + k + 1] - w[z + k]);
                        plane[j * nz + k] = leaving * scale - source[j * nz + k];
                    }
                }
            })
        });
    }

    /// Subtracts the gradient of a potential from the flow; walls and inflows keep their prescribed velocities.
    pub fn subtract_gradient(&mut self, domain: &Domain, potential: &[f32]) {
        let scale = (1.0 / domain.voxel_size_m()) as f32;
        for (axis, component) in self.components.iter_mut().enumerate() {
            let shape = domain.face_shape(axis);
            let side_at = |face: usize| match face {
                0 => Some(domain.sides()[axis][0]),
                _ if face + 1 == shape[axis] => Some(domain.sides()[axis][1]),
                _ => None,
            };
            planes(component, shape[1] * shape[2]).enumerate().for_each(|(i, plane)| {
                wide(|| {
                    for (j, row) in plane.chunks_exact_mut(shape[2]).enumerate() {
                        let cells = domain.face_row(axis, i, j);
                        let row_side = if axis < 2 { side_at([i, j][axis]) } else { None };
                        for (k, value) in row.iter_mut().enumerate() {
                            let side = if axis == 2 { side_at(k) } else { row_side };
                            let (before, after) = cells.cells(k);
                            let (before, after) = (potential[before], potential[after]);
                            *value -= scale
                                * match side {
                                    None | Some(Side::Periodic) => after - before,
                                    Some(Side::Wall | Side::Inflow(_)) => 0.0,
                                    // The potential is zero on the face, half a cell away.
                                    Some(Side::Open) if [i, j, k][axis] == 0 => 2.0 * after,
                                    Some(Side::Open) => -2.0 * before,
                                };
                        }
                    }
                })
            });
        }
    }

    /// Largest speed of any component in m/s; infinite if a value is not a number.
    pub fn fastest(&self) -> f32 {
        self.components.iter().map(|values| largest(values)).fold(0.0, f32::max)
    }

    /// Limits every component to ±`most` m/s.
    pub fn limit(&mut self, most: f32) {
        for values in &mut self.components {
            elements(values).for_each(|value| *value = if value.is_nan() { 0.0 } else { value.clamp(-most, most) });
        }
    }
}

/// Calls `each` for all elements of an array of `shape` on one plane across `axis`.
fn for_each_on_plane(shape: [usize; 3], axis: usize, plane: usize, mut each: impl FnMut([usize; 3], usize)) {
    let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
    for a in 0..shape[one] {
        for b in 0..shape[other] {
            let mut position = [plane; 3];
            position[one] = a;
            position[other] = b;
            each(position, cell_index(shape, position[0], position[1], position[2]));
        }
    }
}
