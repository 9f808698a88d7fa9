//! Levels that follow their controls without a click.

/// Distance below which a level jumps to its control's value.
const CLOSE: f64 = 1e-5;

/// A level that follows its control with a time constant.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Smoothed {
    /// The present level.
    pub value: f64,
    coefficient: f64,
}

impl Smoothed {
    /// A level at 0; `time_s` is its time constant in seconds.
    pub fn new(time_s: f64, sample_rate_hz: f64) -> Self {
        Self { value: 0.0, coefficient: 1.0 - maths::exp(-1.0 / (time_s * sample_rate_hz)) }
    }

    /// The level one sample later.
    #[inline]
    pub fn next(&mut self, target: f64) -> f64 {
        let missing = target - self.value;
        self.value = if missing.abs() <= CLOSE { target } else { self.value + self.coefficient * missing };
        self.value
    }
}
