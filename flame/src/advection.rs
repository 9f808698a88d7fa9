//! A check of a flow's rate and unit: does the flow carry what it should?
//!
//! Smoke goes where the gas goes. If moving a frame's smoke by `factor · velocity · time` matches the next frame best
//! at a factor far from one, then either the frames are not as far apart in time as stated, or the velocity is not in
//! world units per second. The flame itself does not move with its gas and reveals nothing.

use crate::grid::{BLOCK, BLOCK_VOXELS, Grid, Region};
use crate::velocity::{Velocity, trilinear};

/// Largest numbers of blocks and of voxels examined.
const MOST_BLOCKS: usize = 200;
const MOST_VOXELS: usize = 20_000;

/// Factors tried: powers of the square root of two, with exponents up to this in either direction.
const MOST_STEPS: i32 = 14;

/// Values above this share of the largest count as smoke.
const LEAST_SHARE: f32 = 0.02;

/// The factor at which a flow carries a field best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    /// Factor for the velocity.
    pub factor: f64,
    /// Share of the field's change that remains unexplained with it, 0-1.
    pub left: f64,
    /// The same share at a factor of one; above 1 if moving the field is worse than leaving it in place.
    pub left_at_one: f64,
}

impl Fit {
    /// True if the factor is so far from one, and so much better, that rate and unit cannot both be right.
    pub fn is_wrong(&self) -> bool {
        let is_far = !(0.6..=1.7).contains(&self.factor);
        is_far && self.left < 0.85 && self.left < 0.8 * self.left_at_one
    }
}

/// A comparison of factors over pairs of frames, of which one is in memory at a time.
#[derive(Debug, Clone)]
pub struct Fitting {
    time_s: f64,
    /// Changes that remain unexplained if nothing moves, and with each factor.
    still: f64,
    unexplained: Vec<(f64, f64)>,
}

impl Fitting {
    /// A comparison of frames `time_s` seconds apart.
    pub fn new(time_s: f64) -> Self {
        let factors = (-MOST_STEPS..=MOST_STEPS).map(|step| maths::pow(2.0, 0.5 * f64::from(step)));
        Self { time_s, still: 0.0, unexplained: factors.map(|factor| (factor, 0.0)).collect() }
    }

    /// Adds a pair: a field, the field in the next frame, and the flow of the first in the blocks that are examined.
    pub fn add(&mut self, before: &Grid<1>, after: &Grid<1>, flow: &Velocity) {
        let world = |index: [i32; 3]| before.transform().to_world(index.map(f64::from));
        let samples: Vec<Sample> = smoky(before).into_iter().map(|index| sample(after, flow, world(index))).collect();
        self.still += mismatch(before, &samples, 0.0);
        for (factor, sum) in &mut self.unexplained {
            *sum += mismatch(before, &samples, *factor * self.time_s);
        }
    }

    /// The factor that explains most. None if nothing changes or nothing moves.
    pub fn best(&self) -> Option<Fit> {
        if !(self.still.is_finite() && self.still > 0.0) {
            return None;
        }
        let left = |(factor, sum): &(f64, f64)| (*factor, sum / self.still);
        let (factor, left_over) = self.unexplained.iter().map(left).min_by(|a, b| a.1.total_cmp(&b.1))?;
        let (_, left_at_one) = self.unexplained.get(MOST_STEPS as usize).map(left)?;
        (left_over < 1.0).then_some(Fit { factor, left: left_over, left_at_one })
    }
}

/// A voxel of smoke: its place, the flow there, and the smoke there in the next frame.
struct Sample {
    world: [f64; 3],
    speed: [f64; 3],
    found: f64,
}

fn sample(after: &Grid<1>, flow: &Velocity, world: [f64; 3]) -> Sample {
    let found = trilinear(after, after.transform().to_index(world))[0];
    Sample { world, speed: flow.velocity_at(world), found }
}

/// Squared difference between the field advected for `time_s` and the next field, summed.
fn mismatch(before: &Grid<1>, samples: &[Sample], time_s: f64) -> f64 {
    let miss = |Sample { world, speed, found }: &Sample| {
        // Back along the path, to where the smoke that is here now came from.
        let from = std::array::from_fn(|axis| world[axis] - time_s * speed[axis]);
        let expected = trilinear(before, before.transform().to_index(from))[0];
        maths::square(found - expected)
    };
    samples.iter().map(miss).sum()
}

/// The space in which a pair's flow is needed, given its first field.
pub(crate) fn region(field: &Grid<1>) -> Region {
    Region::new(smoky_blocks(field).map(|(key, _)| key), *field.transform())
}

/// The value above which there is smoke.
fn least_smoke(field: &Grid<1>) -> f32 {
    LEAST_SHARE * field.blocks().flat_map(|(_, block)| block).fold(0.0f32, |most, [x]| most.max(x.abs()))
}

/// Evenly spaced blocks with smoke.
fn smoky_blocks(field: &Grid<1>) -> impl Iterator<Item = ([i32; 3], &[[f32; 1]; BLOCK_VOXELS])> {
    let least = least_smoke(field);
    let is_smoky = move |block: &[[f32; 1]; BLOCK_VOXELS]| block.iter().any(|[x]| x.abs() > least);
    let count = field.blocks().filter(|(_, block)| is_smoky(block)).count();
    let every = count.div_ceil(MOST_BLOCKS).max(1);
    field.blocks().filter(move |(_, block)| is_smoky(block)).step_by(every)
}

/// Evenly spaced voxels of smoke.
fn smoky(field: &Grid<1>) -> Vec<[i32; 3]> {
    let least = least_smoke(field);
    let mut voxels = vec![];
    for (key, block) in smoky_blocks(field) {
        for (voxel, _) in block.iter().enumerate().filter(|(_, [x])| x.abs() > least) {
            let within = [voxel >> 6, (voxel >> 3) & 7, voxel & 7];
            voxels.push(std::array::from_fn(|axis| key[axis] * BLOCK + within[axis] as i32));
        }
    }
    let every = voxels.len().div_ceil(MOST_VOXELS).max(1);
    voxels.into_iter().step_by(every).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Transform;
    use crate::velocity::Placement;

    const SIZE: usize = 24;

    /// A cloud that has moved by `shift` voxels of 0.1, in a wind of 3 per second.
    fn pair(shift: f64) -> (Grid<1>, Grid<1>, Velocity) {
        let transform = Transform::uniform(0.1, [0.0; 3]).unwrap();
        let cloud = |shift: f64| {
            let values: Vec<[f32; 1]> = (0..SIZE * SIZE * SIZE)
                .map(|n| {
                    let [x, y, z] = [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64 - 11.0);
                    [(-((x - shift).powi(2) + y * y + z * z) / 12.0).exp() as f32]
                })
                .collect();
            Grid::dense([SIZE; 3], &values, transform).unwrap()
        };
        let wind = vec![[3.0, 0.0, 0.0]; SIZE * SIZE * SIZE];
        let flow = Velocity::Vectors(Grid::dense([SIZE; 3], &wind, transform).unwrap(), Placement::Collocated);
        (cloud(0.0), cloud(shift), flow)
    }

    fn fit(pairs: &[(Grid<1>, Grid<1>, Velocity)], time_s: f64) -> Option<Fit> {
        let mut fitting = Fitting::new(time_s);
        pairs.iter().for_each(|(before, after, flow)| fitting.add(before, after, flow));
        fitting.best()
    }

    #[test]
    fn right_rate_fits_and_a_wrong_one_is_reported() {
        // 0.3 of the world in a tenth of a second.
        let pairs = [pair(3.0)];
        let right = fit(&pairs, 0.1).unwrap();
        assert!(right.factor == 1.0 && right.left < 0.05 && !right.is_wrong(), "{right:?}");
        let slow = fit(&pairs, 0.8).unwrap();
        assert!((slow.factor - 0.125).abs() < 1e-9 && slow.is_wrong(), "{slow:?}");
        let fast = fit(&pairs, 0.0125).unwrap();
        assert!((fast.factor - 8.0).abs() < 1e-9 && fast.is_wrong(), "{fast:?}");
    }

    #[test]
    fn smoke_at_rest_gives_no_rate() {
        assert_eq!(fit(&[pair(0.0)], 0.1), None);
        assert_eq!(fit(&[], 0.1), None);
        let (before, after, _) = pair(3.0);
        let still = Velocity::Vectors(Grid::new([0.0; 3], *before.transform()), Placement::Collocated);
        assert_eq!(fit(&[(before, after, still)], 0.1), None);
    }
}
