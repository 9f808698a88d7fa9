//! Flips: parts of the flame that change at random times.
//!
//! Between two frames, every voxel of the flame keeps its old value up to its own random moment, and has its new value
//! from then on. Its neighbours change at nearly the same moment, so that the parts that change together are about as
//! large as a flame's smallest parts. The mean over all such moments is the straight line from one frame to the next,
//! which is subtracted. The remainder has the spectrum of a flame, but not its loudness: parts that change together in a
//! flame change one by one here.

use super::source::{VoxelSources, unpacked};
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
    before.join(after, |place, before, after| {
        let change = after - before;
        if change == 0.0 {
            return;
        }
        let moment = normal_share(lattice.at(unpacked(place))) * substeps as f64;
        // Half a step to either side: two steps share a change between them.
        let step = (moment - 0.5).ceil().clamp(0.0, substeps as f64);
        let share = (step - moment + 0.5).clamp(0.0, 1.0);
        jumps[step as usize] += share * change;
        jumps[step as usize + 1] += (1.0 - share) * change;
    });
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

/// Random numbers of deviation 1 that depend on position. Neighbours along z share most of what they are made of, so it is
/// kept from one position to the next.
struct Lattice {
    seed: u64,
    /// The lattice's point before the last position.
    base: Option<[i64; 3]>,
    /// Numbers at the 4×4×4 points around it, x slowest, and the hashes of their columns along z.
    columns: [u64; 16],
    numbers: [[f64; 4]; 16],
}

impl Lattice {
    fn new(seed: u64) -> Self {
        Self { seed, base: None, columns: [0; 16], numbers: [[0.0; 4]; 16] }
    }

    /// The number at an index.
    fn at(&mut self, index: [i64; 3]) -> f64 {
        let at = index.map(|i| i as f64 / SPACING);
        let base = at.map(f64::floor);
        let [x, y, z]: [[f64; 4]; 3] = std::array::from_fn(|axis| weights(at[axis] - base[axis]));
        self.move_to(base.map(|base| base as i64));
        let (mut sum, mut power) = (0.0, 0.0);
        for (n, numbers) in self.numbers.iter().enumerate() {
            let column = x[n / 4] * y[n % 4];
            for (number, z) in numbers.iter().zip(&z) {
                let weight = column * z;
                sum += weight * number;
                power += weight * weight;
            }
        }
        sum / power.sqrt()
    }

    fn move_to(&mut self, base: [i64; 3]) {
        let [i, j, k] = base;
        let hashed = |hash: u64, index: i64, tap: usize| mixed(hash ^ (index + tap as i64) as u64);
        let known = match self.base {
            Some(last) if last == base => return,
            // One point on: the other three stay.
            Some(last) if last == [i, j, k - 1] => 3,
            Some([x, y, _]) if [x, y] == [i, j] => 0,
            _ => {
                let seed = self.seed;
                self.columns = std::array::from_fn(|n| hashed(hashed(seed, i, n / 4), j, n % 4));
                0
            }
        };
        for (numbers, hash) in self.numbers.iter_mut().zip(self.columns) {
            numbers.copy_within(4 - known.., 0);
            for (tap, number) in numbers.iter_mut().enumerate().skip(known) {
                *number = normal(hashed(hash, k, tap));
            }
        }
        self.base = Some(base);
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

    #[test]
    fn what_is_kept_of_the_lattice_changes_nothing() {
        let mut kept = Lattice::new(7);
        let places = [
            [0, 0, 0],
            [0, 0, 1],
            [0, 0, 2],
            [0, 0, 9],
            [0, 1, 9],
            [5, 1, 9],
            [-5, -1, -9],
            [-5, -1, -8],
            [-5, -1, -4],
            [-5, -1, -5],
        ];
        for place in places {
            assert_eq!(kept.at(place), Lattice::new(7).at(place), "{place:?}");
        }
        assert_ne!(Lattice::new(7).at([1, 2, 3]), Lattice::new(8).at([1, 2, 3]));
    }
}
