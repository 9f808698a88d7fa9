//! Bursts at random times: puffs of gas from a bed of fuel, blasts of breath, gusts of wind.

use crate::solver::Random;

/// Number of fall times after which nothing of a burst is left.
const FALLS: f64 = 8.0;

/// Lowest and highest burst, relative to a typical one: all stand out from the pauses, and none is the only one that
/// is heard.
const HEIGHTS: (f64, f64) = (0.4, 1.6);

/// Degree to which bursts that overlap weaken each other, for they feed on the same fuel: two typical ones at the same
/// moment make 1.5, and not 2.
const SHARING: f64 = 0.5;

/// A random function of time: one burst in each slot of `1 / rate_hz` seconds, most of them low, a few high, that rises
/// within `rise_s` and falls over `fall_s`.
#[derive(Debug, Clone, Copy)]
pub struct Bursts {
    seed: u64,
    rate_hz: f64,
    rise_s: f64,
    fall_s: f64,
}

impl Bursts {
    /// Sequence number `seed`.
    pub fn new(seed: u64, rate_hz: f64, rise_s: f64, fall_s: f64) -> Self {
        Self { seed, rate_hz, rise_s, fall_s }
    }

    /// Value at a time: 0 between bursts, about 1 at the peak of a typical one.
    pub fn strength_at(&self, time_s: f64) -> f64 {
        let now = (time_s * self.rate_hz).floor() as i64;
        let before = (FALLS * self.fall_s * self.rate_hz).ceil() as i64;
        let sum: f64 = (now - before - 1..=now).map(|slot| self.burst(slot, time_s)).sum();
        sum * (1.0 + SHARING) / (1.0 + SHARING * sum)
    }

    fn burst(&self, slot: i64, time_s: f64) -> f64 {
        let mut random = Random::new(self.seed ^ (slot as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let since_s = time_s - (slot as f64 + random.uniform()) / self.rate_hz;
        // Heights are exponentially distributed, like those of random events: most are low.
        let height = (-maths::ln(1.0 - random.uniform())).clamp(HEIGHTS.0, HEIGHTS.1);
        if since_s <= 0.0 || since_s > FALLS * self.fall_s {
            return 0.0;
        }
        let rise = 1.0 - maths::exp(-maths::square(since_s / self.rise_s));
        height * rise * maths::exp(-since_s / self.fall_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bursts_come_at_their_rate_with_pauses() {
        let bursts = Bursts::new(3, 2.0, 0.01, 0.08);
        let values: Vec<f64> = (0..36_000).map(|n| bursts.strength_at(f64::from(n) / 360.0)).collect();
        let starts = values.windows(2).filter(|w| w[0] < 0.15 && w[1] >= 0.15).count();
        assert!((120..=230).contains(&starts), "{starts} in 100 s");
        let quiet = values.iter().filter(|value| **value < 0.05).count() as f64 / values.len() as f64;
        assert!((0.2..0.8).contains(&quiet), "quiet for {quiet} of the time");
        assert!(values.iter().all(|value| (0.0..6.0).contains(value)));
    }

    #[test]
    fn bursts_are_a_smooth_function_of_time_and_seed() {
        let bursts = Bursts::new(3, 2.0, 0.02, 0.1);
        let largest = (0..100_000)
            .map(|n| f64::from(n) * 1e-4)
            .map(|t| (bursts.strength_at(t + 1e-4) - bursts.strength_at(t)).abs())
            .fold(0.0, f64::max);
        assert!(largest < 0.03, "a jump of {largest}");
        assert_ne!(bursts.strength_at(1.3), Bursts::new(4, 2.0, 0.02, 0.1).strength_at(1.3));
        assert!(bursts.strength_at(-5.0).is_finite() && bursts.strength_at(1e9).is_finite());
    }
}
