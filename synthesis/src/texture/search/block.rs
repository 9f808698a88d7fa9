//! Bounds of sixteen windows, or of sixteen boxes.
//!
//! Boxes are kept in single precision; there are few. Of a window every coordinate is a byte: a
//! block of sixteen has a frame of its own, along each axis an offset and a step, so that codes
//! 0-255 span what it holds. That makes an index small enough to stay near the processor.

use super::lanes::{Lanes, STAGE};
use super::{AXES_MAX, LANES};

/// Where the codes of a block lie: for each axis the value of code 0, and of one step.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Values of code 0.
    pub offsets: &'a [f32],
    /// Value of one step.
    pub steps: &'a [f32],
}

/// The frame in which codes span `low` to `high`.
pub fn frame_of(low: f32, high: f32) -> (f32, f32) {
    (low, (high - low) / 255.0)
}

/// The code nearest to `x`.
pub fn nearest_code(x: f32, (offset, step): (f32, f32)) -> u8 {
    if step > 0.0 { ((x - offset) / step).round().clamp(0.0, 255.0) as u8 } else { 0 }
}

/// What a code stands for.
pub fn value(code: u8, (offset, step): (f32, f32)) -> f64 {
    f64::from(offset) + f64::from(step) * f64::from(code)
}

/// Squared distances from `point` to sixteen points, and which are at most `limit`; not complete
/// once none is.
#[inline(always)]
pub fn point_bounds<L: Lanes>(
    lanes: L,
    frame: Frame<'_>,
    codes: &[[u8; LANES]],
    point: &[f32; AXES_MAX],
    limit: f32,
) -> (u32, L::Singles) {
    let bases = bases(&frame, point);
    let mut sum = lanes.splat(0.0);
    let mut within = 0;
    let stages = codes.as_chunks::<STAGE>().0.iter().zip(frame.steps.as_chunks::<STAGE>().0);
    for ((codes, steps), bases) in stages.zip(bases.as_chunks::<STAGE>().0) {
        for axis in 0..STAGE {
            let difference =
                lanes.mul_add(lanes.codes(&codes[axis]), lanes.splat(steps[axis]), lanes.splat(bases[axis]));
            sum = lanes.mul_add(difference, difference, sum);
        }
        within = lanes.within(sum, limit);
        if within == 0 {
            break;
        }
    }
    (within, sum)
}

/// Squared distances from `point` to sixteen boxes, each axis with its lower and its upper faces,
/// and which are at most `limit`; not complete once none is.
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

/// Code 0 as seen from the point.
#[inline(always)]
fn bases(frame: &Frame<'_>, point: &[f32; AXES_MAX]) -> [f32; AXES_MAX] {
    let mut bases = [0.0; AXES_MAX];
    let stages = frame.offsets.as_chunks::<STAGE>().0.iter().zip(point.as_chunks::<STAGE>().0);
    for ((offsets, point), bases) in stages.zip(bases.as_chunks_mut::<STAGE>().0) {
        for axis in 0..STAGE {
            bases[axis] = offsets[axis] - point[axis];
        }
    }
    bases
}
