//! Arrays as fields: the roles of the axes, and blocks only where there are values.

use std::io::Read;

use super::header::Header;
use crate::grid::{BLOCK, BLOCK_VOXELS, Grid, Part, Region, Transform, slot};
use crate::import::budget::Budget;
use crate::import::error::{FormatFault, damaged};

/// Longest edge of a field, in voxels.
const LONGEST_EDGE: usize = 1 << 20;

/// Largest number of blocks in the box around a field, including empty ones.
const MOST_BLOCKS: u64 = 1 << 22;

/// Memory of a block besides its voxels, generously.
const BLOCK_OVERHEAD_BYTES: usize = 128;

/// Numbers per voxel of the field in an array: 1 for axes x, y, z; 3 with one more axis of length 3 at the end or else
/// at the start; 0 for anything else.
pub fn components(shape: &[usize]) -> usize {
    match shape {
        [_, _, _] => 1,
        [_, _, _, 3] | [3, _, _, _] => 3,
        _ => 0,
    }
}

/// Reads an array, or the blocks that a region depends on, as a field whose first voxel is at index (0, 0, 0); zero
/// outside. `reader` is just after the header.
pub(in crate::import) fn grid<const N: usize>(
    header: &Header,
    reader: &mut impl Read,
    transform: Transform,
    region: Option<&Region>,
    budget: &mut Budget,
) -> Result<Grid<N>, FormatFault> {
    let axes = Axes::of_header(header)?;
    let mut blocks = Blocks::<N>::new(axes.lengths, region.map(|region| region.within(&transform)), budget)?;
    let mut places = axes.places();
    let mut failure = None;
    header.values(reader, |value| {
        let (index, component) = places.next();
        if let Err(fault) = blocks.put(index, component, value as f32) {
            failure.get_or_insert(fault);
        }
    })?;
    failure.map_or_else(|| Ok(blocks.into_grid(transform)), Err)
}

/// An array's axes: 0 to 2 are x to z, 3 is the component.
struct Axes {
    /// The axes with their lengths, fastest index first.
    fastest_first: Vec<(usize, usize)>,
    /// Lengths along x, y, z.
    lengths: [usize; 3],
}

impl Axes {
    fn of_header(header: &Header) -> Result<Self, FormatFault> {
        let (order, lengths): (&[usize], _) = match *header.shape.as_slice() {
            [x, y, z] => (&[0, 1, 2], [x, y, z]),
            [x, y, z, 3] => (&[0, 1, 2, 3], [x, y, z]),
            [3, x, y, z] => (&[3, 0, 1, 2], [x, y, z]),
            _ => return damaged(format!("an array of shape {:?} is not a field", header.shape)),
        };
        let mut fastest_first: Vec<_> = order.iter().copied().zip(header.shape.iter().copied()).collect();
        if !header.fortran_order {
            fastest_first.reverse();
        }
        Ok(Self { fastest_first, lengths })
    }

    fn places(&self) -> Places {
        Places { fastest_first: self.fastest_first.clone(), at: [0; 4] }
    }
}

/// Iterator over an array's elements in storage order.
struct Places {
    fastest_first: Vec<(usize, usize)>,
    at: [usize; 4],
}

impl Places {
    /// The index and the component of the next value.
    fn next(&mut self) -> ([usize; 3], usize) {
        let [x, y, z, component] = self.at;
        for (axis, length) in &self.fastest_first {
            self.at[*axis] += 1;
            if self.at[*axis] < *length {
                break;
            }
            self.at[*axis] = 0;
        }
        ([x, y, z], component)
    }
}

/// The blocks of a box, allocated when the first non-zero value arrives.
struct Blocks<'b, const N: usize> {
    blocks: Vec<Option<Box<[[f32; N]; BLOCK_VOXELS]>>>,
    /// Which of them are needed; all, if not stated.
    needed: Option<Vec<bool>>,
    /// Blocks along x, y, z.
    counts: [usize; 3],
    budget: &'b mut Budget,
}

impl<'b, const N: usize> Blocks<'b, N> {
    fn new(lengths: [usize; 3], part: Option<Part<'_>>, budget: &'b mut Budget) -> Result<Self, FormatFault> {
        if let Some(longest) = lengths.iter().find(|length| **length > LONGEST_EDGE) {
            let (found, allowed) = (*longest as u64, LONGEST_EDGE as u64);
            return Err(FormatFault::TooLarge { what: "voxels along an edge", found, allowed });
        }
        let counts = lengths.map(|length| length.div_ceil(BLOCK as usize));
        // At most 2^17 along each edge, so the product fits.
        let all = counts.iter().map(|count| *count as u64).product::<u64>();
        if all > MOST_BLOCKS {
            return Err(FormatFault::TooLarge { what: "blocks of 8x8x8 voxels", found: all, allowed: MOST_BLOCKS });
        }
        let mut blocks = vec![];
        blocks.resize_with(all as usize, || None);
        let needed = part.map(|part| (0..blocks.len()).map(|number| part.holds(key(number, counts))).collect());
        Ok(Self { blocks, needed, counts, budget })
    }

    fn put(&mut self, index: [usize; 3], component: usize, value: f32) -> Result<(), FormatFault> {
        let [x, y, z] = index.map(|i| i / BLOCK as usize);
        let number = (x * self.counts[1] + y) * self.counts[2] + z;
        let Some(block) = self.blocks.get_mut(number) else { return Ok(()) };
        let is_needed = || self.needed.as_ref().is_none_or(|needed| needed.get(number) == Some(&true));
        // Negative zero is a value like any other.
        if block.is_none() && value.to_bits() != 0 && is_needed() {
            self.budget.keep(size_of::<[[f32; N]; BLOCK_VOXELS]>() + BLOCK_OVERHEAD_BYTES)?;
            *block = Some(Box::new([[0.0; N]; BLOCK_VOXELS]));
        }
        if let Some(number) = block.as_mut().and_then(|block| block[slot(index.map(|i| i as i32))].get_mut(component)) {
            *number = value;
        }
        Ok(())
    }

    fn into_grid(self, transform: Transform) -> Grid<N> {
        let mut grid = Grid::new([0.0; N], transform);
        for (number, block) in self.blocks.into_iter().enumerate() {
            if let Some(block) = block {
                grid.insert_block(key(number, self.counts), block);
            }
        }
        grid
    }
}

/// The key of a block of a box of `counts` blocks, z fastest.
fn key(number: usize, counts: [usize; 3]) -> [i32; 3] {
    let (row, z) = (number / counts[2].max(1), number % counts[2].max(1));
    [row / counts[1].max(1), row % counts[1].max(1), z].map(|i| i as i32)
}
