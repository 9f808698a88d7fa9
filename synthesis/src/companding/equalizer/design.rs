//! Design of the equaliser's filters: minimum phase, from gains by frequency.

use maths::fft::{self, Complex64};

use super::STRIDE;
use crate::companding::bands::centres_hz;
use crate::dsp::Transform;

/// Most that a third octave is raised or lowered, in dB.
pub const LIMIT_DB: f64 = 20.0;
/// Stop-band attenuation of a low-pass in dB, below any recording's noise floor, and its slope in dB per octave.
const STOP_DB: f64 = 80.0;
const SLOPE_DB: f64 = 180.0;
/// Taps at 44.1 kHz.
const TAPS: f64 = 512.0;
/// Length of the transform for designing, in taps; long, so that the cepstrum does not wrap.
const DESIGN_FACTOR: usize = 16;

/// Taps of the minimum-phase filter whose gains in dB at [`centres_hz`] are `gains_db`, and constant beyond the
/// outermost.
pub fn design(gains_db: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let centres: Vec<f64> = centres_hz(sample_rate_hz).iter().map(|hz| maths::ln(*hz)).collect();
    let gain_db = |hz: f64| interpolate(&centres, gains_db, maths::ln(hz.max(1.0))).clamp(-LIMIT_DB, LIMIT_DB);
    minimum_phase(gain_db, sample_rate_hz)
}

/// Taps of a low-pass that is flat up to a frequency in Hz, and falls by 80 dB within half an octave.
pub fn design_low_pass(corner_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    minimum_phase(|hz| -(SLOPE_DB * maths::log2(hz.max(1.0) / corner_hz)).clamp(0.0, STOP_DB), sample_rate_hz)
}

/// Taps of the minimum-phase filter with a gain in dB by frequency in Hz.
fn minimum_phase(gain_db: impl Fn(f64) -> f64, sample_rate_hz: f64) -> Vec<f64> {
    let taps = ((TAPS * sample_rate_hz / 44_100.0).ceil() as usize).next_multiple_of(STRIDE);
    let mut transform = Transform::new((taps * DESIGN_FACTOR).next_power_of_two());
    let len = transform.len();
    for (bin, value) in transform.spectrum.iter_mut().enumerate() {
        let gain_db = gain_db(bin as f64 * sample_rate_hz / len as f64);
        *value = Complex64::new(gain_db / 20.0 * std::f64::consts::LN_10 / len as f64, 0.0);
    }
    // The cepstrum, folded onto positive times, is that of the minimum-phase filter
    // (Oppenheim & Schafer, "Discrete-Time Signal Processing", §13.5).
    transform.inverse();
    let half = len / 2;
    transform.time[1..half].iter_mut().for_each(|x| *x *= 2.0);
    transform.time[half + 1..].fill(0.0);
    transform.forward();
    transform.spectrum.iter_mut().for_each(|x| *x = fft::exp(*x) / len as f64);
    transform.inverse();
    let fade = taps / 4;
    let ending = |tap: usize| match (tap + fade).checked_sub(taps) {
        Some(into) => maths::square(maths::cos(std::f64::consts::FRAC_PI_2 * into as f64 / fade as f64)),
        None => 1.0,
    };
    (0..taps).map(|tap| transform.time[tap] * ending(tap)).collect()
}

fn interpolate(places: &[f64], values: &[f64], at: f64) -> f64 {
    let above = places.partition_point(|place| *place <= at);
    match (above.checked_sub(1), values.get(above)) {
        (None, first) => first.copied().unwrap_or(0.0),
        (Some(below), None) => values.get(below.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0),
        (Some(below), Some(next)) => {
            let part = (at - places[below]) / (places[above] - places[below]);
            values[below] + part * (next - values[below])
        }
    }
}
