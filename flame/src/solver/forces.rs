//! Forces on the gas: buoyancy, vorticity confinement, turbulence.

use rayon::prelude::*;

use super::parallel::{planes, rows, wide};

use super::activity::{Activity, SEGMENT};
use super::combustion::{Combustion, SMOKE, TEMPERATURE};
use super::domain::{Domain, cell_index};
use super::lattice::Lattice;
use super::parameters::Parameters;
use super::turbulence::Turbulence;

/// Working memory for the vorticity.
#[derive(Debug, Default)]
pub(crate) struct Forces {
    /// Vorticity in 1/s, and its magnitude.
    vorticity: Vec<[f32; 4]>,
}

/// Fields at the cells' centres that the forces depend on.
pub(crate) struct Gas<'a> {
    pub velocity: &'a [[f32; 4]],
    pub scalars: &'a [[f32; 4]],
    /// If present, no force acts outside it.
    pub activity: Option<&'a Activity>,
    pub turbulence: &'a Turbulence,
    pub time_s: f64,
}

impl Gas<'_> {
    #[inline(always)]
    fn is_idle(&self, i: usize, j: usize, k: usize) -> bool {
        self.activity.is_some_and(|activity| !activity.row(i, j)[k / SEGMENT])
    }
}

impl Forces {
    /// Acceleration in m/s² at every centre, into `acceleration`.
    pub fn evaluate(&mut self, domain: &Domain, parameters: &Parameters, gas: &Gas, acceleration: &mut [[f32; 4]]) {
        let shape = domain.shape();
        let [_, ny, nz] = shape;
        let voxel_size = domain.voxel_size_m() as f32;
        let confinement = parameters.confinement as f32;
        self.vorticity.resize(domain.cells(), [0.0; 4]);
        if confinement != 0.0 {
            self.curl(domain, gas);
        }
        let buoyancy = parameters.buoyancy_m_s2 as f32;
        // A blue core is wrinkled from within, where it is still cold.
        let stirred_by = match parameters.combustion {
            Some(Combustion::BlueCore { .. }) => SMOKE,
            _ => TEMPERATURE,
        };
        let burns = parameters.combustion.is_some();
        let stirring = parameters.turbulence_m_s2 as f32;
        let eddies = (1.0 / parameters.turbulence_scale_m) as f32;
        let turnovers = (gas.time_s * parameters.turbulence_rate_hz) as f32;
        let first = parameters.turbulence_origin_m.map(|place| place as f32);
        let vorticity = self.vorticity.as_slice();
        let lattice = Lattice::centres(domain);
        planes(acceleration, ny * nz).enumerate().for_each(|(i, plane)| {
            wide(|| {
                let mut around = Around::new(&lattice, i, 0);
                for ([j, k], out) in rows(plane, nz) {
                    if k == 0 {
                        around = Around::new(&lattice, i, j);
                    }
                    if gas.is_idle(i, j, k) {
                        *out = [0.0; 4];
                        continue;
                    }
                    let temperature = gas.scalars[cell_index(shape, i, j, k)][TEMPERATURE];
                    let mut sum = [0.0, 0.0, buoyancy * temperature, 0.0];
                    if confinement != 0.0 {
                        let force = confine(vorticity, &around, k);
                        // Only a flame's own eddies are sustained, not every rotation in the air around it.
                        let share = if burns {
                            gas.scalars[cell_index(shape, i, j, k)][stirred_by].clamp(0.0, 1.0)
                        } else {
                            1.0
                        };
                        for axis in 0..3 {
                            sum[axis] += share * confinement * voxel_size * force[axis];
                        }
                    }
                    let stirred = stirring * gas.scalars[cell_index(shape, i, j, k)][stirred_by].clamp(0.0, 1.0);
                    if stirred > 1e-3 * stirring {
                        let cell = [i, j, k].map(|cell| cell as f32 * voxel_size);
                        let place = std::array::from_fn(|axis| (cell[axis] + first[axis]) * eddies);
                        let noise = gas.turbulence.velocity_at(place, turnovers);
                        for axis in 0..3 {
                            sum[axis] += stirred * noise[axis];
                        }
                    }
                    *out = sum;
                }
            })
        });
    }

    fn curl(&mut self, domain: &Domain, gas: &Gas) {
        let velocity = gas.velocity;
        let lattice = &Lattice::centres(domain);
        let [_, ny, nz] = lattice.shape;
        let scale = (0.5 / domain.voxel_size_m()) as f32;
        planes(&mut self.vorticity, ny * nz).enumerate().for_each(|(i, plane)| {
            wide(|| {
                let mut around = Around::new(lattice, i, 0);
                for ([j, k], out) in rows(plane, nz) {
                    if k == 0 {
                        around = Around::new(lattice, i, j);
                    }
                    if gas.is_idle(i, j, k) {
                        *out = [0.0; 4];
                        continue;
                    }
                    let slope = |axis: usize| {
                        let (before, after) = around.neighbours(axis, k);
                        let (before, after) = (velocity[before], velocity[after]);
                        [0, 1, 2].map(|n: usize| (after[n] - before[n]) * scale)
                    };
                    let [dx, dy, dz] = [slope(0), slope(1), slope(2)];
                    let curl = [dy[2] - dz[1], dz[0] - dx[2], dx[1] - dy[0]];
                    let magnitude = (curl[0] * curl[0] + curl[1] * curl[1] + curl[2] * curl[2]).sqrt();
                    *out = [curl[0], curl[1], curl[2], magnitude];
                }
            })
        });
    }
}

/// N × w, with N the direction in which vorticity w grows (Fedkiw, Stam & Jensen 2001, eq. 10-11).
fn confine(vorticity: &[[f32; 4]], around: &Around, k: usize) -> [f32; 3] {
    let slope: [f32; 3] = std::array::from_fn(|axis| {
        let (before, after) = around.neighbours(axis, k);
        vorticity[after][3] - vorticity[before][3]
    });
    let steepness = (slope[0] * slope[0] + slope[1] * slope[1] + slope[2] * slope[2]).sqrt();
    let w = vorticity[around.row + k];
    // Without rotation there is no direction to divide by.
    if steepness < 1e-6 {
        return [0.0; 3];
    }
    let n = slope.map(|s| s / steepness);
    [n[1] * w[2] - n[2] * w[1], n[2] * w[0] - n[0] * w[2], n[0] * w[1] - n[1] * w[0]]
}

/// The rows of cells around a row, looked up once for all its cells.
struct Around<'a> {
    lattice: &'a Lattice,
    row: usize,
    /// Starts of the rows before and after it, along x and y.
    beside: [[usize; 2]; 2],
}

impl<'a> Around<'a> {
    #[inline(always)]
    fn new(lattice: &'a Lattice, i: usize, j: usize) -> Self {
        let start = |i: usize, j: usize| cell_index(lattice.shape, i, j, 0);
        let beside = [
            [false, true].map(|upper| start(lattice.beside(0, i, upper), j)),
            [false, true].map(|upper| start(i, lattice.beside(1, j, upper))),
        ];
        Self { lattice, row: start(i, j), beside }
    }

    /// Indices of the cells before and after cell k; at an end of the box, the cell itself replaces a missing one.
    #[inline(always)]
    fn neighbours(&self, axis: usize, k: usize) -> (usize, usize) {
        match self.beside.get(axis) {
            Some([before, after]) => (before + k, after + k),
            None => {
                let beside = |upper: bool| self.row + self.lattice.beside(axis, k, upper);
                (beside(false), beside(true))
            }
        }
    }
}
