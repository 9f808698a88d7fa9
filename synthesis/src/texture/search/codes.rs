//! Windows as integers.
//!
//! Up to 256 windows that lie near each other share a *frame*: a middle along each axis and one
//! step for all axes. A window's coordinate is a code of seven bits, at an odd number of half-steps
//! from the middle; a query's is any number of half-steps from -127 to 127. So the squared
//! distance between the two is an integer, |c|^2 - 2 c.q + |q|^2, exact on every machine, and sixteen
//! of them cost a few multiplications of bytes. What codes lose is known (`slack` for the windows, `error` for
//! the query) and added to the reach; what of the query lies outside the frame's box is kept apart, in single precision.

use bitcode::{Decode, Encode};

use super::sizes::LANES;

/// Axes multiplied at once.
pub const QUAD: usize = 4;
/// Largest code.
pub const CODE_MAX: f64 = 127.0;
/// Codes of four axes of a leaf's sixteen windows, window by window.
pub type Quad = [u8; QUAD * LANES];
/// Least half-step, for windows that are all the same.
const LEAST_HALF_STEP: f32 = 1e-30;
/// Added to a number of at most 2^22 and taken away again, it leaves the nearest integer.
pub const ROUNDER: f32 = 12_582_912.0;

/// How far a frame reaches, beside its middles and halves.
#[derive(Debug, Clone, Copy, Encode, Decode)]
pub struct Scale {
    /// Half of the distance between two codes.
    pub half_step: f32,
    /// Farthest that a window lies from where its codes say.
    pub slack: f32,
}

/// Where the codes of up to 256 windows lie.
#[derive(Debug, Clone, Copy)]
pub struct Frame<'a> {
    /// Middle of the windows along each axis.
    pub middles: &'a [f32],
    /// How far they lie from it at most.
    pub halves: &'a [f32],
    /// Step and slack.
    pub scale: Scale,
}

/// Middle and half of what spans `low` to `high`; the half is rounded up.
pub fn middle_and_half(low: f32, high: f32) -> (f32, f32) {
    let middle = low + 0.5 * (high - low);
    (middle, (high - middle).max(middle - low).next_up())
}

/// The half-step with which codes span the largest of `halves`.
pub fn half_step_for(halves: impl Iterator<Item = f32>) -> f32 {
    (halves.fold(0.0, f32::max) / CODE_MAX as f32).next_up().max(LEAST_HALF_STEP)
}

/// The code nearest to `x`, and what it stands for.
pub fn code_of(x: f32, middle: f32, half_step: f32) -> (u8, f64) {
    let (middle, half_step) = (f64::from(middle), f64::from(half_step));
    let code = (0.5 * ((f64::from(x) - middle) / half_step + CODE_MAX)).round().clamp(0.0, CODE_MAX);
    (code as u8, middle + half_step * (2.0 * code - CODE_MAX))
}

/// Square in half-steps of what a code stands for.
pub fn square(code: u8) -> i32 {
    (2 * i32::from(code) - CODE_MAX as i32).pow(2)
}

/// How many of a window's `axes` are looked at first: mostly they say already that it lies too far away.
#[inline(always)]
pub fn first_axes(axes: usize) -> usize {
    (axes / 2).next_multiple_of(CHUNK)
}

/// What taking a query into a frame comes to, added up over every eighth axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TakenIn {
    /// Squares of how far it lies outside.
    pub outside: [f32; CHUNK],
    /// Squares of what its steps lose.
    pub error: [f32; CHUNK],
    /// Its steps, along the first axes alone and along all.
    pub sums: [[i32; CHUNK]; 2],
    /// Their squares, likewise.
    pub squares: [[i32; CHUNK]; 2],
}

/// Axes taken in at once.
pub const CHUNK: usize = 8;
