//! The overall level of a drive, the reference for its loudness.

use crate::dsp::MEAN_EXPONENT;

/// Loudness that counts as silence regardless of the drive.
pub(super) const SILENCE: f64 = 1e-6;
/// Time constant in seconds of all levels.
pub(super) const SMOOTHING_S: f64 = 0.02;
/// Level assumed for an unknown drive: that of the flames used in development.
pub const NOMINAL: f64 = 0.085;
/// Seconds after which past loudness counts 1/e.
const MEMORY_S: f64 = 30.0;
/// Seconds of drive that weigh as much as the prior: for an unsteady drive near [`NOMINAL`]. Following the first seconds
/// faster cost 0.06 in coherence and in sync (docs/sound.md).
const PRIOR_S: f64 = 10.0;
/// The same for any drive, and the seconds after which that counts 1/e.
const LEAST_PRIOR_S: f64 = 0.25;
const LEAST_S: f64 = 1.0;
/// Distance from [`NOMINAL`], in nepers, within which a drive still counts as near: 15 dB.
const NEAR: f64 = 1.73;
/// The same for an unsteady drive that is quiet so far, and the seconds after which that counts 1/e: flames often begin
/// with a second of hardly anything. Taken for the drive's level, it would make the first burst 10 dB too loud.
const QUIET_PRIOR_S: f64 = 3.0;
const QUIET_S: f64 = 3.0;
/// Standard deviation of the loudness, in nepers, from which a drive counts as unsteady: 3 dB. A band of noise has 1 dB,
/// flames 6 to 16. The first seconds of a steady drive say all about its level, so that it does not drift.
const UNSTEADY: f64 = 0.345;

/// The loudness of the drive so far: a mean that forgets, silence not counted. Starts at
/// [`NOMINAL`].
#[derive(Debug, Clone)]
pub struct RunningLevel {
    frame_s: f64,
    decay: f64,
    elapsed_s: f64,
    sum: f64,
    /// Integrals of the loudness in nepers over the nominal level, and of its square.
    log: [f64; 2],
}

impl RunningLevel {
    /// A level for loudnesses at `frame_rate_hz`.
    pub fn new(frame_rate_hz: f64) -> Self {
        let frame_s = 1.0 / frame_rate_hz;
        Self { frame_s, decay: maths::exp(-frame_s / MEMORY_S), elapsed_s: 0.0, sum: 0.0, log: [0.0; 2] }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.elapsed_s = 0.0;
        self.sum = 0.0;
        self.log = [0.0; 2];
    }

    /// True before the first loudness.
    pub fn is_fresh(&self) -> bool {
        self.elapsed_s == 0.0
    }

    /// Adds a frame's loudness, which must not be silence.
    pub fn push(&mut self, loudness: f64) {
        self.elapsed_s = self.elapsed_s * self.decay + self.frame_s;
        self.sum = self.sum * self.decay + self.frame_s * maths::pow(loudness, MEAN_EXPONENT);
        let log = maths::ln(loudness / NOMINAL);
        let [mean, square] = self.log;
        self.log = [mean * self.decay + self.frame_s * log, square * self.decay + self.frame_s * log * log];
    }

    /// The level. Measurement and prior are mixed in decibels, so that quiet drives are found as fast as loud ones.
    pub fn level(&self) -> f64 {
        if self.elapsed_s <= 0.0 || self.sum <= 0.0 {
            return NOMINAL;
        }
        let measured = maths::ln(self.sum / self.elapsed_s) / MEAN_EXPONENT;
        let prior = maths::ln(NOMINAL);
        let prior_s = self.prior_s(measured - prior);
        maths::exp((prior_s * prior + self.elapsed_s * measured) / (prior_s + self.elapsed_s))
    }

    /// Seconds of drive that weigh as much as the prior, for a drive that lies this many nepers above it so far.
    fn prior_s(&self, above: f64) -> f64 {
        let near = PRIOR_S * maths::exp(-maths::square(above / NEAR));
        let quiet = if above < 0.0 { QUIET_PRIOR_S * maths::exp(-self.elapsed_s / QUIET_S) } else { 0.0 };
        LEAST_PRIOR_S * maths::exp(-self.elapsed_s / LEAST_S) + self.unsteadiness() * near.max(quiet)
    }

    /// Share, 0-1, to which the drive counts as unsteady.
    fn unsteadiness(&self) -> f64 {
        let [mean, square] = self.log.map(|sum| sum / self.elapsed_s);
        let ratio = (square - mean * mean).max(0.0) / maths::square(UNSTEADY);
        // A steep step: what is steady counts as such although no noise has a constant loudness.
        let cube = ratio * ratio * ratio;
        cube / (cube + 1.0)
    }
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

    /// The level in dB over the nominal one after each of `seconds`, for loudnesses in dB over it by frame.
    fn levels_db(seconds: [usize; 2], loudness_db: impl Fn(usize) -> f64) -> [f64; 2] {
        let mut running = RunningLevel::new(1000.0);
        let mut frame = 0;
        seconds.map(|second| {
            while frame < 1000 * second {
                running.push(NOMINAL * 10f64.powf(loudness_db(frame) / 20.0));
                frame += 1;
            }
            20.0 * (running.level() / NOMINAL).log10()
        })
    }

    #[test]
    fn steady_drive_of_any_level_does_not_drift() {
        for level_db in [-40.0, -20.0, -6.0, 0.0, 6.0, 12.0] {
            let [before, after] = levels_db([3, 23], |frame| level_db + 1.7 * (0.02 * frame as f64).sin());
            assert!((after - before).abs() < 0.5, "{level_db} dB: {before} to {after} dB");
        }
    }

    #[test]
    fn quiet_beginning_of_a_flame_is_not_taken_for_its_level() {
        let [level, _] = levels_db([1, 2], |frame| -28.0 + 13.0 * (0.01 * frame as f64).sin());
        assert!(level > -12.0, "{level} dB after a second");
    }

    #[test]
    fn quiet_flame_is_found_within_eight_seconds() {
        let [_, level] = levels_db([1, 8], |frame| -40.0 + 13.0 * (0.01 * frame as f64).sin());
        assert!(level < -30.0, "{level} dB");
    }

    #[test]
    fn running_level_forgets_a_loud_past() {
        let mut running = RunningLevel::new(1000.0);
        (0..60_000).for_each(|_| running.push(1.0));
        (0..120_000).for_each(|_| running.push(0.01));
        assert!(running.level() < 0.1, "{}", running.level());
    }
}
