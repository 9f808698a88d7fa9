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
    before.join(after, |place, before, after| {
        let change = after - before;
        if change == 0.0 {
            return;
        }
        let moment = normal_share(lattice(unpacked(place), seed)) * substeps as f64;
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

/// Random numbers of deviation 1 that depend on position.
fn lattice(index: [i64; 3], seed: u64) -> f64 {
    let at = index.map(|i| i as f64 / SPACING);
    let base = at.map(f64::floor);
    let [x, y, z]: [[f64; 4]; 3] = std::array::from_fn(|axis| weights(at[axis] - base[axis]));
    let [i, j, k] = base.map(|base| base as i64);
    let hashed = |hash: u64, index: i64, tap: usize| mixed(hash ^ (index + tap as i64) as u64);
    let (mut sum, mut power) = (0.0, 0.0);
    for (tap, x) in x.iter().enumerate() {
        let hash = hashed(seed, i, tap);
        for (tap, y) in y.iter().enumerate() {
            let hash = hashed(hash, j, tap);
            for (tap, z) in z.iter().enumerate() {
                let weight = x * y * z;
                sum += weight * normal(hashed(hash, k, tap));
                power += weight * weight;
            }
        }
    }
    sum / power.sqrt()
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
