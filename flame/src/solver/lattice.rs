//! Arrays of samples on a regular lattice, with interpolation between the samples.

use super::domain::{Domain, cell_index};

/// Positions of an array's samples, and the boundary conditions of its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    pub shape: [usize; 3],
    /// Position of sample (0, 0, 0) in cells.
    origin: [f32; 3],
    /// Samples after which an axis repeats; 0 if it ends, and keeps its last value.
    period: [usize; 3],
}

/// The samples around a position along one axis.
type Bracket = (usize, usize, f32);

impl Lattice {
    /// Lattice of the centres of a box's cells.
    pub fn centres(domain: &Domain) -> Self {
        let period = std::array::from_fn(|axis| if domain.is_periodic(axis) { domain.shape()[axis] } else { 0 });
        Self { shape: domain.shape(), origin: [0.0; 3], period }
    }

    /// Lattice of the faces of a box's cells across `axis`.
    pub fn faces(domain: &Domain, axis: usize) -> Self {
        let mut lattice = Self { shape: domain.face_shape(axis), ..Self::centres(domain) };
        lattice.origin[axis] = -0.5;
        lattice
    }

    /// Lattice of a cube that repeats in all directions.
    pub fn repeating(size: usize) -> Self {
        Self { shape: [size; 3], origin: [0.0; 3], period: [size; 3] }
    }

    /// Position of a sample in cells.
    #[inline(always)]
    pub fn position(&self, i: usize, j: usize, k: usize) -> [f32; 3] {
        [self.origin[0] + i as f32, self.origin[1] + j as f32, self.origin[2] + k as f32]
    }

    /// The sample before (or after, if `upper`) another along an axis; at an end that does not repeat, the sample
    /// itself.
    #[inline(always)]
    pub fn beside(&self, axis: usize, sample: usize, upper: bool) -> usize {
        let (size, period) = (self.shape[axis], self.period[axis]);
        match (upper, sample) {
            (false, 0) if period > 0 => period - 1,
            (false, _) => sample.saturating_sub(1),
            // The face that closes a period is its first.
            (true, _) if period > 0 => (sample + 1) % period,
            (true, _) => (sample + 1).min(size - 1),
        }
    }

    /// The value at a position in cells, by trilinear interpolation.
    #[inline(always)]
    pub fn sample<const N: usize>(&self, field: &[[f32; N]], position: [f32; 3]) -> [f32; N] {
        let [x, y, z] = self.brackets(position);
        let along_z = |i: usize, j: usize| {
            let [a, b] = self.pair(field, i, j, z);
            mix(a, b, z.2)
        };
        let along_y = |i: usize| mix(&along_z(i, y.0), &along_z(i, y.1), y.2);
        mix(&along_y(x.0), &along_y(x.1), x.2)
    }

    /// [`Self::sample`] at several positions at once: the same numbers, bit for bit.
    #[inline(always)]
    pub fn sample_lanes<const N: usize>(&self, field: &[[f32; N]], positions: &Positions) -> Samples<N> {
        let brackets = self.lane_brackets(positions);
        mix_corners(&self.corners(field, &brackets), &brackets)
    }

    /// As [`Self::sample_lanes`], with the smallest and the largest of the eight values around each position.
    #[inline(always)]
    pub fn sample_lanes_with_range<const N: usize>(
        &self,
        field: &[[f32; N]],
        positions: &Positions,
    ) -> (Samples<N>, [Samples<N>; 2]) {
        let brackets = self.lane_brackets(positions);
        let corners = self.corners(field, &brackets);
        let (mut low, mut high) = (corners[0], corners[0]);
        for corner in &corners[1..] {
            for lane in 0..LANES {
                for n in 0..N {
                    low[lane][n] = low[lane][n].min(corner[lane][n]);
                    high[lane][n] = high[lane][n].max(corner[lane][n]);
                }
            }
        }
        (mix_corners(&corners, &brackets), [low, high])
    }

    /// Values at the eight corners round each lane's position: x slowest.
    #[inline(always)]
    fn corners<const N: usize>(&self, field: &[[f32; N]], brackets: &[LaneBracket; 3]) -> [Samples<N>; 8] {
        let [_, ny, nz] = self.shape;
        let [x, y, z] = brackets;
        std::array::from_fn(|corner| {
            let ends = [corner >> 2, corner >> 1 & 1, corner & 1];
            std::array::from_fn(|lane| {
                let [i, j, k] = [x.samples[ends[0]][lane], y.samples[ends[1]][lane], z.samples[ends[2]][lane]]
                    .map(|at| at as usize);
                field[(i * ny + j) * nz + k]
            })
        })
    }

    #[inline(always)]
    fn lane_brackets(&self, positions: &Positions) -> [LaneBracket; 3] {
        std::array::from_fn(|axis| {
            let (size, period) = (self.shape[axis], self.period[axis]);
            let from = positions[axis].map(|x| x - self.origin[axis]);
            let mut found = LaneBracket { samples: [[0; LANES]; 2], shares: [0.0; LANES] };
            if period > 0 {
                for (lane, x) in from.into_iter().enumerate() {
                    let (low, high, share) = bracket(x, size, period);
                    (found.samples[0][lane], found.samples[1][lane]) = (low as u32, high as u32);
                    found.shares[lane] = share;
                }
            } else {
                let (last, last_low) = ((size - 1) as f32, size as i32 - 2);
                for (lane, x) in from.into_iter().enumerate() {
                    let clamped = x.max(0.0).min(last);
                    let low = (clamped as i32).min(last_low);
                    (found.samples[0][lane], found.samples[1][lane]) = (low as u32, low as u32 + 1);
                    found.shares[lane] = clamped - low as f32;
                }
            }
            found
        })
    }

    /// The samples of a bracket in row (i, j).
    #[inline(always)]
    fn pair<'a, const N: usize>(&self, field: &'a [[f32; N]], i: usize, j: usize, z: Bracket) -> [&'a [f32; N]; 2] {
        let row = cell_index(self.shape, i, j, 0);
        // Usually they are adjacent, and one bounds check is enough.
        match field.get(row + z.0..row + z.0 + 2) {
            Some([a, b]) if z.1 == z.0 + 1 => [a, b],
            _ => [&field[row + z.0], &field[row + z.1]],
        }
    }

    #[inline(always)]
    fn brackets(&self, position: [f32; 3]) -> [Bracket; 3] {
        std::array::from_fn(|axis| bracket(position[axis] - self.origin[axis], self.shape[axis], self.period[axis]))
    }
}

/// Number of positions that are processed together.
pub(crate) const LANES: usize = 8;

/// Positions in cells: an array of lanes for each axis.
pub(crate) type Positions = [[f32; LANES]; 3];

/// A value per lane.
pub(crate) type Samples<const N: usize> = [[f32; N]; LANES];

/// The samples before and after several positions along one axis, and the fraction between them.
struct LaneBracket {
    samples: [[u32; LANES]; 2],
    shares: [f32; LANES],
}

#[inline(always)]
fn mix_corners<const N: usize>(corners: &[Samples<N>; 8], [x, y, z]: &[LaneBracket; 3]) -> Samples<N> {
    let along_z = |at: usize| mix_lanes(&corners[at], &corners[at + 1], &z.shares);
    let along_y = |at: usize| mix_lanes(&along_z(at), &along_z(at + 2), &y.shares);
    mix_lanes(&along_y(0), &along_y(4), &x.shares)
}

#[inline(always)]
fn mix_lanes<const N: usize>(a: &Samples<N>, b: &Samples<N>, shares: &[f32; LANES]) -> Samples<N> {
    std::array::from_fn(|lane| mix(&a[lane], &b[lane], shares[lane]))
}

/// The samples before and after `x`, and the fraction between them. Both exist for any `x`, NaN included.
#[inline(always)]
fn bracket(x: f32, size: usize, period: usize) -> Bracket {
    if period > 0 {
        let wrapped = x - (x / period as f32).floor() * period as f32;
        let low = (wrapped as i32 as usize).min(period - 1);
        // An array of faces holds its first sample a second time at the end.
        let high = if low + 1 < size { low + 1 } else { 0 };
        (low, high, (wrapped - low as f32).clamp(0.0, 1.0))
    } else {
        let clamped = x.max(0.0).min((size - 1) as f32);
        let low = (clamped as i32 as usize).min(size - 2);
        (low, low + 1, clamped - low as f32)
    }
}

#[inline(always)]
fn mix<const N: usize>(a: &[f32; N], b: &[f32; N], share: f32) -> [f32; N] {
    std::array::from_fn(|n| a[n] + share * (b[n] - a[n]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::domain::Side;
    use crate::solver::random::Random;

    /// Inside, at the ends, far beyond them, and where there is no number.
    #[test]
    fn lanes_hold_what_single_samples_are() {
        let mut random = Random::new(3);
        for side in [Side::Open, Side::Periodic] {
            let domain = Domain::new([6, 5, 9], 0.1, [[side; 2]; 3]).unwrap();
            for lattice in [Lattice::centres(&domain), Lattice::faces(&domain, 0), Lattice::faces(&domain, 2)] {
                let cells: usize = lattice.shape.iter().product();
                let field: Vec<[f32; 2]> =
                    (0..cells).map(|_| [random.normal() as f32, random.normal() as f32]).collect();
                for _ in 0..200 {
                    let mut positions: Positions =
                        std::array::from_fn(|_| std::array::from_fn(|_| 14.0 * random.uniform() as f32 - 3.0));
                    positions[1][3] = f32::NAN;
                    positions[2][4] = 1e30;
                    let found = lattice.sample_lanes(&field, &positions);
                    let (again, [low, high]) = lattice.sample_lanes_with_range(&field, &positions);
                    for lane in 0..LANES {
                        let expected = lattice.sample(&field, positions.map(|axis| axis[lane]));
                        // NaN is not equal to itself; both must be NaN, with any bits.
                        let is_same = |x: &f32, y: &f32| x == y || x.is_nan() && y.is_nan();
                        let are_same = |found: [f32; 2]| found.iter().zip(&expected).all(|(x, y)| is_same(x, y));
                        assert!(are_same(found[lane]) && are_same(again[lane]), "{positions:?}");
                        // On a repeating axis, a NaN position has a NaN value.
                        for n in (0..2).filter(|n| !expected[*n].is_nan()) {
                            assert!(low[lane][n] <= expected[n] + 1e-6 && expected[n] <= high[lane][n] + 1e-6);
                        }
                    }
                }
            }
        }
    }
}
