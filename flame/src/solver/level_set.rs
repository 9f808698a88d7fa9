//! The front of a blue core: a level set that moves into the unburnt gas and remains a distance.

use rayon::prelude::*;

use super::parallel::{planes, rows, wide};

use super::combustion::{FUEL, Fire};
use super::domain::{Domain, cell_index};
use super::lattice::Lattice;

/// Cells from the front beyond which distances are cut off.
pub(crate) const BAND_CELLS: f32 = 6.0;

/// Steps towards a distance field after each time step; half a cell each, enough to keep the front's surroundings
/// correct.
const REDISTANCING_STEPS: usize = 3;

/// Working memory.
#[derive(Debug, Default)]
pub(crate) struct LevelSet {
    before: Vec<f32>,
    sign: Vec<f32>,
}

impl LevelSet {
    /// Moves the front into the unburnt gas by `flame_speed_m_s` times the step and the local mixing rate (Nguyen,
    /// Fedkiw & Jensen 2002, eq. 4; the flow's part is advection), then restores the distances (Sussman, Smereka &
    /// Osher 1994).
    pub fn advance(&mut self, fire: &Fire, flame_speed_m_s: f64, scalars: &mut [[f32; 4]]) {
        let domain = fire.domain;
        let voxel_size = domain.voxel_size_m() as f32;
        let most = BAND_CELLS * voxel_size;
        let lattice = Lattice::centres(domain);
        let eaten = (flame_speed_m_s * fire.dt_s) as f32;
        self.store(scalars);
        let before = self.before.as_slice();
        each(domain, scalars, |cell, index| {
            let distance = before[index];
            // Within the gas the steeper side counts: at the centre of a remnant one side is flat, and a wisp would
            // burn for ever.
            let outer = slope(before, &lattice, voxel_size, cell, 1.0);
            let steepness =
                if distance < 0.0 { outer.max(slope(before, &lattice, voxel_size, cell, -1.0)) } else { outer };
            if steepness == 0.0 {
                return distance.clamp(-most, most);
            }
            (distance + eaten * fire.mixing.factor(fire.place_m(cell)) * steepness).clamp(-most, most)
        });
        self.sign.clear();
        self.sign.extend(scalars.iter().map(|scalar| {
            let distance = scalar[FUEL];
            distance / (distance * distance + voxel_size * voxel_size).sqrt()
        }));
        for _ in 0..REDISTANCING_STEPS {
            self.store(scalars);
            let (before, sign) = (self.before.as_slice(), self.sign.as_slice());
            each(domain, scalars, |cell, index| {
                // Next to the front, this would shift the front itself.
                if is_beside_front(before, &lattice, cell) {
                    return before[index];
                }
                let excess = slope(before, &lattice, voxel_size, cell, sign[index]) - 1.0;
                (before[index] - 0.5 * voxel_size * sign[index] * excess).clamp(-most, most)
            });
        }
    }

    fn store(&mut self, scalars: &[[f32; 4]]) {
        self.before.clear();
        self.before.extend(scalars.iter().map(|scalar| scalar[FUEL]));
    }
}

/// Sets every cell's level set.
fn each(domain: &Domain, scalars: &mut [[f32; 4]], value: impl Fn([usize; 3], usize) -> f32 + Sync) {
    let [_, ny, nz] = domain.shape();
    planes(scalars, ny * nz).enumerate().for_each(|(i, plane)| {
        wide(|| {
            for ([j, k], scalar) in rows(plane, nz) {
                scalar[FUEL] = value([i, j, k], (i * ny + j) * nz + k);
            }
        })
    });
}

/// True if the front lies between a cell and one of its neighbours.
fn is_beside_front(distance: &[f32], lattice: &Lattice, cell: [usize; 3]) -> bool {
    let is_unburnt = |[i, j, k]: [usize; 3]| distance[cell_index(lattice.shape, i, j, k)] < 0.0;
    let here = is_unburnt(cell);
    (0..3).any(|axis| {
        [false, true].into_iter().any(|upper| {
            let mut beside = cell;
            beside[axis] = lattice.beside(axis, cell[axis], upper);
            is_unburnt(beside) != here
        })
    })
}

/// Magnitude of the gradient, taken from the upwind side (Godunov) of a front that moves towards growing distance
/// (`direction` positive) or falling distance.
#[inline(always)]
fn slope(distance: &[f32], lattice: &Lattice, voxel_size: f32, cell: [usize; 3], direction: f32) -> f32 {
    let value = |[i, j, k]: [usize; 3]| distance[cell_index(lattice.shape, i, j, k)];
    let here = value(cell);
    let mut square = 0.0;
    for axis in 0..3 {
        let beside = |upper: bool| {
            let mut beside = cell;
            beside[axis] = lattice.beside(axis, cell[axis], upper);
            value(beside)
        };
        let (rising, falling) = (here - beside(false), beside(true) - here);
        let (a, b) =
            if direction > 0.0 { (rising.max(0.0), falling.min(0.0)) } else { (rising.min(0.0), falling.max(0.0)) };
        square += (a * a).max(b * b);
    }
    square.sqrt() / voxel_size
}
