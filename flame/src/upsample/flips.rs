//! Flips: parts of the flame that change at random times.
//!
//! Between two frames, every voxel of the flame keeps its old value up to its own random moment, and has its new value
//! from then on. Its neighbours change at nearly the same moment, so that the parts that change together are about as
//! large as a flame's smallest parts. The mean over all such moments is the straight line from one frame to the next,
//! which is subtracted. The remainder has the spectrum of a flame, but not its loudness: parts that change together in a
//! flame change one by one here.

use super::source::VoxelSources;
use crate::grid::BLOCK;
use crate::solver::Random;

/// Distance in voxels at which two moments are hardly correlated any more: the spacing of a lattice of random numbers
/// that a cubic B-spline interpolates. Its kernel is as wide as a Gaussian of one voxel: from 0.7 to 1.5, the levels of
/// the scenes at 24 frames per second stay within 3 dB.
const SPACING: f64 = 1.73;

/// The deviations of the steps between two frames from a straight line.
pub fn change(number: i64, [before, after]: [&VoxelSources; 2], substeps: usize, seed: u64) -> Vec<f64> {
    let seed = mixed(seed ^ mixed(number as u64));
    // Differences from step to step.
    let mut jumps = vec![0.0; substeps + 2];
    let mut lattice = Lattice::new(seed);
    for (key, before, after) in before.pairs(after) {
        lattice.move_to(key);
        for (voxel, ([before], [after])) in before.iter().zip(after).enumerate().filter(|(_, (a, b))| a != b) {
            let change = f64::from(*after) - f64::from(*before);
            let moment = normal_share(lattice.at(voxel)) * substeps as f64;
            // Half a step to either side: two steps share a change between them.
            let step = (moment - 0.5).ceil().clamp(0.0, substeps as f64);
            let share = (step - moment + 0.5).clamp(0.0, 1.0);
            jumps[step as usize] += share * change;
            jumps[step as usize + 1] += (1.0 - share) * change;
        }
    }
    let whole: f64 = jumps.iter().sum();
    let mut sum = jumps[0];
    let between = (1..substeps).map(|step| {
        sum += jumps[step];
        sum - whole * step as f64 / substeps as f64
    });
    between.collect()
}

/// A random number that depends on all bits of a key.
fn mixed(key: u64) -> u64 {
    Random::new(key).bits()
}

/// Random numbers of deviation 1 that depend on position, for the voxels of one block at a time.
struct Lattice {
    seed: u64,
    axes: [[Taps; BLOCK as usize]; 3],
    /// Numbers at the lattice's points around the block, x slowest.
    points: Vec<f64>,
}

/// Points along an axis that the voxels of a block depend on: one before its first voxel, two after its last, and those in
/// between.
const POINTS: usize = ((BLOCK - 1) as f64 / SPACING) as usize + 5;

/// The four points along an axis around a voxel.
#[derive(Debug, Clone, Copy, Default)]
struct Taps {
    /// The first of them, among the block's.
    first: usize,
    weights: [f64; 4],
    /// Sum of the weights' squares.
    power: f64,
}

impl Lattice {
    fn new(seed: u64) -> Self {
        Self { seed, axes: [[Taps::default(); BLOCK as usize]; 3], points: vec![0.0; POINTS.pow(3)] }
    }

    /// Goes to the block at `key` (index / 8).
    fn move_to(&mut self, key: [i32; 3]) {
        let place = |key: i32, voxel: usize| (f64::from(key) * f64::from(BLOCK) + voxel as f64) / SPACING;
        let firsts = key.map(|key| place(key, 0).floor());
        for (axis, taps) in self.axes.iter_mut().enumerate() {
            for (voxel, taps) in taps.iter_mut().enumerate() {
                let at = place(key[axis], voxel);
                let weights = weights(at - at.floor());
                let power = weights.iter().map(|weight| weight * weight).sum();
                *taps = Taps { first: (at.floor() - firsts[axis]) as usize, weights, power };
            }
        }
        let [i, j, k] = firsts.map(|first| first as i64);
        let hashed = |hash: u64, first: i64, n: usize| mixed(hash ^ (first + n as i64) as u64);
        for (column, points) in self.points.chunks_exact_mut(POINTS).enumerate() {
            let hash = hashed(hashed(self.seed, i, column / POINTS), j, column % POINTS);
            for (n, number) in points.iter_mut().enumerate() {
                *number = normal(hashed(hash, k, n));
            }
        }
    }

    /// The number at a voxel of the block.
    fn at(&self, voxel: usize) -> f64 {
        let [x, y, z] = [self.axes[0][voxel >> 6], self.axes[1][(voxel >> 3) & 7], self.axes[2][voxel & 7]];
        let mut sum = 0.0;
        for (i, of_x) in x.weights.iter().enumerate() {
            for (j, of_y) in y.weights.iter().enumerate() {
                let start = ((x.first + i) * POINTS + y.first + j) * POINTS + z.first;
                let along: f64 = self.points[start..start + 4].iter().zip(&z.weights).map(|(a, b)| a * b).sum();
                sum += of_x * of_y * along;
            }
        }
        sum / (x.power * y.power * z.power).sqrt()
    }
}

fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    let outer = |t: f64| t * t * t / 6.0;
    let inner = |t: f64| (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
    [outer(s), inner(t), inner(s), outer(t)]
}

/// A number of deviation 1 that is close to normal: the sum of four uniform ones.
fn normal(bits: u64) -> f64 {
    let even = |shift: u32| f64::from((bits >> shift) as u16) / 65536.0;
    (even(0) + even(16) + even(32) + even(48) - 2.0) * 3f64.sqrt()
}

/// The share of normally distributed numbers that are smaller (Abramowitz & Stegun 26.2.17, within 8e-8).
fn normal_share(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series =
        t * (0.319_381_530 + t * (-0.356_563_782 + t * (1.781_477_937 + t * (-1.821_255_978 + t * 1.330_274_429))));
    let tail = maths::exp(-0.5 * x * x) / std::f64::consts::TAU.sqrt() * series;
    if x < 0.0 { tail } else { 1.0 - tail }
}

/// The deviations of all steps of `substeps` between frames; zero where a change is unknown.
pub fn deviations(changes: &[Option<&[f64]>], substeps: usize) -> Vec<f64> {
    let mut steps = vec![0.0; changes.len() * substeps];
    for (steps, change) in steps.chunks_exact_mut(substeps).zip(changes) {
        if let Some(change) = change.filter(|change| change.len() + 1 == substeps) {
            steps[1..].copy_from_slice(change);
        }
    }
    steps
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number at an index, from its 64 points.
    fn brute(index: [i32; 3], seed: u64) -> f64 {
        let at = index.map(|i| f64::from(i) / SPACING);
        let base = at.map(f64::floor);
        let weights: [[f64; 4]; 3] = std::array::from_fn(|axis| weights(at[axis] - base[axis]));
        let (mut sum, mut power) = (0.0, 0.0);
        for n in 0..64usize {
            let taps = [n / 16, n / 4 % 4, n % 4];
            let hash = (0..3).fold(seed, |hash, axis| mixed(hash ^ (base[axis] as i64 + taps[axis] as i64) as u64));
            let weight: f64 = (0..3).map(|axis| weights[axis][taps[axis]]).product();
            sum += weight * normal(hash);
            power += weight * weight;
        }
        sum / power.sqrt()
    }

    #[test]
    fn blocks_share_one_lattice() {
        let mut lattice = Lattice::new(7);
        for key in [[0, 0, 0], [0, 0, 1], [-1, 3, -2], [1000, -1000, 77], [1 << 24, -(1 << 24), 0]] {
            lattice.move_to(key);
            for voxel in 0..512i32 {
                let within = [voxel >> 6, (voxel >> 3) & 7, voxel & 7];
                let index = std::array::from_fn(|axis| 8 * key[axis] + within[axis]);
                let (found, expected) = (lattice.at(voxel as usize), brute(index, 7));
                assert!((found - expected).abs() < 1e-9, "{index:?}: {found}, not {expected}");
            }
        }
        assert_ne!(brute([1, 2, 3], 7), brute([1, 2, 3], 8));
    }
}
