//! The cells that can contain the surface. Cell (i, j, k) lies between voxels (i, j, k) and (i+1, j+1, k+1).

use std::collections::BTreeMap;

use super::spline::Patch;
use crate::error::Error;
use crate::grid::{BLOCK, BLOCK_VOXELS, Grid, neighbour_key};

/// Largest number of blocks of cells that the boundaries of a field's tiles may touch; a real flame's touch some
/// thousands.
const MAX_TILE_BLOCKS: u128 = 1 << 22;

/// Voxels beyond this index are rejected: arithmetic on them would overflow.
const MAX_INDEX: i64 = 1 << 30;

/// Voxels after a block that its cells depend on, along each axis; there is also one before.
const AFTER: usize = 2;

/// Voxels along each axis that the cells of a block depend on.
const REACH: usize = BLOCK as usize + 1 + AFTER;

/// Voxels in a plane across a block.
const PLANE: usize = (BLOCK * BLOCK) as usize;

/// Bits of a plane's voxels that have a neighbour above, along z.
const ALL_BUT_LAST: u64 = 0x7F7F_7F7F_7F7F_7F7F;

/// Rounding margin for the bounds of a cell, relative to its largest value.
const ROUNDING: f64 = 1e-12;

/// Visits, in ascending order of blocks and of cells in them, every cell of these blocks whose spline can cross
/// `level`.
pub(super) fn visit(field: &Grid<1>, keys: &[[i32; 3]], level: f64, mut visit: impl FnMut([i32; 3], &Patch)) {
    let mut seen = Neighbourhood::new();
    for key in keys {
        if seen.gather(field, *key) {
            seen.crossed(level, |cell, patch| visit(std::array::from_fn(|axis| key[axis] * BLOCK + cell[axis]), patch));
        }
    }
}

/// Keys of the blocks of cells that the surface at `level` can pass through, in ascending order: in and around them there
/// are values on both of its sides.
///
/// # Errors
/// If the tiles have so much surface, or lie so far away, that they cannot be intended.
pub(super) fn candidates(field: &Grid<1>, level: f64) -> Result<Vec<[i32; 3]>, Error> {
    let sides = Sides::new(field, level);
    let mut keys = touched(field)?;
    keys.retain(|key| sides.are_both_around(*key));
    Ok(keys)
}

/// Those of the [`candidates`] `keys` whose own cells depend on values on both sides.
pub(super) fn crossed(field: &Grid<1>, mut keys: Vec<[i32; 3]>, level: f64) -> Vec<[i32; 3]> {
    let mut seen = Neighbourhood::new();
    keys.retain(|key| {
        seen.gather(field, *key);
        let sides = seen.values.iter().fold(0, |sides, [value]| sides | side(*value, level));
        sides == INSIDE | OUTSIDE
    });
    keys
}

/// Keys of the blocks of cells that depend on more than one value: all that touch a block, or the boundary of a tile.
fn touched(field: &Grid<1>) -> Result<Vec<[i32; 3]>, Error> {
    let tile_blocks: u128 = field.tiles().map(|(_, log2, _)| shell_blocks(log2)).sum();
    if tile_blocks > MAX_TILE_BLOCKS {
        return Err(Error::TooLarge { found: tile_blocks, allowed: MAX_TILE_BLOCKS });
    }
    let mut keys = vec![];
    for (key, _) in field.blocks() {
        check_index(key.map(|key| i64::from(key) * i64::from(BLOCK)))?;
        keys.extend(shell([key; 2].map(|key| key.map(i64::from))));
    }
    for (origin, log2, _) in field.tiles() {
        let last = origin.map(|i| i64::from(i) + (1 << log2) - 1);
        check_index(origin.map(i64::from))?;
        check_index(last)?;
        keys.extend(shell([origin.map(i64::from), last].map(|index| index.map(|i| i.div_euclid(i64::from(BLOCK))))));
    }
    keys.sort_unstable();
    keys.dedup();
    Ok(keys)
}

/// The sides of the surface on which the values of a field lie, block by block.
struct Sides<'a> {
    field: &'a Grid<1>,
    level: f64,
    blocks: BTreeMap<[i32; 3], u8>,
}

/// Bits of the two sides.
const INSIDE: u8 = 1;
const OUTSIDE: u8 = 2;

impl<'a> Sides<'a> {
    fn new(field: &'a Grid<1>, level: f64) -> Self {
        let of_block =
            |block: &[[f32; 1]; BLOCK_VOXELS]| block.iter().fold(0, |sides, [value]| sides | side(*value, level));
        let blocks = field.blocks().map(|(key, block)| (key, of_block(block))).collect();
        Self { field, level, blocks }
    }

    /// True if a block and those around it have values on both sides.
    fn are_both_around(&self, key: [i32; 3]) -> bool {
        let mut sides = 0;
        (0..27).map(|n| neighbour_key(key, n)).any(|key| {
            sides |= match self.blocks.get(&key) {
                Some(sides) => *sides,
                // No tile is smaller than a block.
                None => side(self.field.outside_blocks(key.map(|key| key * BLOCK))[0], self.level),
            };
            sides == INSIDE | OUTSIDE
        })
    }
}

fn side(value: f32, level: f64) -> u8 {
    if f64::from(value) > level { INSIDE } else { OUTSIDE }
}

/// Number of pairs of neighbouring voxels in one block, along any axis, on different sides of `level`: about 1.3 times the
/// number of cells that the front crosses.
pub(super) fn pairs_across(field: &Grid<1>, level: f64) -> u64 {
    field.blocks().map(|(_, block)| pairs_in_block(block, level)).sum()
}

fn pairs_in_block(block: &[[f32; 1]; BLOCK_VOXELS], level: f64) -> u64 {
    // One bit for each voxel of a plane across x.
    let planes: [u64; BLOCK as usize] = std::array::from_fn(|x| {
        let plane = &block[x * PLANE..(x + 1) * PLANE];
        plane.iter().enumerate().map(|(n, [value])| u64::from(f64::from(*value) > level) << n).sum()
    });
    let along_x = planes.windows(2).map(|pair| (pair[0] ^ pair[1]).count_ones()).sum::<u32>();
    let within = |plane: &u64| {
        let along_y = (plane ^ plane >> BLOCK) & (u64::MAX >> BLOCK);
        let along_z = (plane ^ plane >> 1) & ALL_BUT_LAST;
        along_y.count_ones() + along_z.count_ones()
    };
    u64::from(along_x + planes.iter().map(within).sum::<u32>())
}

fn check_index(index: [i64; 3]) -> Result<(), Error> {
    if index.iter().any(|i| i.abs() >= MAX_INDEX) { Err(Error::TooFar { index }) } else { Ok(()) }
}

/// Number of keys that [`shell`] returns for a tile.
fn shell_blocks(log2: u32) -> u128 {
    let edge = 1u128 << log2.clamp(3, 26).saturating_sub(3);
    (edge + 2).pow(3) - edge.saturating_sub(2).pow(3)
}

/// Keys of the blocks of cells at the surface of a cube of blocks: its own outermost blocks and those around it.
fn shell([first, last]: [[i64; 3]; 2]) -> impl Iterator<Item = [i32; 3]> {
    let range = move |axis: usize| first[axis] - 1..=last[axis] + 1;
    let is_within = move |axis: usize, key: i64| key > first[axis] && key < last[axis];
    range(0).flat_map(move |x| {
        range(1).flat_map(move |y| {
            let hollow = is_within(0, x) && is_within(1, y) && last[2] - first[2] >= 2;
            let (near, far) = if hollow { (first[2], last[2]) } else { (last[2] + 1, last[2] + 2) };
            // In range: check_index has checked both ends.
            (first[2] - 1..=near).chain(far..=last[2] + 1).map(move |z| [x as i32, y as i32, z as i32])
        })
    })
}

/// The voxels that the cells of one block depend on, x slowest.
struct Neighbourhood {
    values: Vec<[f32; 1]>,
}

impl Neighbourhood {
    fn new() -> Self {
        Self { values: vec![[0.0]; REACH.pow(3)] }
    }

    /// Fills the neighbourhood of the block of cells at `key`; returns whether it contains more than one value.
    fn gather(&mut self, field: &Grid<1>, key: [i32; 3]) -> bool {
        field.copy_around(key, AFTER, &mut self.values)
    }

    /// Visits the cells, counted from the block's first, whose spline can cross `level`.
    fn crossed(&self, level: f64, mut visit: impl FnMut([i32; 3], &Patch)) {
        // One bit per voxel of a row along z.
        let mut rows = [[0u16; REACH]; REACH];
        for (n, row) in self.values.chunks_exact(REACH).enumerate() {
            let inside = row.iter().enumerate().map(|(z, [value])| u16::from(f64::from(*value) > level) << z);
            rows[n / REACH][n % REACH] = inside.sum();
        }
        let edge = BLOCK as usize;
        for (x, y) in (0..edge).flat_map(|x| (0..edge).map(move |y| (x, y))) {
            let seen = || rows[x..x + 4].iter().flat_map(|rows| &rows[y..y + 4]);
            let any = seen().fold(0, |any, row| any | row);
            let all = seen().fold(u16::MAX, |all, row| all & row);
            // Bit z now covers the four voxels from z on.
            let any = any | any >> 1 | any >> 2 | any >> 3;
            let all = all & all >> 1 & all >> 2 & all >> 3;
            for z in (0..edge).filter(|z| ((any & !all) >> z) & 1 == 1) {
                let patch = self.patch([x, y, z]);
                let (low, high) = patch.bounds();
                let largest = patch.coefficients.iter().fold(0.0f64, |largest, value| largest.max(value.abs()));
                let margin = ROUNDING * largest;
                if low - margin <= level && high + margin >= level {
                    visit([x, y, z].map(|i| i as i32), &patch);
                }
            }
        }
    }

    fn patch(&self, [x, y, z]: [usize; 3]) -> Patch {
        let at = |n: usize| ((x + (n >> 4)) * REACH + y + ((n >> 2) & 3)) * REACH + z + (n & 3);
        Patch { coefficients: std::array::from_fn(|n| f64::from(self.values[at(n)][0])) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_is_all_but_the_core() {
        for edge in 1..6i64 {
            let (first, last) = ([-3, 0, 7], [-4 + edge, edge - 1, 6 + edge]);
            let mut found: Vec<[i32; 3]> = shell([first, last]).collect();
            found.sort_unstable();
            let all = |axis: usize| (first[axis] - 1..=last[axis] + 1).collect::<Vec<_>>();
            let mut expected = vec![];
            for x in all(0) {
                for y in all(1) {
                    for z in all(2) {
                        let key = [x, y, z];
                        if !(0..3).all(|axis| key[axis] > first[axis] && key[axis] < last[axis]) {
                            expected.push(key.map(|key| key as i32));
                        }
                    }
                }
            }
            assert_eq!(found, expected, "{edge}");
            if edge.count_ones() == 1 {
                assert_eq!(shell_blocks(edge.trailing_zeros() + 3), expected.len() as u128);
            }
        }
    }
}
