//! Signals to try engines on.
#![allow(dead_code)]

/// A small generator of its own, so that cases never change (SplitMix64).
pub struct Random(u64);

impl Random {
    /// The same numbers for the same seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let x = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        x ^ (x >> 31)
    }

    /// 0 up to, not including, 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number below `n`.
    pub fn below(&mut self, n: usize) -> usize {
        (self.unit() * n as f64) as usize
    }
}

/// One of several kinds of signal: flame-like noise, bursts, white noise, a sine, a constant,
/// silence, and noise with silent stretches.
pub fn signal(random: &mut Random, kind: usize, samples: usize) -> Vec<f64> {
    let mut slow = 0.0;
    let mut slower = 0.0;
    let pulse = 400 + random.below(3000);
    let level = random.unit();
    (0..samples)
        .map(|i| {
            let white = 2.0 * random.unit() - 1.0;
            slow += 0.02 * (white - slow);
            slower += 0.002 * (white - slower);
            let x = match kind % 8 {
                0 | 7 => 4.0 * slow + 0.05 * white,
                1 => (4.0 * slow + 0.3 * white) * (-((i % pulse) as f64) / 300.0).exp(),
                2 => white,
                3 => (i as f64 * 0.03 * (0.2 + level)).sin(),
                4 => level,
                5 => 0.0,
                _ => {
                    if i / 2000 % 2 == 0 {
                        0.0
                    } else {
                        8.0 * slower + 0.1 * white
                    }
                }
            };
            f64::from((0.5 * x) as f32)
        })
        .collect()
}
