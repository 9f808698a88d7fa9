//! Arrays of samples on a regular lattice, and values between the samples.

use super::domain::{Domain, at};

/// Where an array's samples stand, and what its axes do at their ends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    pub shape: [usize; 3],
    /// Position of sample (0, 0, 0) in cells.
    origin: [f32; 3],
    /// Samples after which an axis repeats; 0 where it ends, and keeps its last value.
    period: [usize; 3],
}

/// The samples around a place along one axis.
type Bracket = (usize, usize, f32);

impl Lattice {
    /// The centres of a box's cells.
    pub fn centres(domain: &Domain) -> Self {
        let period = std::array::from_fn(|axis| if domain.is_periodic(axis) { domain.shape()[axis] } else { 0 });
        Self { shape: domain.shape(), origin: [0.0; 3], period }
    }

    /// The faces of a box's cells across `axis`.
    pub fn faces(domain: &Domain, axis: usize) -> Self {
        let mut lattice = Self { shape: domain.face_shape(axis), ..Self::centres(domain) };
        lattice.origin[axis] = -0.5;
        lattice
    }

    /// A cube that repeats in all directions.
    pub fn repeating(size: usize) -> Self {
        Self { shape: [size; 3], origin: [0.0; 3], period: [size; 3] }
    }

    /// Position of a sample in cells.
    #[inline(always)]
    pub fn position(&self, i: usize, j: usize, k: usize) -> [f32; 3] {
        [self.origin[0] + i as f32, self.origin[1] + j as f32, self.origin[2] + k as f32]
    }

    /// The sample before (or after, `upper`) one along an axis; at an end that does not repeat, itself.
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

    /// The value at a position in cells, trilinear.
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

    /// As [`Self::sample`], with the smallest and the largest of the eight values that it lies between.
    #[inline(always)]
    pub fn sample_with_range<const N: usize>(&self, field: &[[f32; N]], position: [f32; 3]) -> [[f32; N]; 3] {
        let [x, y, z] = self.brackets(position);
        let mut range = [[f32::INFINITY; N], [f32::NEG_INFINITY; N]];
        let mut along_z = |i: usize, j: usize| {
            let [a, b] = self.pair(field, i, j, z);
            range = [
                std::array::from_fn(|n| range[0][n].min(a[n]).min(b[n])),
                std::array::from_fn(|n| range[1][n].max(a[n]).max(b[n])),
            ];
            mix(a, b, z.2)
        };
        let before = mix(&along_z(x.0, y.0), &along_z(x.0, y.1), y.2);
        let after = mix(&along_z(x.1, y.0), &along_z(x.1, y.1), y.2);
        [mix(&before, &after, x.2), range[0], range[1]]
    }

    /// The samples of a bracket in row (i, j).
    #[inline(always)]
    fn pair<'a, const N: usize>(&self, field: &'a [[f32; N]], i: usize, j: usize, z: Bracket) -> [&'a [f32; N]; 2] {
        let row = at(self.shape, i, j, 0);
        // Mostly they lie side by side, and their bounds need one look.
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

/// The samples before and after `x`, and how far between them it lies. Whatever `x` is, NaN included, both exist.
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
