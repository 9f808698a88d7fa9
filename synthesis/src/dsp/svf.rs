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
    section: Section<1>,
}

/// The same for `LANES` signals side by side, with any damping, and without an end: its outputs decay after silence, until
/// [`reset_lane`](Self::reset_lane) ends them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Section<const LANES: usize> {
    state: [[f64; LANES]; 2],
}

/// The two outputs of a filter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bands<T> {
    /// The signal below the corner.
    pub low: T,
    /// The signal above it.
    pub high: T,
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
        self.section = Section::default();
    }

    /// Filters one sample by a Butterworth filter. After silence the outputs end exactly.
    #[inline]
    pub fn process(&mut self, gain: f64, input: f64) -> Bands<f64> {
        let Bands { low: [low], high: [high] } = self.section.process(&Coefficients::new(gain, BUTTERWORTH), [input]);
        if self.section.is_below(SILENCE, input, 0) {
            self.reset();
            return Bands { low: 0.0, high: 0.0 };
        }
        Bands { low, high }
    }
}

impl<const LANES: usize> Default for Section<LANES> {
    fn default() -> Self {
        Self { state: [[0.0; LANES]; 2] }
    }
}

impl<const LANES: usize> Section<LANES> {
    /// Filters one sample of each lane.
    #[inline]
    pub fn process(&mut self, coefficients: &Coefficients, inputs: [f64; LANES]) -> Bands<[f64; LANES]> {
        let ([s1, s2], gain) = (self.state, coefficients.gain);
        let mut bands = Bands { low: [0.0; LANES], high: [0.0; LANES] };
        for lane in 0..LANES {
            let high = (inputs[lane] - coefficients.feedback * s1[lane] - s2[lane]) / coefficients.divisor;
            let band = gain * high + s1[lane];
            let low = gain * band + s2[lane];
            self.state[0][lane] = gain * high + band;
            self.state[1][lane] = gain * band + low;
            (bands.low[lane], bands.high[lane]) = (low, high);
        }
        bands
    }

    /// True if a lane's last input, and what is left of earlier ones, are below `level`.
    #[inline]
    pub fn is_below(&self, level: f64, input: f64, lane: usize) -> bool {
        input.abs() < level && self.state.iter().all(|state| state[lane].abs() < level)
    }

    /// Resets a lane to silence.
    pub fn reset_lane(&mut self, lane: usize) {
        self.state.iter_mut().for_each(|state| state[lane] = 0.0);
    }
}
