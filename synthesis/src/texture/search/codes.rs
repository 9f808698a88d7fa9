//! Windows as integers.
//!
//! Up to 256 windows near each other share a *frame*: a middle along each axis and one step for all axes. A window's
//! coordinate is a code of seven bits, at an odd number of half-steps from the middle; a query's is any number of
//! half-steps from -127 to 127. The squared distance between the two is therefore an integer, |c|^2 - 2 c.q + |q|^2,
//! exact on every machine, and sixteen of them cost a few multiplications of bytes. The rounding error of the codes is
//! known (`slack` for the windows, `error` for the query) and added to the search radius. The part of the query outside
//! the frame's box is kept separately, in single precision.

use bitcode::{Decode, Encode};

use super::sizes::LANES;

/// Number of axes multiplied at once.
pub const QUAD: usize = 4;
/// Largest code.
pub const CODE_MAX: f64 = 127.0;
/// Codes of four axes of a leaf's sixteen windows, window by window.
pub type Quad = [u8; QUAD * LANES];
/// Least half-step, for windows that are all the same.
const LEAST_HALF_STEP: f32 = 1e-30;
/// Added to a number of at most 2^22 and subtracted again, it rounds to the nearest integer.
pub const ROUNDER: f32 = 12_582_912.0;

/// Extent of a frame, apart from its middles and halves.
#[derive(Debug, Clone, Copy, Encode, Decode)]
pub struct Scale {
    /// Half of the distance between two codes.
    pub half_step: f32,
    /// Largest distance of a window from the position given by its codes.
    pub slack: f32,
}

/// Position of the codes of up to 256 windows.
#[derive(Debug, Clone, Copy)]
pub struct CodeFrame<'a> {
    /// Middle of the windows along each axis.
    pub middles: &'a [f32],
    /// Largest distance from it.
    pub halves: &'a [f32],
    /// Step and slack.
    pub scale: Scale,
}

/// Middle and half-width of the interval from `low` to `high`; the half-width is rounded up.
pub fn middle_and_half(low: f32, high: f32) -> (f32, f32) {
    let middle = low + 0.5 * (high - low);
    (middle, (high - middle).max(middle - low).next_up())
}

/// The half-step with which codes cover the largest of `halves`.
pub fn half_step_for(halves: impl Iterator<Item = f32>) -> f32 {
    (halves.fold(0.0, f32::max) / CODE_MAX as f32).next_up().max(LEAST_HALF_STEP)
}

/// The code nearest to `x`, and its value.
pub fn code_of(x: f32, middle: f32, half_step: f32) -> (u8, f64) {
    let (middle, half_step) = (f64::from(middle), f64::from(half_step));
    let code = (0.5 * ((f64::from(x) - middle) / half_step + CODE_MAX)).round().clamp(0.0, CODE_MAX);
    (code as u8, middle + half_step * (2.0 * code - CODE_MAX))
}

/// Square, in half-steps, of a code's value.
pub fn square(code: u8) -> i32 {
    (2 * i32::from(code) - CODE_MAX as i32).pow(2)
}

/// Number of a window's `axes` that are compared first: usually they already show that it is too far away.
#[inline(always)]
pub fn first_axes(axes: usize) -> usize {
    (axes / 2).next_multiple_of(CHUNK)
}

/// Sums from converting a query to a frame, over every eighth axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TakenIn {
    /// Squares of its distance outside.
    pub outside: [f32; CHUNK],
    /// Squares of the rounding errors of its steps.
    pub error: [f32; CHUNK],
    /// Sums of its steps, along the first axes alone and along all.
    pub sums: [[i32; CHUNK]; 2],
    /// Sums of their squares, in the same way.
    pub squares: [[i32; CHUNK]; 2],
}

/// Number of axes converted at once.
pub const CHUNK: usize = 8;
