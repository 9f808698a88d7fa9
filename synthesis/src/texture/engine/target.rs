//! Addition of a recording's window to what has been synthesized.

use crate::dsp::Ring;
use crate::texture::feature::Excerpt;

/// Destination of a matched window.
pub struct Target {
    /// First sample of the recording's window; may lie outside its array.
    pub from: i64,
    /// First destination sample; may lie outside the array.
    pub to: i64,
    /// First sample that may be written, and one past the last.
    pub floor: i64,
    pub end: i64,
}

impl Target {
    /// Adds samples of the recording, each with its factor.
    pub fn add(&self, factors: &[f64], recording: Excerpt<'_>, ring: &mut Ring) {
        let from = self.from - recording.first as i64;
        let first = (self.floor - self.to).max(-from).max(0);
        let end = self.end.saturating_sub(self.to).min(recording.samples.len() as i64 - from).min(factors.len() as i64);
        if first < end {
            let samples = &recording.samples[(from + first) as usize..];
            ring.add_products(self.to + first, &factors[first as usize..end as usize], samples);
        }
    }
}

/// Rounding up when an index goes down levels.
pub trait DivCeilShift {
    /// The first index on a level so many levels further up that is not before this one.
    fn div_ceil_shift(self, levels: usize) -> i64;
}

impl DivCeilShift for i64 {
    fn div_ceil_shift(self, levels: usize) -> i64 {
        (self + (1 << levels) - 1) >> levels
    }
}
