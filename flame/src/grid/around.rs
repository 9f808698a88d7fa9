//! A block together with the voxels around it.

use super::{BLOCK, BLOCK_VOXELS, Grid, slot};

/// A block's values, or the constant value in its place.
#[derive(Clone, Copy)]
enum Source<'a, const N: usize> {
    Block(&'a [[f32; N]; BLOCK_VOXELS]),
    Constant([f32; N]),
}

impl<const N: usize> Source<'_, N> {
    /// Copies consecutive values of a row along z, from a slot on.
    fn copy(self, start: usize, row: &mut [[f32; N]]) {
        match self {
            Self::Block(block) => row.copy_from_slice(&block[start..start + row.len()]),
            Self::Constant(value) => row.fill(value),
        }
    }
}

/// The key of one of the 27 blocks around and including the one at `key`, x slowest.
pub(crate) fn neighbour_key(key: [i32; 3], n: usize) -> [i32; 3] {
    let offset = [n / 9, n / 3 % 3, n % 3];
    std::array::from_fn(|axis| key[axis] + offset[axis] as i32 - 1)
}

impl<const N: usize> Grid<N> {
    /// Copies the block at `key` (index / 8) with the voxel before it and the `after` (1-8) voxels after it along each axis, x slowest;
    /// `values` has as many places. Returns whether it contains more than one value.
    pub(crate) fn copy_around(&self, key: [i32; 3], after: usize, values: &mut [[f32; N]]) -> bool {
        let sources: [Source<'_, N>; 27] = std::array::from_fn(|n| {
            let key = neighbour_key(key, n);
            match self.block(key) {
                Some(block) => Source::Block(block),
                // No tile is smaller than a block.
                None => Source::Constant(self.outside_blocks(key.map(|key| key * BLOCK))),
            }
        });
        let edge = BLOCK as usize;
        let reach = edge + 1 + after;
        for (n, row) in values.chunks_exact_mut(reach).enumerate() {
            let [x, y] = [n / reach, n % reach].map(|i| i + edge - 1);
            let [before, within, beyond] = std::array::from_fn(|z| sources[(x / edge * 3 + y / edge) * 3 + z]);
            let start = slot([x as i32, y as i32, 0]);
            let (first, rest) = row.split_at_mut(1);
            let (middle, last) = rest.split_at_mut(edge);
            before.copy(start + edge - 1, first);
            within.copy(start, middle);
            beyond.copy(start, last);
        }
        let Source::Constant(first) = sources[0] else { return true };
        !sources.iter().all(|source| matches!(source, Source::Constant(value) if *value == first))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Transform;

    #[test]
    fn a_block_is_copied_with_its_surroundings() {
        let mut grid = Grid::new([-1.0], Transform::identity());
        for key in [[0, 0, 0], [1, 0, -1], [0, 1, 1], [-1, -1, -1]] {
            for (n, value) in grid.block_mut(key).iter_mut().enumerate() {
                *value = [(n as i32 + 600 * (key[0] + 3 * key[1] + 9 * key[2])) as f32];
            }
        }
        grid.add_tile([8, 8, 8], 3, [7.5]);
        for (key, after) in [([0, 0, 0], 1), ([0, 0, 0], 2), ([1, 1, 0], 2), ([0, 0, -1], 1)] {
            let reach = BLOCK as usize + 1 + after;
            let mut values = vec![[0.0]; reach.pow(3)];
            assert!(grid.copy_around(key, after, &mut values));
            for (n, value) in values.iter().enumerate() {
                let within = [n / (reach * reach), n / reach % reach, n % reach];
                let index = std::array::from_fn(|axis| key[axis] * BLOCK + within[axis] as i32 - 1);
                assert_eq!(*value, grid.value(index), "{key:?} {after} {index:?}");
            }
        }
        assert!(!grid.copy_around([9, 9, 9], 1, &mut [[0.0]; 1000]));
    }
}
