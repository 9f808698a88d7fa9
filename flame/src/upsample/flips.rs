//! Flips: parts of the flame that change at random times.
//!
//! Between two frames, every voxel of the flame keeps its old value up to its own random moment, and has its new value
//! from then on. Its neighbours change at nearly the same moment, so that the parts that change together are about as
//! large as a flame's smallest parts. The mean over all such moments is the straight line from one frame to the next,
//! which is subtracted. The remainder is zero at the frames, and its loudness depends on how many parts changed.

use super::source::{VoxelSources, unpacked};
use super::{Upsampler, filter};
use crate::solver::Random;

/// Distance in voxels at which two moments are hardly correlated any more: the spacing of a lattice of random numbers
/// that a cubic B-spline interpolates. Its kernel is as wide as a Gaussian of one voxel: from 0.7 to 1.5, the levels of
/// the scenes at 24 frames per second stay within 3 dB.
const SPACING: f64 = 1.73;

/// Lowest frequency of the added steps, as a share of the frame rate; below it, the curve through the frames is used.
const CORNER: f64 = 0.45;

/// Number of draws that estimate the distance of the middle of three frames from a curve through its neighbours.
const DRAWS: u64 = 2;

/// Number of values in a change before its steps.
pub const HEAD: usize = 5;

/// Decibels by which flips move the middle of three frames less than a flame does, although they are loud enough above:
/// large parts of a flame move together, and slowly.
const TOGETHER_DB: f64 = 3.5;

/// Decibels by which they may move it more before they count as too loud.
const APART_DB: f64 = 3.0;

/// Largest correction in decibels.
const MOST_DB: f64 = 12.0;

/// Number of frames at which half of the estimated correction is applied: a few may belong to a start from rest, which
/// says nothing about what follows.
const HALF_BELIEVED: f64 = 16.0;

/// The values of a change: sums of the sources before and after, of the absolute changes, and of their squares; the
/// mean square of the position at which flips over two frames would put the frame in the middle (negative if there is
/// none); then the steps between the first two.
pub fn change(
    number: i64,
    [before, after]: [&VoxelSources; 2],
    beyond: Option<&VoxelSources>,
    substeps: usize,
    seed: u64,
) -> Vec<f64> {
    let seed = mixed(seed ^ mixed(number as u64));
    let mut head =
        [before.total(), after.total(), 0.0, 0.0, beyond.map_or(-1.0, |beyond| middle(before, beyond, seed))];
    // Differences from step to step.
    let mut jumps = vec![0.0; substeps + 2];
    before.join(after, |place, before, after| {
        let change = after - before;
        head[2] += change.abs();
        head[3] += change * change;
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
    let steps = (1..substeps).map(|step| {
        sum += jumps[step];
        sum - whole * step as f64 / substeps as f64
    });
    head.into_iter().chain(steps).collect()
}

/// A random number that depends on all bits of a key.
fn mixed(key: u64) -> u64 {
    Random::new(key).bits()
}

/// Mean square of the distance that flips would have, half-way between two frames, from the middle of the two.
fn middle(before: &VoxelSources, after: &VoxelSources, seed: u64) -> f64 {
    let mut sums = [0.0; DRAWS as usize];
    before.join(after, |place, before, after| {
        for (draw, sum) in sums.iter_mut().enumerate().filter(|_| before != after) {
            let is_early = lattice(unpacked(place), mixed(seed ^ (draw as u64 + 1))) < 0.0;
            *sum += if is_early { 0.5 } else { -0.5 } * (after - before);
        }
    });
    sums.iter().map(|sum| sum * sum).sum::<f64>() / DRAWS as f64
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

/// Signal to add to the curve through the frames.
pub fn added(values: &[f64], pairs: &[Option<&[f64]>], upsampler: &Upsampler) -> Vec<f64> {
    let substeps = upsampler.substeps();
    let unit = if upsampler.needs_field_only() { flux_per_source(values, pairs) } else { 1.0 };
    let scale = unit * maths::pow(10.0, gain_db(values, pairs, unit) / 20.0);
    let mut steps = vec![0.0; values.len() * substeps];
    for (steps, change) in steps.chunks_exact_mut(substeps).zip(pairs) {
        let Some(change) = change.filter(|change| change.len() == HEAD + substeps - 1) else { continue };
        for (step, change) in steps[1..].iter_mut().zip(&change[HEAD..]) {
            *step = scale * change;
        }
    }
    filter::high_passed(&steps, CORNER / substeps as f64)
}

/// The level that flips lack, estimated from the frames themselves: each frame's actual distance from a curve through
/// its neighbours is compared with the distance that flips over both would give it.
fn gain_db(values: &[f64], pairs: &[Option<&[f64]>], unit: f64) -> f64 {
    let (mut true_power, mut flipped_power, mut count) = (0.0, 0.0, 0.0);
    for (window, change) in values.windows(7).zip(pairs.iter().skip(2)) {
        let Some(middle) = change.and_then(|change| change.get(4)).filter(|middle| **middle >= 0.0) else { continue };
        // Half-way between the third and the fifth, by a cubic through every second one.
        let between = (9.0 * (window[2] + window[4]) - (window[0] + window[6])) / 16.0;
        true_power += maths::square(window[3] - between);
        flipped_power += middle * unit * unit;
        count += 1.0;
    }
    if !(true_power > 0.0 && flipped_power > 0.0) {
        return 0.0;
    }
    let found_db = 10.0 * maths::log10(flipped_power / true_power);
    let gain_db = if found_db < -TOGETHER_DB { -found_db - TOGETHER_DB } else { (APART_DB - found_db).min(0.0) };
    gain_db.clamp(-MOST_DB, MOST_DB) * count / (count + HALF_BELIEVED)
}

/// The flux per unit of the sources, from their sums.
fn flux_per_source(values: &[f64], pairs: &[Option<&[f64]>]) -> f64 {
    let both =
        values.iter().zip(pairs).filter_map(|(flux, change)| Some((flux.abs(), change.as_ref()?.first()?.abs())));
    let (flux, source) = both.fold((0.0, 0.0), |sum, (flux, source)| (sum.0 + flux, sum.1 + source));
    if source > 0.0 { flux / source } else { 0.0 }
}
