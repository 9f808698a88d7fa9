//! Bounds of sixteen boxes.

use super::lanes::{Lanes, STAGE};
use super::sizes::{AXES_MAX, LANES};

/// Squared distances from `point` to sixteen boxes, each axis with its lower and its upper faces, and a mask of those
/// that are at most `limit`; incomplete once there are none.
#[inline(always)]
pub fn box_bounds<L: Lanes>(
    lanes: L,
    faces: &[[[f32; LANES]; 2]],
    point: &[f32; AXES_MAX],
    limit: f32,
) -> (u32, L::Singles) {
    let zero = lanes.splat(0.0);
    let mut sum = zero;
    let mut within = 0;
    for (faces, point) in faces.as_chunks::<STAGE>().0.iter().zip(point.as_chunks::<STAGE>().0) {
        for axis in 0..STAGE {
            let point = lanes.splat(point[axis]);
            let below = lanes.sub(lanes.load(&faces[axis][0]), point);
            let above = lanes.sub(point, lanes.load(&faces[axis][1]));
            let outside = lanes.max(lanes.max(below, above), zero);
            sum = lanes.mul_add(outside, outside, sum);
        }
        within = lanes.within(sum, limit);
        if within == 0 {
            break;
        }
    }
    (within, sum)
}
