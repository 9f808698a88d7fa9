//! Joining of two fields.

use std::collections::BTreeSet;

use super::{BLOCK, BLOCK_VOXELS, Grid, Transform, filled, slot};

/// Tolerance of voxel positions relative to their edge, for rounding.
const SAME_PLACE: f64 = 1e-3;

/// Largest distance between two fields, in voxels.
const MOST_APART: f64 = (1 << 28) as f64;

/// Largest number of blocks that a field's tiles may become if they do not align with the other's.
const MOST_BLOCKS: usize = 1 << 15;

impl<const N: usize> Grid<N> {
    /// Both fields combined voxel by voxel with `join`, on this field's voxels. None if the other's voxels do not
    /// coincide with these, or if too many of them would have to be written out.
    pub fn joined(&self, other: &Self, join: impl Fn(f32, f32) -> f32) -> Option<Self> {
        let offset = self.transform.voxels_to(&other.transform)?;
        let moved;
        let other = if offset == [0; 3] {
            other
        } else {
            moved = other.moved(offset)?;
            &moved
        };
        let both = |a: [f32; N], b: [f32; N]| std::array::from_fn(|n| join(a[n], b[n]));
        let mut joined = Self::new(both(self.background, other.background), self.transform);
        for (log2, origin) in self.tiles.keys().chain(other.tiles.keys()) {
            let value = both(self.around(*log2, *origin), other.around(*log2, *origin));
            joined.add_tile(*origin, *log2, value);
        }
        for key in self.blocks.keys().chain(other.blocks.keys()) {
            joined.fill_block(*key, |index| both(self.value(index), other.value(index)));
        }
        Some(joined)
    }

    /// The value around a cube of 2^`log2` voxels, ignoring smaller parts of it.
    fn around(&self, log2: u32, origin: [i32; 3]) -> [f32; N] {
        let mut wide_enough = self.tile_sizes.iter().filter(|size| **size >= log2);
        let tile = wide_enough.find_map(|size| self.tiles.get(&(*size, origin.map(|i| (i >> size) << size))));
        *tile.unwrap_or(&self.background)
    }

    /// The field moved by `offset` voxels, in blocks only: tiles must lie at multiples of their size.
    fn moved(&self, offset: [i32; 3]) -> Option<Self> {
        let blocks = self.blocks.keys().map(|key| (key.map(|i| i * BLOCK), 3));
        let tiles = self.tiles.keys().map(|(log2, origin)| (*origin, *log2));
        let mut keys = BTreeSet::new();
        for (origin, log2) in blocks.chain(tiles) {
            let mut low = [0; 3];
            let mut high = [0; 3];
            for axis in 0..3 {
                let first = origin[axis].checked_add(offset[axis])?;
                (low[axis], high[axis]) = (first >> 3, first.checked_add((1 << log2) - 1)? >> 3);
            }
            // At most an edge of 2^9 blocks each: nothing overflows, and the limit ends the loop soon.
            for key in keys_within(low, high) {
                keys.insert(key);
                if keys.len() > self.blocks.len() * 8 + MOST_BLOCKS {
                    return None;
                }
            }
        }
        let mut moved = Self::new(self.background, self.transform);
        for key in keys {
            moved.fill_block(key, |index| self.value(std::array::from_fn(|axis| index[axis] - offset[axis])));
        }
        Some(moved)
    }

    fn fill_block(&mut self, key: [i32; 3], value: impl Fn([i32; 3]) -> [f32; N]) {
        let mut block = filled([0.0; N]);
        for number in 0..BLOCK_VOXELS as i32 {
            let within = [number / (BLOCK * BLOCK), number / BLOCK % BLOCK, number % BLOCK];
            let index = std::array::from_fn(|axis| key[axis] * BLOCK + within[axis]);
            block[slot(within)] = value(index);
        }
        self.blocks.insert(key, block);
    }
}

fn keys_within(low: [i32; 3], high: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    let along = move |axis: usize| low[axis]..=high[axis];
    along(0).flat_map(move |x| along(1).flat_map(move |y| along(2).map(move |z| [x, y, z])))
}

impl Transform {
    /// Offset of the other grid in voxels; none if the two grids are not aligned.
    fn voxels_to(&self, other: &Self) -> Option<[i32; 3]> {
        let edges = self.voxel_edges();
        let is_same = (0..3).all(|row| {
            (0..3).all(|axis| (self.rows[row][axis] - other.rows[row][axis]).abs() <= SAME_PLACE * 1e-3 * edges[row])
        });
        let offset = self.to_index(other.translation);
        let is_whole = |i: &f64| i.abs() < MOST_APART && (i - i.round()).abs() <= SAME_PLACE;
        (is_same && offset.iter().all(is_whole)).then(|| offset.map(|i| i.round() as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A few voxels and two tiles with distinct numbers.
    fn field(translation: [f64; 3], scale: f32) -> Grid<1> {
        let transform = Transform::uniform(0.5, translation).unwrap();
        let values: Vec<[f32; 1]> = (0..1000).map(|n| [scale * n as f32]).collect();
        let mut grid = Grid::dense([10; 3], &values, transform).unwrap();
        grid.add_tile([64, 0, 0], 3, [scale * 7.0]);
        grid.add_tile([-128, 0, 0], 7, [scale * 9.0]);
        grid
    }

    #[test]
    fn fields_a_whole_number_of_voxels_apart_are_summed_in_the_world() {
        for translation in [[0.0; 3], [1.5, -2.0, 0.5], [4.0, 0.0, 0.0], [-16.0, 8.0, 64.0]] {
            let (a, b) = (field([0.0; 3], 1.0), field(translation, 0.125));
            let sum = a.joined(&b, |a, b| a + b).unwrap();
            for number in 0..50_000i32 {
                // Strides without a common factor pass through every part.
                let index = [number * 7 % 300 - 150, number * 11 % 170 - 20, number * 13 % 190 - 20];
                let in_b = b.transform().to_index(sum.transform().to_world(index.map(f64::from)));
                let expected = a.value(index)[0] + b.value(in_b.map(|i| i.round() as i32))[0];
                assert_eq!(sum.value(index), [expected], "{translation:?}: {index:?}");
            }
        }
    }

    #[test]
    fn fields_whose_voxels_lie_between_each_others_are_not_joined() {
        let add = |a: f32, b: f32| a + b;
        let a = field([0.0; 3], 1.0);
        assert_eq!(a.joined(&field([0.2, 0.0, 0.0], 1.0), add), None);
        let finer = Grid::new([0.0], Transform::uniform(0.25, [0.0; 3]).unwrap());
        assert_eq!(a.joined(&finer, add), None);
        let mut vast = field([0.5, 0.0, 0.0], 1.0);
        vast.add_tile([4096, 0, 0], 12, [1.0]);
        assert_eq!(a.joined(&vast, add), None);
    }
}
