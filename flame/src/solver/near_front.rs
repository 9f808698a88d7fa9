//! The front and the flow around it: the part of a box in which flux is measured.

use std::collections::BTreeSet;

use super::domain::{Domain, cell_index};
use super::faces::Faces;
use crate::error::Error;
use crate::frame::Frame;
use crate::grid::{BLOCK, Grid, slot};
use crate::velocity::{Placement, Velocity};

/// Cells along an edge of a block.
const EDGE: usize = BLOCK as usize;

/// The blocks in which `front` is not zero, with the flow in them and in the blocks next to them. They contain every
/// surface between the two, and everything that its velocity is interpolated from.
pub(crate) fn frame(domain: &Domain, velocity: &Faces, front: &[f32], number: i64) -> Result<Frame, Error> {
    let shape = domain.shape();
    let mut field = Grid::new([0.0], domain.transform()?);
    let mut flow = Grid::new([0.0; 3], domain.transform()?);
    let counts = shape.map(|size| size.div_ceil(EDGE));
    let mut near = BTreeSet::new();
    let keys = (0..counts[0]).flat_map(|x| (0..counts[1]).flat_map(move |y| (0..counts[2]).map(move |z| [x, y, z])));
    for key in keys {
        let burns = runs(shape, key).any(|(cell, size)| {
            let start = cell_index(shape, cell[0], cell[1], cell[2]);
            front[start..start + size].iter().any(|value| *value != 0.0)
        });
        if !burns {
            continue;
        }
        let block = field.block_mut(key.map(|key| key as i32));
        for (cell, size) in runs(shape, key) {
            let (start, into) = (cell_index(shape, cell[0], cell[1], cell[2]), slot(cell.map(|at| at as i32)));
            block[into..into + size].as_flattened_mut().copy_from_slice(&front[start..start + size]);
        }
        let beside = |axis: usize| key[axis].saturating_sub(1)..=(key[axis] + 1).min(counts[axis] - 1);
        near.extend(beside(0).flat_map(|x| beside(1).flat_map(move |y| beside(2).map(move |z| [x, y, z]))));
    }
    for key in near {
        let block = flow.block_mut(key.map(|key| key as i32));
        for (cell, size) in runs(shape, key) {
            let into = slot(cell.map(|at| at as i32));
            velocity.row_to_centres(domain, cell, &mut block[into..into + size]);
        }
    }
    Ok(Frame { number, field, velocity: Velocity::Vectors(flow, Placement::Collocated) })
}

/// The runs along z of a block's cells that lie in the box: first cell and number of cells.
fn runs(shape: [usize; 3], key: [usize; 3]) -> impl Iterator<Item = ([usize; 3], usize)> {
    let range = move |axis: usize| key[axis] * EDGE..(key[axis] * EDGE + EDGE).min(shape[axis]);
    let size = range(2).len();
    range(0).flat_map(move |i| range(1).map(move |j| ([i, j, range(2).start], size)))
}
