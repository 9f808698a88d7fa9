//! Windows and their grid.
//!
//! Window k is a triangle of half-width h centred at sample k h of the host's timeline (§4): the windows sum to 1, and
//! their positions do not depend on the start of playback.

/// Triangle of half-width `half_width`, peak 1 at index `half_width`; the first of its
/// 2 `half_width` values is 0.
pub fn triangle(half_width: usize) -> Vec<f64> {
    let h = half_width as f64;
    (0..2 * half_width).map(|i| 1.0 - (i as f64 - h).abs() / h).collect()
}

/// Samples from the latest position that is `offset` plus a multiple of `hop` to `position`.
pub(crate) fn into_hop(position: i64, offset: usize, hop: usize) -> usize {
    (position - offset as i64).rem_euclid(hop as i64) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_sum_to_one() {
        for half_width in [1, 7, 500] {
            let window = triangle(half_width);
            for i in 0..half_width {
                assert!((window[i] + window[i + half_width] - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_grid_is_absolute() {
        assert_eq!(into_hop(0, 0, 10), 0);
        assert_eq!(into_hop(9, 0, 10), 9);
        assert_eq!(into_hop(-1, 0, 10), 9);
        assert_eq!(into_hop(-25, 3, 10), 2);
    }
}
