//! A part of space, for reading only that part of a grid.

use std::collections::BTreeSet;

use super::{BLOCK, Transform};

/// Voxels before a block's first one from which on interpolated values depend on it: one for the interpolation, and half of one for
/// values on the voxels' faces.
const BEFORE: f64 = 1.5;

/// Share of a voxel that rounding may make. Among the region's own voxels, blocks that only touch it are left out; of others, too many are
/// better than too few.
const MARGIN: f64 = 1e-6;

/// The space of some blocks of 8×8×8 cells of a grid; cell (i, j, k) lies between voxels (i, j, k) and (i+1, j+1, k+1).
#[derive(Debug, Clone)]
pub struct Region {
    keys: BTreeSet<[i32; 3]>,
    transform: Transform,
}

impl Region {
    /// The blocks of cells at `keys` (index / 8) of a grid with this transform.
    pub fn new(keys: impl IntoIterator<Item = [i32; 3]>, transform: Transform) -> Self {
        Self { keys: keys.into_iter().collect(), transform }
    }

    /// The same space among the blocks of a grid with another transform.
    pub fn within(&self, transform: &Transform) -> Part<'_> {
        let margin = if *transform == self.transform { MARGIN } else { -MARGIN };
        Part { keys: &self.keys, map: transform.index_map(&self.transform), margin }
    }
}

/// The blocks of a grid that a [`Region`] depends on.
#[derive(Debug, Clone, Copy)]
pub struct Part<'a> {
    keys: &'a BTreeSet<[i32; 3]>,
    /// Matrix and translation from the grid's indices to the region's.
    map: ([[f64; 3]; 3], [f64; 3]),
    /// Voxels by which blocks are taken to be smaller.
    margin: f64,
}

impl Part<'_> {
    /// True if anything interpolated in the region may depend on the block at `key` (index / 8).
    pub fn holds(&self, key: [i32; 3]) -> bool {
        let first = key.map(|key| f64::from(key) * f64::from(BLOCK) - BEFORE + self.margin);
        let edge = f64::from(BLOCK) + BEFORE - 2.0 * self.margin;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in 0..8 {
            let index: [f64; 3] = std::array::from_fn(|axis| first[axis] + f64::from(corner >> axis & 1) * edge);
            for axis in 0..3 {
                let place = (0..3).map(|of| index[of] * self.map.0[of][axis]).sum::<f64>() + self.map.1[axis];
                // Where numbers overflow the place is unknown, and too many blocks are better than too few.
                if !place.is_finite() {
                    return true;
                }
                (low[axis], high[axis]) = (low[axis].min(place), high[axis].max(place));
            }
        }
        // Conversion saturates: no key is beyond the range of its type.
        let key_of = |place: f64| (place / f64::from(BLOCK)).floor() as i32;
        let (low, high) = (low.map(key_of), high.map(key_of));
        let count = (0..3).map(|axis| i128::from(high[axis]) - i128::from(low[axis]) + 1).product::<i128>();
        let is_between = |key: &[i32; 3]| (0..3).all(|axis| (low[axis]..=high[axis]).contains(&key[axis]));
        if count > self.keys.len() as i128 {
            return self.keys.iter().any(is_between);
        }
        (low[0]..=high[0]).any(|x| {
            // Of all keys with this x, those from the lowest to the highest.
            self.keys.range([x, low[1], low[2]]..=[x, high[1], high[2]]).any(is_between)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(voxel_size: f64, origin: [f64; 3]) -> Transform {
        Transform::uniform(voxel_size, origin).unwrap()
    }

    #[test]
    fn a_region_holds_its_own_blocks_and_the_next_ones() {
        let region = Region::new([[0, 0, 0], [5, -3, 2]], grid(0.5, [0.0; 3]));
        let same = grid(0.5, [0.0; 3]);
        for x in -3..8 {
            for y in -6..4 {
                for z in -3..6 {
                    let key = [x, y, z];
                    let is_near = |of: [i32; 3]| (0..3).all(|axis| (0..=1).contains(&(key[axis] - of[axis])));
                    let expected = is_near([0, 0, 0]) || is_near([5, -3, 2]);
                    assert_eq!(region.within(&same).holds(key), expected, "{key:?}");
                }
            }
        }
    }

    #[test]
    fn a_region_is_found_among_blocks_of_any_size() {
        let region = Region::new([[1, 1, 1]], grid(1.0, [0.0; 3]));
        // All of space in one block, and 80 blocks along the region's edge.
        assert!(region.within(&grid(1e6, [0.0; 3])).holds([0, 0, 0]));
        assert!(!region.within(&grid(1e6, [0.0; 3])).holds([2, 0, 0]));
        let fine = grid(0.0125, [0.0; 3]);
        assert!(region.within(&fine).holds([120, 120, 120]) && !region.within(&fine).holds([78, 120, 120]));
        // The middle of the region is at 12; a grid that begins there has it in its first block.
        assert!(region.within(&grid(1.0, [12.0; 3])).holds([0, 0, 0]));
        assert!(!region.within(&grid(1.0, [40.0; 3])).holds([0, 0, 0]));
        assert!(!Region::new([], fine).within(&fine).holds([0, 0, 0]));
    }

    #[test]
    fn transforms_that_overflow_leave_nothing_out() {
        let small = 1e-9 * std::f64::consts::FRAC_1_SQRT_2;
        let rows = [[small, small, 0.0], [-small, small, 0.0], [0.0, 0.0, 1e-9]];
        let turned = Transform::new(rows, [0.0; 3]).unwrap();
        let far = Transform::uniform(1.0, [1e300, 1e300, 0.0]).unwrap();
        assert!(Region::new([[0, 0, 0]], turned).within(&far).holds([0, 0, 0]));
    }
}
