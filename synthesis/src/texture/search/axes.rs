//! Principal axes of a level's features.

use std::ops::Range;

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use super::COORDINATES;
use crate::texture::feature::Features;

/// Principal axes kept.
const AXES: usize = COORDINATES - 1;
/// At most this many windows, evenly spread, are used to find the axes.
const SAMPLE: usize = 20_000;
/// Windows projected by one task.
const CHUNK: usize = 4096;

/// A feature's coordinates along the axes, and the length of what they leave out.
pub type Point = [f32; COORDINATES];

/// An orthonormal frame of the directions in which features vary most.
#[derive(Debug)]
pub struct Axes {
    mean: Vec<f64>,
    /// For each dimension of a feature its part in every axis; the last lane is 0.
    parts: Vec<[f64; COORDINATES]>,
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
        let covariance = covariance(features, &sampled, &mean);
        let eigen = SymmetricEigen::new(covariance);
        let mut order: Vec<usize> = (0..dimensions).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]).then(a.cmp(b)));
        let mut parts = vec![[0.0; COORDINATES]; dimensions];
        for (axis, column) in order.into_iter().take(AXES).enumerate() {
            for (dimension, part) in parts.iter_mut().enumerate() {
                part[axis] = eigen.eigenvectors[(dimension, column)];
            }
        }
        Self { mean, parts }
    }

    /// Projects `feature`; answers the point and the feature's distance from the mean.
    #[inline(always)]
    pub fn project(&self, feature: &[f64]) -> (Point, f64) {
        let mut along = [0.0f64; COORDINATES];
        let mut length = 0.0;
        for ((x, mean), part) in feature.iter().zip(&self.mean).zip(&self.parts) {
            let x = x - mean;
            length += x * x;
            for (sum, part) in along.iter_mut().zip(part) {
                *sum += x * part;
            }
        }
        let explained: f64 = along.iter().map(|x| x * x).sum();
        along[AXES] = (length - explained).max(0.0).sqrt();
        (along.map(|x| x as f32), length.sqrt())
    }

    /// Projects the features of all `windows`; each comes with its distance from the mean.
    pub fn project_all(&self, features: &Features<'_>, windows: Range<usize>) -> Vec<(Point, f32)> {
        let starts: Vec<usize> = windows.clone().step_by(CHUNK).collect();
        let chunk = |start: &usize| -> Vec<(Point, f32)> {
            let mut feature = vec![0.0; features.shape.feature_len()];
            let of_window = |window| {
                features.write(window, &mut feature);
                let (point, length) = self.project(&feature);
                (point, length as f32)
            };
            (*start..windows.end.min(start + CHUNK)).map(of_window).collect()
        };
        starts.par_iter().flat_map_iter(chunk).collect()
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
