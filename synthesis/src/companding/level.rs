//! The overall level of a drive, the reference for its loudness.

/// Level assumed for an unknown drive: that of the flames used in development.
pub const NOMINAL: f64 = 0.085;
/// Exponent of the mean over time: about twice that of the restored loudness, so that its mean power is preserved.
const MEAN_EXPONENT: f64 = 1.4;
/// Seconds after which past loudness counts 1/e.
const MEMORY_S: f64 = 30.0;
/// Seconds of drive that weigh as much as the prior: for a drive near [`NOMINAL`], and otherwise at least. Following
/// the first seconds faster cost 0.06 in coherence and in sync (docs/sound.md).
const PRIOR_S: f64 = 10.0;
const LEAST_PRIOR_S: f64 = 0.25;
/// Distance from [`NOMINAL`], in nepers, within which a drive still counts as near: 15 dB.
const NEAR: f64 = 1.73;
/// Share of the loudest below which a learned drive counts as silent.
const SILENT_PART: f64 = 1e-3;

/// The loudness of the drive so far: a mean that forgets, silence not counted. Starts at
/// [`NOMINAL`].
#[derive(Debug, Clone)]
pub struct RunningLevel {
    frame_s: f64,
    decay: f64,
    heard_s: f64,
    sum: f64,
}

impl RunningLevel {
    /// A level for loudnesses at `frame_rate_hz`.
    pub fn new(frame_rate_hz: f64) -> Self {
        let frame_s = 1.0 / frame_rate_hz;
        Self { frame_s, decay: maths::exp(-frame_s / MEMORY_S), heard_s: 0.0, sum: 0.0 }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.heard_s = 0.0;
        self.sum = 0.0;
    }

    /// True before the first loudness.
    pub fn is_fresh(&self) -> bool {
        self.heard_s == 0.0
    }

    /// Adds a frame's loudness, which must not be silence.
    pub fn push(&mut self, loudness: f64) {
        self.heard_s = self.heard_s * self.decay + self.frame_s;
        self.sum = self.sum * self.decay + self.frame_s * maths::pow(loudness, MEAN_EXPONENT);
    }

    /// The level. Measurement and prior are mixed in decibels, so that quiet drives are found as fast as loud ones.
    pub fn level(&self) -> f64 {
        if self.heard_s <= 0.0 || self.sum <= 0.0 {
            return NOMINAL;
        }
        let heard = maths::ln(self.sum / self.heard_s) / MEAN_EXPONENT;
        let thought = maths::ln(NOMINAL);
        let prior_s = LEAST_PRIOR_S + PRIOR_S * maths::exp(-maths::square((heard - thought) / NEAR));
        maths::exp((prior_s * thought + self.heard_s * heard) / (prior_s + self.heard_s))
    }
}

/// The level of a drive whose loudnesses are known beforehand.
pub fn level_of(loudnesses: &[f64]) -> Option<f64> {
    let silent = SILENT_PART * loudnesses.iter().fold(0.0f64, |most, x| most.max(*x));
    let audible = || loudnesses.iter().filter(|x| **x > silent);
    let mean = audible().map(|x| maths::pow(*x, MEAN_EXPONENT)).sum::<f64>() / audible().count().max(1) as f64;
    (mean > 0.0 && mean.is_finite()).then(|| maths::pow(mean, 1.0 / MEAN_EXPONENT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_quiet_and_loud_drives_equally_fast() {
        let errors_db = [0.01, 100.0].map(|factor| {
            let mut running = RunningLevel::new(1378.0);
            assert_eq!(running.level(), NOMINAL);
            (0..1378).for_each(|_| running.push(factor * NOMINAL));
            20.0 * (running.level() / (factor * NOMINAL)).log10().abs()
        });
        assert!((errors_db[0] - errors_db[1]).abs() < 1e-9 && errors_db[0] < 9.0, "{errors_db:?}");
    }

    #[test]
    fn learned_level_leaves_silence_out() {
        let mut loudnesses = vec![0.2; 1000];
        assert!((level_of(&loudnesses).unwrap() - 0.2).abs() < 1e-12);
        loudnesses.extend([0.0; 5000]);
        assert!((level_of(&loudnesses).unwrap() - 0.2).abs() < 1e-12);
        assert_eq!(level_of(&[0.0; 9]), None);
        assert_eq!(level_of(&[]), None);
    }

    #[test]
    fn running_level_forgets_a_loud_past() {
        let mut running = RunningLevel::new(1000.0);
        (0..60_000).for_each(|_| running.push(1.0));
        (0..120_000).for_each(|_| running.push(0.01));
        assert!(running.level() < 0.1, "{}", running.level());
    }
}
