//! The values of a series and their times.

use crate::import::sequence::snapped_rate_hz;

/// Largest number of rows in a series.
pub(super) const MOST_ROWS: usize = 10_000_000;

/// Tolerance of a time against an even grid, in steps, within which a series has a rate.
const MOST_UNEVEN: f64 = 0.02;

/// Times of a series' values.
#[derive(Debug, Clone, PartialEq)]
pub enum Timing {
    /// At consecutive frames from this number on.
    Frames(i64),
    /// At these times in seconds, ascending.
    Times(Vec<f64>),
}

/// A series of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Times of the values.
    pub timing: Timing,
    /// The values, all finite; at least one.
    pub values: Vec<f64>,
    /// Values per second, if the times are even (within 2 % of a step).
    pub rate_hz: Option<f64>,
}

/// Values per second, if all times are near an even grid.
pub(super) fn rate_hz(times: &[f64]) -> Option<f64> {
    let ([first, ..], [.., last]) = (times, times) else { return None };
    let steps = times.len() as f64 - 1.0;
    let step = (last - first) / steps;
    let is_even =
        times.iter().enumerate().all(|(i, time)| (time - first - i as f64 * step).abs() <= MOST_UNEVEN * step);
    (steps > 0.0 && step.is_finite() && step > 0.0 && is_even).then(|| snapped_rate_hz(1.0 / step))
}
