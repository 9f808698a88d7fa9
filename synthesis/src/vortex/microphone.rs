//! Ceiling of the microphone.
//!
//! The paper (§7) clips the sound at a microphone's largest sound pressure, which is how explosions remain recognisable
//! as such. Here the corner is rounded.

/// Share of the largest pressure up to which nothing changes.
const KNEE: f64 = 0.7;

/// `pressure_pa` through a microphone with a ceiling of `most_pa`: unchanged up to 0.7 of that, never beyond it.
#[inline]
pub(super) fn limited(pressure_pa: f64, most_pa: f64) -> f64 {
    let knee = KNEE * most_pa;
    let magnitude = pressure_pa.abs();
    if magnitude <= knee {
        return pressure_pa;
    }
    let room = most_pa - knee;
    (knee + room * maths::tanh((magnitude - knee) / room)).copysign(pressure_pa)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_what_is_soft_and_bends_without_a_corner() {
        assert_eq!([-1.3, 0.0, 1.4].map(|p| limited(p, 2.0)), [-1.3, 0.0, 1.4]);
        assert!(limited(1e9, 2.0) <= 2.0 && limited(-1e9, 2.0) >= -2.0 && limited(1e9, 2.0) > 1.999);
        let mut before = (limited(0.0, 2.0), 1.0);
        for step in 1..4000 {
            let value = limited(f64::from(step) * 1e-3, 2.0);
            let slope = (value - before.0) / 1e-3;
            assert!((0.0..=1.0 + 1e-9).contains(&slope) && (slope - before.1).abs() < 0.01, "{step}: {slope}");
            before = (value, slope);
        }
    }
}
