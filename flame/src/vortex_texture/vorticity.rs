//! The curl of the flow in the box.

use crate::solver::{Domain, Solver};

/// Vorticity in 1/s at the voxels' centres, z fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Vorticity {
    shape: [usize; 3],
    values: Vec<[f64; 3]>,
}

impl Vorticity {
    /// Vorticity of a solver's flow: the circulation around the faces' edges, with each centre taking the mean of the
    /// four edges around it. Around an edge, the pressure gradient adds up to nothing, so the residual of the pressure
    /// solve is not included.
    pub fn of_solver(solver: &Solver) -> Self {
        let (domain, faces) = (solver.domain(), solver.face_velocities());
        let curls: [Vec<f32>; 3] = std::array::from_fn(|axis| edges(domain, &faces, axis));
        let shape = domain.shape();
        let value = |place: [usize; 3]| {
            std::array::from_fn(|axis| {
                let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
                // Edges on an open side or in an inflow have no curl.
                let ends = |other: usize| {
                    let (first, last) = (place[other], place[other] + 1);
                    let whole = domain.is_periodic(other);
                    let lower = if first == 0 && !whole { last } else { first };
                    let upper = if last == shape[other] && !whole { first } else { last };
                    [lower, upper]
                };
                let mut sum = 0.0;
                for i in ends(a) {
                    for j in ends(b) {
                        let mut edge = place;
                        (edge[a], edge[b]) = (i, j);
                        sum += f64::from(curls[axis][voxel_index(edge_shape(shape, axis), edge)]);
                    }
                }
                0.25 * sum
            })
        };
        Self { shape, values: places(shape).map(value).collect() }
    }

    /// A field of `shape` voxels of edge `voxel_size_m`; `value` gives it in 1/s at a position in m from the box's
    /// centre.
    pub fn from_fn(shape: [usize; 3], voxel_size_m: f64, value: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        let place = |voxel| value(from_centre(shape, voxel_size_m, voxel));
        Self { shape, values: places(shape).map(place).collect() }
    }

    /// Voxels along x, y, z.
    pub fn shape(&self) -> [usize; 3] {
        self.shape
    }

    /// Vectors in 1/s, z fastest.
    pub fn values(&self) -> &[[f64; 3]] {
        &self.values
    }
}

/// Curl along `axis` on the edges along it, in 1/s; zero on those that lie on a side that is not periodic.
fn edges(domain: &Domain, faces: &[&[f32]; 3], axis: usize) -> Vec<f32> {
    let (a, b) = ((axis + 1) % 3, (axis + 2) % 3);
    let shape = domain.shape();
    let scale = (1.0 / domain.voxel_size_m()) as f32;
    // Difference of a component between the two sides of the edge.
    let rise = |component: usize, across: usize, edge: [usize; 3]| {
        let of = domain.face_shape(component);
        let beside = |position: usize| {
            let mut place = edge;
            place[across] = position % shape[across];
            faces[component][voxel_index(of, place)]
        };
        beside(edge[across]) - beside(edge[across] + shape[across] - 1)
    };
    let is_outer = |edge: [usize; 3]| {
        [a, b].iter().any(|&other| !domain.is_periodic(other) && (edge[other] == 0 || edge[other] == shape[other]))
    };
    let curl = |edge| if is_outer(edge) { 0.0 } else { scale * (rise(b, a, edge) - rise(a, b, edge)) };
    places(edge_shape(shape, axis)).map(curl).collect()
}

/// Shape of the edges along `axis`: as many as cells along it, one more across it.
fn edge_shape(shape: [usize; 3], axis: usize) -> [usize; 3] {
    std::array::from_fn(|other| if other == axis { shape[other] } else { shape[other] + 1 })
}

fn voxel_index(shape: [usize; 3], [i, j, k]: [usize; 3]) -> usize {
    (i * shape[1] + j) * shape[2] + k
}

/// All positions of an array, z fastest.
pub(super) fn places([nx, ny, nz]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..nx).flat_map(move |i| (0..ny).flat_map(move |j| (0..nz).map(move |k| [i, j, k])))
}

/// Position of a voxel's centre relative to the box's, in m.
pub(super) fn from_centre(shape: [usize; 3], voxel_size_m: f64, voxel: [usize; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| (voxel[axis] as f64 + 0.5 - 0.5 * shape[axis] as f64) * voxel_size_m)
}
