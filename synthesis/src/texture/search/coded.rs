//! A query as integers, and its least distance from a leaf's sixteen windows.

use super::codes::{CODE_MAX, CodeFrame, QUAD};
use super::lanes::Lanes;
use super::sizes::AXES_MAX;

/// Integer limits stay far from overflow.
const LIMIT_MAX: f32 = 1e9;

/// A query in a frame.
#[derive(Debug, Clone)]
pub struct Coded {
    /// Half-steps from the middle.
    pub steps: [[i8; QUAD]; AXES_MAX / QUAD],
    /// |q|^2 + 254 times the sum of all steps: added to the result of `Lanes::closeness`, it gives the squared
    /// distance.
    base: i32,
    /// The part of it beyond the first axes.
    rest: i32,
    /// Square of its distance from the frame's box.
    outside: f32,
    /// Distance of its nearest point in the box from the one given by the steps, plus the windows' slack.
    error: f32,
    per_half_step: f32,
}

impl Coded {
    /// Nothing.
    pub fn new() -> Self {
        Self { steps: [[0; QUAD]; AXES_MAX / QUAD], base: 0, rest: 0, outside: 0.0, error: 0.0, per_half_step: 0.0 }
    }

    /// Converts `point` to `frame`.
    #[inline(always)]
    pub fn set<L: Lanes>(&mut self, lanes: L, frame: CodeFrame<'_>, point: &[f32; AXES_MAX]) {
        let per_half_step = 1.0 / frame.scale.half_step;
        let taken = lanes.take_in(frame, per_half_step, point, bytemuck::cast_mut(&mut self.steps));
        let [first, all] = [0, 1]
            .map(|of| taken.squares[of].iter().sum::<i32>() + 2 * CODE_MAX as i32 * taken.sums[of].iter().sum::<i32>());
        self.base = all;
        self.rest = all - first;
        self.outside = taken.outside.iter().sum();
        self.error = taken.error.iter().sum::<f32>().sqrt() + frame.scale.slack;
        self.per_half_step = per_half_step;
    }

    /// The largest result of `Lanes::closeness` for a window within `reach`; rounded up.
    #[inline(always)]
    pub fn limit(&self, reach: f32) -> i32 {
        let square = reach * reach - self.outside;
        // Numbers beyond all bounds: then nothing is ruled out.
        let inside = if square.is_nan() { f32::INFINITY } else { square.max(0.0).sqrt() };
        let steps = (inside + self.error) * self.per_half_step;
        (steps * steps * (1.0 + 1e-5)).min(LIMIT_MAX) as i32 + 1 - self.base
    }

    /// The same for the first axes alone, if it is `limit` for all of them.
    #[inline(always)]
    pub fn first_limit(&self, limit: i32) -> i32 {
        limit.saturating_add(self.rest)
    }
}
