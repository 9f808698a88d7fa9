//! The second-order section that drive and companding filter with.

use std::f64::consts::{PI, SQRT_2};

/// Level at which a filter that receives silence ends: -300 dBFS.
const SILENCE: f64 = 1e-15;

/// Damping of a Butterworth filter of order 2.
const BUTTERWORTH: f64 = SQRT_2;

/// Low- and high-pass of order 2 as a state-variable filter with trapezoidal integrators (Zavalishin, "The Art of VA
/// Filter Design", §4), which remains well-behaved while its corner moves.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Svf {
    state: [f64; 2],
}

/// The two outputs of a [`Svf`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bands {
    /// The signal below the corner.
    pub low: f64,
    /// The signal above it.
    pub high: f64,
}

/// The integrators' gain, tan(pi corner / rate), for a corner in Hz below half the rate.
pub(crate) fn section_gain(corner_hz: f64, sample_rate_hz: f64) -> f64 {
    maths::tan(PI * corner_hz / sample_rate_hz)
}

/// Coefficients of a section; sections of different dampings make up filters of higher order.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Coefficients {
    gain: f64,
    feedback: f64,
    divisor: f64,
}

impl Coefficients {
    /// Those of a section with this gain of its integrators and this damping, 1 / Q.
    #[inline]
    pub fn new(gain: f64, damping: f64) -> Self {
        Self { gain, feedback: damping + gain, divisor: 1.0 + gain * (gain + damping) }
    }
}

impl Svf {
    /// Resets to silence.
    pub fn reset(&mut self) {
        self.state = [0.0; 2];
    }

    /// Filters one sample by a Butterworth filter. After silence the outputs end exactly.
    #[inline]
    pub fn process(&mut self, gain: f64, input: f64) -> Bands {
        let bands = self.process_endlessly(&Coefficients::new(gain, BUTTERWORTH), input);
        if self.is_below(SILENCE, input) {
            self.reset();
            return Bands { low: 0.0, high: 0.0 };
        }
        bands
    }

    /// Filters one sample by any section. After silence the outputs decay but do not end: [`reset`](Self::reset) ends them,
    /// once everything [`is_below`](Self::is_below) what is audible.
    #[inline]
    pub fn process_endlessly(&mut self, coefficients: &Coefficients, input: f64) -> Bands {
        let ([s1, s2], gain) = (self.state, coefficients.gain);
        let high = (input - coefficients.feedback * s1 - s2) / coefficients.divisor;
        let band = gain * high + s1;
        let low = gain * band + s2;
        self.state = [gain * high + band, gain * band + low];
        Bands { low, high }
    }

    /// True if the last input, and what is left of earlier ones, are below `level`.
    #[inline]
    pub fn is_below(&self, level: f64, input: f64) -> bool {
        input.abs() < level && self.state.iter().all(|state| state.abs() < level)
    }
}
