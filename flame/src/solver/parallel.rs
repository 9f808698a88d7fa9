//! Work on arrays, shared out in portions that are worth a thread's while: waking one costs as much as some thousand
//! cells. How many threads there are changes no result.

use rayon::iter::MinLen;
use rayon::prelude::*;
use rayon::slice::ChunksMut;

/// Elements of the smallest portion.
pub(crate) const PORTION: usize = 16_384;

/// The planes of an array, `plane` elements each.
pub(crate) fn planes<T: Send>(values: &mut [T], plane: usize) -> MinLen<ChunksMut<'_, T>> {
    values.par_chunks_mut(plane).with_min_len((PORTION / plane).max(1))
}

/// Runs `work` with the widest arithmetic that the machine has. Operations stay what they are and where they are, so no
/// result depends on it.
#[inline(always)]
pub(crate) fn wide<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// The elements of an array.
pub(crate) fn elements<T: Send>(values: &mut [T]) -> MinLen<rayon::slice::IterMut<'_, T>> {
    values.par_iter_mut().with_min_len(PORTION)
}

/// The elements of a plane with their places in it, row after row of `length`.
pub(crate) fn rows<T>(plane: &mut [T], length: usize) -> impl Iterator<Item = ([usize; 2], &mut T)> {
    let rows = plane.chunks_exact_mut(length).enumerate();
    rows.flat_map(|(j, row)| row.iter_mut().enumerate().map(move |(k, element)| ([j, k], element)))
}
