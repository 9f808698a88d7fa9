//! The boundary between drive and noise: the blend ramps, and the filters made from them.

use std::f64::consts::PI;

use crate::controls::ExtendControls;
use crate::error::within;

/// The frequencies of one window's blend, fit and noise, limited to the engine's range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Power falls as frequency^(-alpha); 0-6.
    pub alpha: f64,
    /// Centre of the blend in Hz, 40-1000.
    pub cutoff_hz: f64,
    /// Width of the blend in Hz, 2-400, and never so wide that it would begin below 0 Hz.
    pub width_hz: f64,
}

impl Band {
    /// The band of `controls`; values out of range are limited.
    pub fn new(controls: &ExtendControls) -> Self {
        let cutoff_hz = within(controls.cutoff_hz, 40.0, 1000.0);
        Self {
            alpha: within(controls.alpha, 0.0, 6.0),
            cutoff_hz,
            width_hz: within(controls.blend_width_hz, 2.0, 400.0).min(2.0 * cutoff_hz),
        }
    }

    /// The blend's upper ramp b2: 0 below it, linear, 1 above it (§4). The lower one is 1 - b2.
    pub fn upper(&self, frequency_hz: f64) -> f64 {
        ((frequency_hz - self.cutoff_hz) / self.width_hz + 0.5).clamp(0.0, 1.0)
    }

    /// Power of the noise at `frequency_hz`: 1 at the cutoff, apart from the ramp b2^2 (§4).
    pub fn noise_power(&self, frequency_hz: f64) -> f64 {
        let upper = self.upper(frequency_hz);
        if upper == 0.0 || frequency_hz <= 0.0 {
            return 0.0;
        }
        maths::exp(-self.alpha * maths::ln(frequency_hz / self.cutoff_hz)) * upper * upper
    }

    /// Taps 0, 1, ... of the linear-phase low-pass 1 - b2, cut to `taps.len()` and set to gain 1 at
    /// 0 Hz. A trapezoid is a box of the cutoff smeared by a box of the width, so its transform is
    /// a product of two sinc functions.
    pub fn low_pass(&self, sample_rate_hz: f64, taps: &mut [f64]) {
        self.low_pass_taps(sample_rate_hz, 0, taps);
        normalise(taps);
    }

    /// Some of these taps, from number `first` on, before [`normalise`].
    pub(crate) fn low_pass_taps(&self, sample_rate_hz: f64, first: usize, taps: &mut [f64]) {
        for (tap, value) in taps.iter_mut().enumerate() {
            let seconds = (first + tap) as f64 / sample_rate_hz;
            *value = sinc(2.0 * self.cutoff_hz * seconds) * sinc(self.width_hz * seconds);
        }
    }

    /// Taps 0, 1, ... of the linear-phase high-pass b2, cut to `taps.len()`, with gain 0 at 0 Hz.
    pub fn high_pass(&self, sample_rate_hz: f64, taps: &mut [f64]) {
        self.low_pass(sample_rate_hz, taps);
        complement(taps);
    }

    /// Taps 0, 1, ... of the envelope's low-pass: a Butterworth filter of order 2 run forward and
    /// backward has the gain 1/(1 + (f/cutoff)^4) and no phase. Its taps in closed form, cut to
    /// `taps.len()` and set to gain 1 at 0 Hz.
    pub fn envelope_low_pass(&self, sample_rate_hz: f64, taps: &mut [f64]) {
        for (tap, value) in taps.iter_mut().enumerate() {
            let angle = std::f64::consts::SQRT_2 * PI * self.cutoff_hz * tap as f64 / sample_rate_hz;
            *value = maths::exp(-angle) * (maths::cos(angle) + maths::sin(angle));
        }
        normalise(taps);
    }
}

/// Scales the taps 0, 1, ... of a symmetric filter to gain 1 at 0 Hz.
pub(crate) fn normalise(taps: &mut [f64]) {
    let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
    taps.iter_mut().for_each(|value| *value /= sum);
}

/// Turns the taps 0, 1, ... of a symmetric filter into those of its complement.
pub(crate) fn complement(taps: &mut [f64]) {
    taps.iter_mut().for_each(|value| *value = -*value);
    taps[0] += 1.0;
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { maths::sin(PI * x) / (PI * x) }
}

/// Power of the triangle of half-width `half_width_s` seconds at `frequency_hz`, over its energy,
/// in seconds: (T sinc^2(f T))^2 / (2 T / 3). Its integral over all frequencies is 1.
pub(crate) fn triangle_power(half_width_s: f64, frequency_hz: f64) -> f64 {
    1.5 * half_width_s * maths::powi(sinc(frequency_hz * half_width_s), 4)
}
