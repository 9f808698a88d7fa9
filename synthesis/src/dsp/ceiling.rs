//! The output's ceiling.

/// Level at which it begins, -1 dBFS; softer sound passes bit for bit.
pub(crate) const KNEE: f64 = 0.891_250_938_133_745_6;
/// The largest magnitude that leaves, a step of `f32` below full scale: hosts count 1.0 as an overload.
const MOST: f64 = 1.0 - 1.0 / 16_777_216.0;

/// The factor that keeps a sample of this magnitude, the largest of all channels, below full scale. It is 1 up to the
/// knee; above, the curve continues with the same slope and levels out at full scale (a hyperbolic tangent). NaN is
/// silenced.
#[inline]
pub(crate) fn gain(magnitude: f64) -> f64 {
    if magnitude <= KNEE {
        return 1.0;
    }
    if !magnitude.is_finite() {
        return 0.0;
    }
    let room = MOST - KNEE;
    (KNEE + room * maths::tanh((magnitude - KNEE) / room)).min(MOST) / magnitude
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_the_knee_nothing_changes_and_above_nothing_leaves() {
        for magnitude in [0.0, 1e-30, 0.5, 0.8912] {
            assert_eq!(gain(magnitude), 1.0);
        }
        let mut before = 0.0;
        for step in 0..4000 {
            let magnitude = 0.85 * 1.05f64.powi(step);
            if !magnitude.is_finite() {
                break;
            }
            let out = magnitude * gain(magnitude);
            assert!(out >= before * (1.0 - 1e-12) && (out as f32) < 1.0, "{magnitude} leaves as {out}");
            before = out;
        }
        let slope = |at: f64| ((at + 1e-6) * gain(at + 1e-6) - at * gain(at)) / 1e-6;
        assert!((slope(KNEE) - 1.0).abs() < 1e-3, "no corner at the knee: {}", slope(KNEE));
        assert_eq!([gain(f64::NAN), gain(f64::INFINITY)], [0.0; 2]);
    }
}
