//! Principal axes of a level's features.

use bitcode::{Decode, Encode};
use std::ops::Range;

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use super::AXES_MAX;
use super::lanes::{Lanes, Machine, STAGE, Work};
use crate::texture::feature::Features;

/// At most this many windows, evenly spread, are used to find the axes.
const SAMPLE: usize = 8192;
/// Windows handled by one task.
const CHUNK: usize = 4096;
/// Axes projected onto at once.
const GROUP: usize = 16;
/// Part of the variance that the axes may leave out.
const LEFT_OUT: f64 = 2e-2;

/// An orthonormal frame of the directions in which features vary most.
#[derive(Debug, Encode, Decode)]
pub struct Axes {
    mean: Vec<f64>,
    /// For each group of axes, for each dimension of a feature, its part in those axes; 0 beyond the last.
    parts: Vec<[f64; GROUP]>,
    /// Numbers of a point: its coordinates along the axes, then the length of what they leave out;
    /// a multiple of `STAGE`.
    count: usize,
}

/// A level's windows along its axes.
pub struct Points {
    /// Numbers of every window, one window after the other.
    pub coordinates: Vec<f32>,
    /// Largest distance of a window from the mean.
    pub radius: f32,
}

impl Axes {
    /// The axes of the features of `windows`.
    pub fn new(features: &Features<'_>, windows: Range<usize>) -> Self {
        let dimensions = features.shape.feature_len();
        let stride = windows.len().div_ceil(SAMPLE).max(1);
        let sampled: Vec<usize> = windows.step_by(stride).collect();
        let mut feature = vec![0.0; dimensions];
        let mut mean = vec![0.0; dimensions];
        for window in &sampled {
            features.write(*window, &mut feature);
            mean.iter_mut().zip(&feature).for_each(|(sum, x)| *sum += x);
        }
        mean.iter_mut().for_each(|sum| *sum /= sampled.len() as f64);
        let eigen = SymmetricEigen::new(covariance(features, &sampled, &mean));
        let mut order: Vec<usize> = (0..dimensions).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]).then(a.cmp(b)));
        let variances = order.iter().map(|axis| eigen.eigenvalues[*axis].max(0.0));
        let total: f64 = variances.clone().sum();
        let mut left = total;
        let enough = variances.take_while(|variance| {
            let more = left > LEFT_OUT * total;
            left -= variance;
            more
        });
        let count = (enough.count() + 1).next_multiple_of(STAGE).min(AXES_MAX);
        let mut parts = vec![[0.0; GROUP]; dimensions * count.div_ceil(GROUP)];
        for (axis, column) in order.into_iter().take(count - 1).enumerate() {
            let group = &mut parts[axis / GROUP * dimensions..][..dimensions];
            for (dimension, part) in group.iter_mut().enumerate() {
                part[axis % GROUP] = eigen.eigenvectors[(dimension, column)];
            }
        }
        Self { mean, parts, count }
    }

    /// Numbers of a point.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Projects `feature`; answers the point, 0 beyond its numbers, and the feature's distance from the mean.
    #[inline(always)]
    pub fn project(&self, feature: &[f64]) -> ([f32; AXES_MAX], f64) {
        let square: f64 = feature.iter().zip(&self.mean).map(|(x, mean)| (x - mean) * (x - mean)).sum();
        let mut point = [0.0; AXES_MAX];
        let mut explained = 0.0;
        for (part, point) in self.parts.chunks_exact(self.mean.len()).zip(point.as_chunks_mut().0) {
            explained += self.project_onto(part, feature, point);
        }
        point[self.count - 1] = (square - explained).max(0.0).sqrt() as f32;
        (point, square.sqrt())
    }

    /// Projects onto some axes; answers the square of the projection.
    #[inline(always)]
    fn project_onto(&self, part: &[[f64; GROUP]], feature: &[f64], point: &mut [f32; GROUP]) -> f64 {
        // Two sums side by side: additions need not wait for each other.
        let (mut even, mut odd) = ([0.0f64; GROUP], [0.0f64; GROUP]);
        let (parts, last_part) = part.as_chunks::<2>();
        let (features, last) = feature.as_chunks::<2>();
        let (means, last_mean) = self.mean.as_chunks::<2>();
        for ((x, mean), part) in features.iter().zip(means).zip(parts) {
            let (x, y) = (x[0] - mean[0], x[1] - mean[1]);
            for axis in 0..GROUP {
                even[axis] += x * part[0][axis];
                odd[axis] += y * part[1][axis];
            }
        }
        for ((x, mean), part) in last.iter().zip(last_mean).zip(last_part) {
            for axis in 0..GROUP {
                even[axis] += (x - mean) * part[axis];
            }
        }
        let mut square = 0.0;
        for axis in 0..GROUP {
            let x = even[axis] + odd[axis];
            square += x * x;
            point[axis] = x as f32;
        }
        square
    }

    /// Projects the features of all `windows`.
    pub fn project_all(&self, features: &Features<'_>, windows: Range<usize>) -> Points {
        let mut coordinates = vec![0.0; windows.len() * self.count];
        let machine = Machine::best();
        let chunks = coordinates.par_chunks_mut(CHUNK * self.count).enumerate();
        let radii = chunks.map(|(chunk, out)| {
            let first_window = windows.start + chunk * CHUNK;
            machine.run(Projection { axes: self, features, first_window, out })
        });
        let radius = radii.reduce(|| 0.0, f32::max);
        Points { coordinates, radius }
    }
}

struct Projection<'a> {
    axes: &'a Axes,
    features: &'a Features<'a>,
    first_window: usize,
    out: &'a mut [f32],
}

impl Work for Projection<'_> {
    type Done = f32;

    #[inline(always)]
    fn with<L: Lanes>(self, _: L) -> f32 {
        let mut feature = vec![0.0; self.features.shape.feature_len()];
        let mut radius = 0.0f32;
        for (i, out) in self.out.chunks_exact_mut(self.axes.count).enumerate() {
            self.features.write(self.first_window + i, &mut feature);
            let (point, length) = self.axes.project(&feature);
            out.copy_from_slice(&point[..out.len()]);
            radius = radius.max(length as f32);
        }
        radius
    }
}

fn covariance(features: &Features<'_>, sampled: &[usize], mean: &[f64]) -> DMatrix<f64> {
    let dimensions = mean.len();
    let partial = |windows: &[usize]| {
        let mut feature = vec![0.0; dimensions];
        let mut sums = DMatrix::<f64>::zeros(dimensions, dimensions);
        for window in windows {
            features.write(*window, &mut feature);
            feature.iter_mut().zip(mean).for_each(|(x, mean)| *x -= mean);
            for (column, x) in feature.iter().enumerate() {
                let column = &mut sums.as_mut_slice()[column * dimensions..][..dimensions];
                column.iter_mut().zip(&feature).for_each(|(sum, y)| *sum += x * y);
            }
        }
        sums
    };
    // Chunks of a fixed size, added in order: the axes must not depend on the number of threads.
    let partials: Vec<DMatrix<f64>> = sampled.par_chunks(CHUNK).map(partial).collect();
    partials.into_iter().fold(DMatrix::zeros(dimensions, dimensions), |sum, part| sum + part)
}
