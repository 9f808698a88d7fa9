//! White noise that is a function of (seed, stream, position) only.
//!
//! A counter-based generator needs no state, so noise can be requested at any position, in any order and in any block
//! size, and two renders of the same section of the timeline are equal.

/// One stream of uniformly distributed white noise of unit variance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct White {
    key: u64,
}

impl White {
    /// The stream number `stream` of `seed`. Streams are independent of each other.
    pub fn new(seed: u32, stream: u32) -> Self {
        Self { key: mix((u64::from(seed) << 32 | u64::from(stream)).wrapping_add(WEYL)) }
    }

    /// The sample at `position`, in -sqrt(3)..sqrt(3).
    pub fn sample_at(&self, position: i64) -> f64 {
        // A uniform variable on -1..1 has the variance 1/3.
        const SCALE: f64 = 1.732_050_807_568_877_2 / 9_223_372_036_854_775_808.0;
        let counter = (position as u64).wrapping_mul(WEYL);
        mix(self.key.wrapping_add(counter)) as i64 as f64 * SCALE
    }

    /// 64 random bits for `position`.
    pub(crate) fn bits(&self, position: i64) -> u64 {
        mix(self.key.wrapping_add((position as u64).wrapping_mul(WEYL)))
    }

    /// A number in -1..1 for `position`, evenly distributed.
    pub(crate) fn unit(&self, position: i64) -> f64 {
        self.bits(position) as i64 as f64 / 9_223_372_036_854_775_808.0
    }

    /// The samples from `start` on.
    pub fn fill(&self, start: i64, out: &mut [f64]) {
        for (position, sample) in (start..).zip(out) {
            *sample = self.sample_at(position);
        }
    }
}

/// The golden ratio's fraction, in units of 2^-64: spreads successive counters evenly.
const WEYL: u64 = 0x9E37_79B9_7F4A_7C15;

/// The finaliser of SplitMix64 (Steele, Lea & Flood 2014; Stafford's variant 13).
fn mix(z: u64) -> u64 {
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_white_with_unit_variance_and_streams_are_independent() {
        let count = 200_000;
        let mut streams = vec![vec![0.0; count]; 3];
        for (samples, (seed, stream)) in streams.iter_mut().zip([(1, 0), (1, 1), (2, 0)]) {
            White::new(seed, stream).fill(-100_000, samples);
        }
        let mean_product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>() / a.len() as f64;
        for samples in &streams {
            assert!((mean_product(samples, samples) - 1.0).abs() < 0.01);
            assert!((samples.iter().sum::<f64>() / count as f64).abs() < 0.01);
            for lag in [1, 2, 3, 500] {
                assert!(mean_product(&samples[lag..], &samples[..count - lag]).abs() < 0.01, "lag {lag}");
            }
        }
        assert!(mean_product(&streams[0], &streams[1]).abs() < 0.01);
        assert!(mean_product(&streams[0], &streams[2]).abs() < 0.01);
    }

    #[test]
    fn depends_on_the_position_alone() {
        let noise = White::new(42, 3);
        let mut long = [0.0; 64];
        noise.fill(-32, &mut long);
        for (offset, expected) in long.iter().enumerate() {
            assert_eq!(noise.sample_at(offset as i64 - 32), *expected);
        }
    }
}
