//! Principal axes of a level's features.

use bitcode::{Decode, Encode};
use std::ops::Range;

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use super::lanes::{Lanes, Machine, STAGE, Work};
use super::sizes::AXES_MAX;
use crate::texture::feature::Features;

/// Largest number of windows, evenly spaced, from which the axes are computed. Any axes give the right result; good ones
/// are faster.
const SAMPLE: usize = 8192;
/// Windows handled by one task. Fixed, so that sums do not depend on the number of threads.
const CHUNK: usize = 4096;
/// Coordinates that [`Axes::columns`] answers: the axes along which a recording's windows differ most.
pub const COLUMNS: usize = 4;
/// Axes projected onto at once.
const GROUP: usize = 16;
/// Stages in a group.
const STAGES: usize = GROUP / STAGE;
/// Share of the variance that a shell's axes may leave out.
const LEFT_OUT: f64 = 2e-2;

/// An orthonormal frame of the directions in which features vary most.
#[derive(Debug, Encode, Decode)]
pub struct Axes {
    mean: Vec<f64>,
    /// For each group of axes and each dimension of a feature, its components along those axes; 0 beyond the last axis.
    parts: Vec<[f64; GROUP]>,
}

/// A feature along the axes, as far as it was projected.
#[derive(Debug, Clone)]
pub struct Projection {
    /// Its coordinates.
    coordinates: [f32; AXES_MAX],
    /// For every number of axes that a shell may have, the squared length of the remainder beyond all but the last.
    rests: [f64; AXES_MAX / STAGE],
    /// Distance from the mean.
    pub length: f64,
    square: f64,
    /// Share of the squared length that the coordinates explain.
    explained: f64,
    /// Groups of axes that it was projected onto.
    groups: usize,
}

impl Projection {
    /// The point in `axes` numbers, a multiple of `STAGE`: coordinates, then the length of the remainder.
    #[inline(always)]
    pub fn point(&self, axes: usize) -> [f32; AXES_MAX] {
        let mut point = self.coordinates;
        point[axes - 1] = self.rests[axes / STAGE - 1].sqrt() as f32;
        point
    }
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
        let mut parts = vec![[0.0; GROUP]; dimensions * (AXES_MAX / GROUP)];
        for (axis, column) in order.into_iter().take(AXES_MAX - 1).enumerate() {
            let group = &mut parts[axis / GROUP * dimensions..][..dimensions];
            for (dimension, part) in group.iter_mut().enumerate() {
                part[axis % GROUP] = eigen.eigenvectors[(dimension, column)];
            }
        }
        Self { mean, parts }
    }

    /// Forgets all axes that points of `axes` numbers do not need.
    pub fn keep(&mut self, axes: usize) {
        self.parts.truncate(axes.div_ceil(GROUP) * self.mean.len());
    }

    /// Number of coordinates that the points of `windows` need: enough to leave out next to nothing of the differences
    /// between the windows, plus the length of the remainder. Windows 60 dB below others differ in directions that the
    /// others hardly have.
    pub fn needed(&self, features: &Features<'_>, windows: &[u32]) -> usize {
        Machine::best().run(Needed { axes: self, features, windows })
    }

    /// Projects `feature` onto all axes.
    #[inline(always)]
    pub fn project(&self, feature: &[f64]) -> Projection {
        let mut projection = self.begin(feature);
        self.extend(&mut projection, feature, AXES_MAX);
        projection
    }

    /// `feature`, not yet projected onto anything.
    #[inline(always)]
    pub fn begin(&self, feature: &[f64]) -> Projection {
        // Eight sums side by side fill two vectors, and additions need not wait for each other.
        let mut sums = [0.0f64; STAGE];
        let (features, last) = feature.as_chunks::<STAGE>();
        let (means, last_means) = self.mean.as_chunks::<STAGE>();
        for (x, mean) in features.iter().zip(means) {
            for lane in 0..STAGE {
                let difference = x[lane] - mean[lane];
                sums[lane] += difference * difference;
            }
        }
        for ((sum, x), mean) in sums.iter_mut().zip(last).zip(last_means) {
            *sum += (x - mean) * (x - mean);
        }
        let square: f64 = sums.iter().sum();
        let (coordinates, rests) = ([0.0; AXES_MAX], [0.0; AXES_MAX / STAGE]);
        Projection { coordinates, rests, length: square.sqrt(), square, explained: 0.0, groups: 0 }
    }

    /// Projects `feature` onto `axes` axes, as far as that is still to be done.
    #[inline(always)]
    pub fn extend(&self, projection: &mut Projection, feature: &[f64], axes: usize) {
        let Projection { coordinates, rests, square, explained, groups, .. } = projection;
        let parts = self.parts.chunks_exact(self.mean.len());
        let room = coordinates.as_chunks_mut::<GROUP>().0.iter_mut().zip(rests.as_chunks_mut::<STAGES>().0);
        let wanted = axes.div_ceil(GROUP);
        for (part, (coordinates, rests)) in parts.zip(room).take(wanted).skip(*groups) {
            let squares = self.project_onto(part, feature, coordinates);
            for (rest, squares) in rests.iter_mut().zip(squares.as_chunks::<STAGE>().0) {
                // The last number of a stage may be the remainder instead of a coordinate.
                let [a, b, c, d, e, f, g, last] = *squares;
                *explained += ((a + b) + (c + d)) + ((e + f) + g);
                *rest = (*square - *explained).max(0.0);
                *explained += last;
            }
        }
        *groups = wanted.max(*groups);
    }

    /// Projects onto some axes; returns the squares of the coordinates.
    #[inline(always)]
    fn project_onto(&self, part: &[[f64; GROUP]], feature: &[f64], point: &mut [f32; GROUP]) -> [f64; GROUP] {
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
        std::array::from_fn(|axis| {
            let x = even[axis] + odd[axis];
            point[axis] = x as f32;
            x * x
        })
    }

    /// The points of `windows` in `axes` numbers, one after the other, and their largest distance from the mean.
    pub fn points(&self, features: &Features<'_>, windows: &[u32], axes: usize) -> (Vec<f32>, f32) {
        let mut points = vec![0.0; windows.len() * axes];
        let machine = Machine::best();
        let chunks = points.par_chunks_mut(CHUNK * axes).zip(windows.par_chunks(CHUNK));
        let radii = chunks.map(|(out, windows)| machine.run(Points { axes: self, features, windows, out }));
        let radius = radii.reduce(|| 0.0, f32::max);
        (points, radius)
    }
}

impl Axes {
    /// The first coordinates of `windows`, and their largest distance from the mean.
    pub fn columns(&self, features: &Features<'_>, windows: &[u32]) -> (Vec<[f32; COLUMNS]>, f32) {
        let mut columns = vec![[0.0; COLUMNS]; windows.len()];
        let machine = Machine::best();
        let chunks = columns.par_chunks_mut(CHUNK).zip(windows.par_chunks(CHUNK));
        let radii = chunks.map(|(out, windows)| machine.run(Columns { axes: self, features, windows, out }));
        let radius = radii.reduce(|| 0.0, f32::max);
        (columns, radius)
    }

    /// One number of the points of `windows`, as [`points`](Self::points) has them.
    pub fn column(&self, features: &Features<'_>, windows: &[u32], axes: usize, axis: usize) -> Vec<f32> {
        let numbers = |windows: &[u32]| -> Vec<f32> {
            let (points, _) = self.points(features, windows, axes);
            points.chunks_exact(axes).map(|point| point[axis]).collect()
        };
        windows.par_chunks(CHUNK).flat_map_iter(numbers).collect()
    }
}

struct Columns<'a> {
    axes: &'a Axes,
    features: &'a Features<'a>,
    windows: &'a [u32],
    out: &'a mut [[f32; COLUMNS]],
}

impl Work for Columns<'_> {
    type Output = f32;

    #[inline(always)]
    fn with<L: Lanes>(self, _: L) -> f32 {
        let mut feature = vec![0.0; self.features.shape.feature_len()];
        let mut radius = 0.0f32;
        for (window, out) in self.windows.iter().zip(self.out) {
            self.features.write(*window as usize, &mut feature);
            let mut projection = self.axes.begin(&feature);
            self.axes.extend(&mut projection, &feature, COLUMNS);
            out.copy_from_slice(&projection.coordinates[..COLUMNS]);
            radius = radius.max(projection.length as f32);
        }
        radius
    }
}

struct Needed<'a> {
    axes: &'a Axes,
    features: &'a Features<'a>,
    windows: &'a [u32],
}

impl Work for Needed<'_> {
    type Output = usize;

    #[inline(always)]
    fn with<L: Lanes>(self, _: L) -> usize {
        let mut feature = vec![0.0; self.axes.mean.len()];
        let stride = self.windows.len().div_ceil(SAMPLE).max(1);
        let (mut sums, mut squares) = ([0.0; AXES_MAX], [0.0; AXES_MAX]);
        let (mut beyond, mut count) = (0.0, 0.0);
        for window in self.windows.iter().step_by(stride) {
            self.features.write(*window as usize, &mut feature);
            let projection = self.axes.project(&feature);
            for (axis, x) in projection.coordinates.iter().enumerate() {
                sums[axis] += f64::from(*x);
                squares[axis] += f64::from(*x) * f64::from(*x);
            }
            beyond += maths::square(f64::from(projection.rests[AXES_MAX / STAGE - 1].sqrt() as f32));
            count += 1.0;
        }
        let variances: Vec<f64> = sums
            .iter()
            .zip(&squares)
            .map(|(sum, square)| (square / count - maths::square(sum / count)).max(0.0))
            .collect();
        let total = variances.iter().sum::<f64>() + beyond / count;
        let left = |axes: usize| variances[axes - 1..].iter().sum::<f64>() + beyond / count;
        let enough = (STAGE..AXES_MAX).step_by(STAGE).find(|axes| left(*axes) <= LEFT_OUT * total);
        enough.unwrap_or(AXES_MAX)
    }
}

struct Points<'a> {
    axes: &'a Axes,
    features: &'a Features<'a>,
    windows: &'a [u32],
    out: &'a mut [f32],
}

impl Work for Points<'_> {
    type Output = f32;

    #[inline(always)]
    fn with<L: Lanes>(self, _: L) -> f32 {
        let mut feature = vec![0.0; self.features.shape.feature_len()];
        let mut radius = 0.0f32;
        let axes = self.out.len() / self.windows.len();
        for (window, out) in self.windows.iter().zip(self.out.chunks_exact_mut(axes)) {
            self.features.write(*window as usize, &mut feature);
            let projection = self.axes.project(&feature);
            out.copy_from_slice(&projection.point(axes)[..axes]);
            radius = radius.max(projection.length as f32);
        }
        radius
    }
}

fn covariance(features: &Features<'_>, sampled: &[usize], mean: &[f64]) -> DMatrix<f64> {
    let partial = |windows: &[usize]| Machine::best().run(Covariance { features, windows, mean });
    // Chunks of a fixed size, added in order: the axes must not depend on the number of threads.
    let partials: Vec<DMatrix<f64>> = sampled.par_chunks(CHUNK).map(partial).collect();
    partials.into_iter().fold(DMatrix::zeros(mean.len(), mean.len()), |sum, part| sum + part)
}

struct Covariance<'a> {
    features: &'a Features<'a>,
    windows: &'a [usize],
    mean: &'a [f64],
}

impl Work for Covariance<'_> {
    type Output = DMatrix<f64>;

    #[inline(always)]
    fn with<L: Lanes>(self, _: L) -> DMatrix<f64> {
        let dimensions = self.mean.len();
        let mut feature = vec![0.0; dimensions];
        let mut sums = DMatrix::<f64>::zeros(dimensions, dimensions);
        for window in self.windows {
            self.features.write(*window, &mut feature);
            feature.iter_mut().zip(self.mean).for_each(|(x, mean)| *x -= mean);
            for (column, x) in feature.iter().enumerate() {
                let column = &mut sums.as_mut_slice()[column * dimensions..][..dimensions];
                column.iter_mut().zip(&feature).for_each(|(sum, y)| *sum += x * y);
            }
        }
        sums
    }
}
