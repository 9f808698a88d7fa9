//! The motion of a flow as speeds of sub-volumes over time, which the sources of vortex sound follow (Dobashi et al.
//! 2004, §6).

use pyrophone_synthesis::vortex::{End, SpeedField};

use crate::error::Error;
use crate::solver::Solver;
use crate::velocity::Velocity;

/// Largest number of sub-volumes of a box.
const MOST_REGIONS: f64 = 160.0;

/// Smallest number of steps per second in a field, if the flow is known that often.
const RATE_HZ: f64 = 30.0;

/// Sub-volumes that never reach this share of the fastest one's speed are left out.
const STILL: f32 = 0.05;

/// Axis of the flow's world that points up; the others are right and front, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Up {
    /// Y, as in Houdini.
    Y,
    /// Z, as in the scenes and in Blender.
    #[default]
    Z,
}

/// A box of the world, divided into nearly cubic sub-volumes.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    low: [f64; 3],
    edges: [f64; 3],
    counts: [usize; 3],
    /// Samples along each edge of a sub-volume.
    samples: [usize; 3],
}

impl Regions {
    /// Divides the box from `low` to `high`, in m, whose flow is known at every `voxel` m. An empty box is a single
    /// point.
    pub fn new(low: [f64; 3], high: [f64; 3], voxel: f64) -> Self {
        let voxel = voxel.max(1e-9);
        let size: [f64; 3] = std::array::from_fn(|axis| (high[axis] - low[axis]).max(voxel));
        // The largest cubes of which no more than the allowed number fit: initially by volume, then refined downwards
        // only.
        let mut edge = maths::cbrt(size.iter().product::<f64>() / MOST_REGIONS).max(voxel);
        let cut = |edge: f64| size.map(|size| (size / edge).round().max(1.0) as usize);
        while cut(edge).iter().product::<usize>() as f64 > MOST_REGIONS {
            edge *= 1.02;
        }
        let counts = cut(edge);
        let edges: [f64; 3] = std::array::from_fn(|axis| size[axis] / counts[axis] as f64);
        Self { low, edges, counts, samples: edges.map(|edge| (edge / voxel).round().clamp(1.0, 64.0) as usize) }
    }

    /// Divides a solver's box.
    pub fn of_solver(solver: &Solver) -> Self {
        let domain = solver.domain();
        let (low, voxel) = (solver.origin_m(), domain.voxel_size_m());
        let high = std::array::from_fn(|axis| low[axis] + voxel * domain.shape()[axis] as f64);
        Self::new(low, high, voxel)
    }

    /// Number of sub-volumes.
    pub fn len(&self) -> usize {
        self.counts.iter().product()
    }

    /// Always false: there is at least one.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Mean speed in m/s of every sub-volume.
    pub fn mean_speeds(&self, velocity: &Velocity) -> Vec<f32> {
        let [nx, ny, nz] = self.samples;
        let share = 1.0 / (nx * ny * nz) as f64;
        let mean = |region: usize| {
            let corner = self.corner(region);
            let mut sum = 0.0;
            for (x, y, z) in (0..nx).flat_map(|x| (0..ny).flat_map(move |y| (0..nz).map(move |z| (x, y, z)))) {
                let at = [x, y, z];
                let position = std::array::from_fn(|axis| {
                    corner[axis] + self.edges[axis] * (at[axis] as f64 + 0.5) / self.samples[axis] as f64
                });
                sum += velocity.velocity_at(position).iter().map(|v| v * v).sum::<f64>().sqrt();
            }
            (share * sum) as f32
        };
        (0..self.len()).map(mean).collect()
    }

    fn corner(&self, region: usize) -> [f64; 3] {
        let [_, ny, nz] = self.counts;
        let index = [region / (ny * nz), region / nz % ny, region % nz];
        std::array::from_fn(|axis| self.low[axis] + self.edges[axis] * index[axis] as f64)
    }

    /// Centre of a sub-volume: to the right and to the front of the box's centre, and above its bottom.
    fn position(&self, region: usize, up: Up) -> [f32; 3] {
        let corner = self.corner(region);
        let middle = |axis: usize| self.low[axis] + 0.5 * self.edges[axis] * self.counts[axis] as f64;
        let beside = |axis: usize| (corner[axis] + 0.5 * self.edges[axis] - middle(axis)) as f32;
        let above = |axis: usize| (corner[axis] + 0.5 * self.edges[axis] - self.low[axis]) as f32;
        match up {
            // Rotated, not mirrored: with Y up, the front is at -Z.
            Up::Y => [beside(0), -beside(2), above(1)],
            Up::Z => [beside(0), beside(1), above(2)],
        }
    }

    /// Centres of all sub-volumes in m: to the right and to the front of the box's centre, and above its bottom.
    pub fn places(&self, up: Up) -> Vec<[f32; 3]> {
        (0..self.len()).map(|region| self.position(region, up)).collect()
    }

    /// The field of `steps`, each from [`mean_speeds`](Self::mean_speeds), at `rate_hz` steps per second.
    ///
    /// # Errors
    /// If there are no steps, if nothing moves, or if [`SpeedField::new`] rejects them.
    pub fn field(&self, steps: &[Vec<f32>], rate_hz: f64, up: Up, end: End) -> Result<SpeedField, Error> {
        let fastest = |region: usize| steps.iter().map(|step| step[region]).fold(0.0f32, f32::max);
        let fastest: Vec<f32> = (0..self.len()).map(fastest).collect();
        let top = fastest.iter().copied().fold(0.0f32, f32::max);
        if top <= 0.0 {
            return Err(Error::NoMotion);
        }
        let moving: Vec<usize> = (0..self.len()).filter(|region| fastest[*region] >= STILL * top).collect();
        let places = moving.iter().map(|region| self.position(*region, up)).collect();
        let speeds = steps.iter().flat_map(|step| moving.iter().map(|region| step[*region])).collect();
        Ok(SpeedField::new(rate_hz, moving.len(), places, speeds, end)?)
    }
}

/// Stride between stored steps, for a flow known `rate_hz` times per second.
pub fn stride(rate_hz: f64) -> u64 {
    (rate_hz / RATE_HZ).floor().max(1.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::{Grid, Transform};
    use crate::velocity::Placement;

    fn flow(shape: [usize; 3], speed: impl Fn([usize; 3]) -> f32) -> Velocity {
        let [nx, ny, nz] = shape;
        let values: Vec<[f32; 3]> = (0..nx * ny * nz)
            .map(|index| [0.0, speed([index / (ny * nz), index / nz % ny, index % nz]), 0.0])
            .collect();
        let transform = Transform::uniform(0.1, [0.05; 3]).unwrap();
        Velocity::Vectors(Grid::dense(shape, &values, transform).unwrap(), Placement::Collocated)
    }

    #[test]
    fn boxes_are_cut_into_cubes_or_nearly() {
        for high in [[1.0, 1.0, 1.0], [1.6, 1.6, 3.2], [0.2, 0.2, 9.0], [0.01, 0.01, 0.01]] {
            let regions = Regions::new([0.0; 3], high, 0.05);
            assert!((1..=160).contains(&regions.len()), "{high:?}: {}", regions.len());
            let [longest, shortest] = [f64::max, f64::min].map(|pick| regions.edges.into_iter().reduce(pick).unwrap());
            assert!(longest < 1.6 * shortest, "{high:?}: {:?}", regions.edges);
        }
        assert!(Regions::new([0.0; 3], [1.6, 1.6, 3.2], 0.05).len() > 80);
    }

    #[test]
    fn speeds_are_those_of_their_places() {
        // Gas moves in the upper half only, faster to the right.
        let speed = |[x, _, z]: [usize; 3]| if z >= 8 { 1.0 + x as f32 } else { 0.0 };
        let flow = flow([16, 16, 16], speed);
        let regions = Regions::new([0.0; 3], [1.6; 3], 0.1);
        let field = regions.field(&[regions.mean_speeds(&flow)], 30.0, Up::Z, End::Clamped).unwrap();
        assert!(field.sources() < regions.len(), "still gas is left out");
        for (position, found) in field.positions().iter().zip(field.speeds()) {
            assert!(position[2] > 0.6 && position[2] < 1.6 && position[0].abs() < 0.8);
            if position[2] > 1.0 && position[0].abs() < 0.5 {
                let expected = 1.0 + (position[0] + 0.8) / 0.1 - 0.5;
                assert!((found - expected).abs() < 0.5, "{position:?}: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn chosen_axis_points_up_in_the_field() {
        let speed = |[_, y, _]: [usize; 3]| if y >= 12 { 3.0 } else { 0.0 };
        let regions = Regions::new([0.0; 3], [1.6; 3], 0.1);
        let steps = [regions.mean_speeds(&flow([16, 16, 16], speed))];
        let lowest = |up: Up| {
            let field = regions.field(&steps, 30.0, up, End::Clamped).unwrap();
            field.positions().iter().map(|position| position[2]).fold(f32::MAX, f32::min)
        };
        assert!(lowest(Up::Y) > 0.8 && lowest(Up::Z) < 0.4);
    }

    #[test]
    fn still_gas_has_no_field() {
        let regions = Regions::new([0.0; 3], [1.6; 3], 0.1);
        let still = regions.mean_speeds(&flow([16, 16, 16], |_| 0.0));
        assert!(matches!(regions.field(&[still], 30.0, Up::Z, End::Clamped), Err(Error::NoMotion)));
        assert!(matches!(regions.field(&[], 30.0, Up::Z, End::Clamped), Err(Error::NoMotion)));
    }
}
