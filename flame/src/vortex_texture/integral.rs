//! The source of vortex sound: T = ∫ y (y × w) dy (Dobashi et al. 2004, eq. 1-2, after Powell and Howe).
//!
//! A listener in direction x hears x·T‴x, so only T's symmetric part counts. Because y·(y × w) = 0, it has no trace:
//! five numbers are enough.

use super::series::COMPONENTS;
use super::vorticity::{Vorticity, from_centre, places};

/// The paper's α: an integral cell's weights fall as exp(-α r), r in voxels.
const FALLOFF: f64 = 3.0;

/// Share of the box's edge over which the integral fades in at each side.
const TAPER: f64 = 0.25;

/// Origin of y.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Origin {
    /// The box's centre, with the mean vorticity removed and the integral fading out towards the sides. Otherwise an
    /// eddy that crosses a side, where y is largest, would be the loudest of all: it would vanish (or reappear at the
    /// opposite side) at once.
    Centre,
    /// As printed (eq. 3-4): for every voxel, an integral over its 27 neighbours with the origin at its own centre. In
    /// the interior these cancel, which leaves only the box's sides.
    Cells,
}

/// The integral over a box, prepared for many fields.
#[derive(Debug, Clone)]
pub struct Integral {
    shape: [usize; 3],
    /// For each voxel the second moments of its positions relative to the origins that it is counted from, xx yy zz xy
    /// yz zx, in m⁵: weight, squared distance and volume in one.
    moments: Vec<[f64; 6]>,
    /// Share of each voxel in the mean vorticity to subtract; none if nothing is subtracted.
    shares: Option<Vec<f64>>,
}

impl Integral {
    /// An integral for fields of `shape` voxels of edge `voxel_size_m`.
    pub fn new(shape: [usize; 3], voxel_size_m: f64, origin: Origin) -> Self {
        let volume = maths::powi(voxel_size_m, 3);
        match origin {
            Origin::Centre => {
                let weights: Vec<f64> = places(shape).map(|voxel| taper(shape, voxel)).collect();
                let sum: f64 = weights.iter().sum();
                let moment = |(voxel, weight): ([usize; 3], &f64)| {
                    square(from_centre(shape, voxel_size_m, voxel)).map(|square| weight * volume * square)
                };
                let moments = places(shape).zip(&weights).map(moment).collect();
                let shares = weights.iter().map(|weight| weight / sum).collect();
                Self { shape, moments, shares: Some(shares) }
            }
            Origin::Cells => {
                let moments = places(shape).map(|voxel| cells(shape, voxel));
                let scale = volume * maths::square(voxel_size_m);
                Self { shape, moments: moments.map(|moment| moment.map(|m| scale * m)).collect(), shares: None }
            }
        }
    }

    /// T's symmetric part in m⁵/s: rows of a matrix without trace.
    ///
    /// Excess values of a field with another shape are ignored.
    pub fn tensor(&self, vorticity: &Vorticity) -> [[f64; 3]; 3] {
        debug_assert_eq!(vorticity.shape(), self.shape);
        let mut mean = [0.0; 3];
        for (share, w) in self.shares.iter().flatten().zip(vorticity.values()) {
            mean.iter_mut().zip(w).for_each(|(mean, w)| *mean += share * w);
        }
        let mut tensor = [[0.0; 3]; 3];
        for ([xx, yy, zz, xy, yz, zx], w) in self.moments.iter().zip(vorticity.values()) {
            let [u, v, w] = std::array::from_fn(|axis| w[axis] - mean[axis]);
            // y × w = (y w_z - z w_y, z w_x - x w_z, x w_y - y w_x), times y.
            let rows = [
                [xy * w - zx * v, zx * u - xx * w, xx * v - xy * u],
                [yy * w - yz * v, yz * u - xy * w, xy * v - yy * u],
                [yz * w - zz * v, zz * u - zx * w, zx * v - yz * u],
            ];
            tensor.iter_mut().flatten().zip(rows.iter().flatten()).for_each(|(sum, value)| *sum += value);
        }
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (tensor[i][j] + tensor[j][i])))
    }

    /// T in the basis of [`directivity`](pyrophone_synthesis::vortex::texture::directivity), in m⁵/s: x·Tx is the sum of
    /// the components, each times its directivity.
    pub fn components(&self, vorticity: &Vorticity) -> [f64; COMPONENTS] {
        let t = self.tensor(vorticity);
        let (root5, root15) = (5f64.sqrt(), 15f64.sqrt());
        [
            2.0 * t[0][1] / root15,
            2.0 * t[1][2] / root15,
            2.0 * t[2][0] / root15,
            (t[0][0] - t[1][1]) / root15,
            t[2][2] / root5,
        ]
    }
}

/// Products of a position's coordinates: xx yy zz xy yz zx.
fn square([x, y, z]: [f64; 3]) -> [f64; 6] {
    [x * x, y * y, z * z, x * y, y * z, z * x]
}

/// Weight of a voxel: 1 in the centre, 0 at the sides.
fn taper(shape: [usize; 3], voxel: [usize; 3]) -> f64 {
    let along = |axis: usize| {
        let place = (voxel[axis] as f64 + 0.5) / shape[axis] as f64;
        let share = (place.min(1.0 - place) / TAPER).min(1.0);
        maths::square(maths::sin(0.5 * std::f64::consts::PI * share))
    };
    (0..3).map(along).product()
}

/// Second moments, in voxels², of a voxel's positions in the integral cells that contain it.
fn cells(shape: [usize; 3], voxel: [usize; 3]) -> [f64; 6] {
    let offsets = places([3, 3, 3]).map(|place| place.map(|x| x as i64 - 1));
    let is_inside =
        |offset: &[i64; 3]| (0..3).all(|axis| (0..shape[axis] as i64).contains(&(voxel[axis] as i64 - offset[axis])));
    let (mut sum, mut weights) = ([0.0; 6], 0.0);
    for offset in offsets.filter(is_inside) {
        let offset = offset.map(|x| x as f64);
        let weight = maths::exp(-FALLOFF * crate::grid::length(offset));
        weights += weight;
        sum.iter_mut().zip(square(offset)).for_each(|(sum, square)| *sum += weight * square);
    }
    sum.map(|sum| sum / weights)
}
