//! Parallel work on arrays, in portions large enough to be worth a thread: waking one costs as much as some thousand
//! cells. The number of threads does not affect any result.

use rayon::iter::MinLen;
use rayon::prelude::*;
use rayon::slice::ChunksMut;

/// Elements of the smallest portion.
pub(crate) const PORTION: usize = 16_384;

/// The planes of an array, `plane` elements each.
pub(crate) fn planes<T: Send>(values: &mut [T], plane: usize) -> MinLen<ChunksMut<'_, T>> {
    values.par_chunks_mut(plane).with_min_len((PORTION / plane).max(1))
}

/// Runs `work` with the widest arithmetic that the machine has. The operations and their order do not change, so no
/// result depends on it.
#[inline(always)]
pub(crate) fn wide<R>(work: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(work)
}

/// The elements of an array.
pub(crate) fn elements<T: Send>(values: &mut [T]) -> MinLen<rayon::slice::IterMut<'_, T>> {
    values.par_iter_mut().with_min_len(PORTION)
}

/// The elements of a plane with their positions in it, in rows of `length`.
pub(crate) fn rows<T>(plane: &mut [T], length: usize) -> impl Iterator<Item = ([usize; 2], &mut T)> {
    let rows = plane.chunks_exact_mut(length).enumerate();
    rows.flat_map(|(j, row)| row.iter_mut().enumerate().map(move |(k, element)| ([j, k], element)))
}

/// Number of lanes in a search for the largest value; the maximum is the same in any order.
const LANES: usize = 16;

/// Largest magnitude; infinite if a value is not a number, 0 if there is none.
pub(crate) fn largest(values: &[f32]) -> f32 {
    let part = |part: &[f32]| {
        wide(|| {
            let mut most = [0.0f32; LANES];
            let mut is_number = [true; LANES];
            let (chunks, rest) = part.as_chunks::<LANES>();
            let mut look = |lane: usize, value: f32| {
                most[lane] = most[lane].max(value.abs());
                is_number[lane] &= !value.is_nan();
            };
            for chunk in chunks {
                for (lane, value) in chunk.iter().enumerate() {
                    look(lane, *value);
                }
            }
            rest.iter().for_each(|value| look(0, *value));
            if is_number == [true; LANES] { most.iter().fold(0.0, |a, b| b.max(a)) } else { f32::INFINITY }
        })
    };
    values.par_chunks(PORTION).map(part).reduce(|| 0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_magnitude_is_found_wherever_it_stands() {
        for at in [0, 15, 16, 100, 40_000, 49_999] {
            let mut values = vec![0.5; 50_000];
            values[at] = -3.0;
            assert_eq!(largest(&values), 3.0, "{at}");
            values[at] = f32::NAN;
            assert_eq!(largest(&values), f32::INFINITY, "{at}");
        }
        assert_eq!(largest(&[]), 0.0);
    }
}
