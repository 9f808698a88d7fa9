//! Running scores of the output: its similarity to the recording, and its correlation with the drive. They are the
//! figures by which whole results are scored, each over the last seconds.
//!
//! | module | content |
//! |---|---|
//! | `crackle` | how sudden a sound is |
//! | `lines` | how tonal it is |
//! | `follow` | how well its loudness follows another's |
//! | `diagnosis` | what is wrong, and what to change |

mod crackle;
mod diagnosis;
mod follow;
mod lines;
mod memory;
mod poles;

pub use crackle::Crackle;
pub use diagnosis::Diagnosis;
pub use follow::Follow;
pub use lines::Lines;

/// Figures of a recording, against which those of the output are judged.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Character {
    /// See [`Crackle`].
    pub kurtosis: Option<f64>,
    /// See [`Lines`].
    pub lines_db: Option<f64>,
}

impl Character {
    /// The character of a sound, from its samples.
    pub fn of_samples(samples: impl Iterator<Item = f32>, rate_hz: f64) -> Self {
        let (mut crackle, mut lines) = (Crackle::new(rate_hz), Lines::new(rate_hz));
        for sample in samples {
            crackle.push(sample);
            lines.push(sample);
        }
        Self { kurtosis: crackle.kurtosis(), lines_db: lines.prominence_db() }
    }
}

/// Figures of the output.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Figures {
    /// Correlation of the output's loudness with the drive's.
    pub follows: Option<f64>,
    /// Tones of the output in dB beyond the recording's.
    pub lines_db: Option<f64>,
    /// Kurtosis of the output over that of the recording.
    pub crackle: Option<f64>,
}

impl Figures {
    /// The worst fault; none where all is well.
    pub fn fault(&self) -> Option<Diagnosis> {
        let beyond = |value: Option<f64>, is_bad: &dyn Fn(f64) -> bool| value.is_some_and(is_bad);
        if beyond(self.lines_db, &|lines_db| lines_db > 2.5) {
            Some(Diagnosis::Buzzes)
        } else if beyond(self.follows, &|follows| follows < 0.6) {
            Some(Diagnosis::Wanders)
        } else if beyond(self.crackle, &|crackle| crackle > 2.5) {
            Some(Diagnosis::Sudden)
        } else if beyond(self.crackle, &|crackle| crackle < 0.4) {
            Some(Diagnosis::Dull)
        } else {
            None
        }
    }
}

/// Listens to drive and output.
pub struct Fidelity {
    crackle: Crackle,
    lines: Lines,
    follow: Follow,
    until_told: usize,
    every: usize,
    output: Character,
    follows: Option<f64>,
}

impl Fidelity {
    /// Updates of the figures per second.
    const TOLD_HZ: f64 = 2.0;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let every = ((rate_hz / Self::TOLD_HZ) as usize).max(1);
        Self {
            crackle: Crackle::new(rate_hz),
            lines: Lines::new(rate_hz),
            follow: Follow::new(rate_hz),
            until_told: every,
            every,
            output: Character::default(),
            follows: None,
        }
    }

    /// Adds a sample of the drive, and the output's at the same moment.
    pub fn push(&mut self, drive: f32, output: f32) {
        self.crackle.push(output);
        self.lines.push(output);
        self.follow.push(drive, output);
        self.until_told -= 1;
        if self.until_told == 0 {
            self.until_told = self.every;
            self.output = Character { kurtosis: self.crackle.kurtosis(), lines_db: self.lines.prominence_db() };
            self.follows = self.follow.correlation();
        }
    }

    /// The figures, against a recording's.
    pub fn figures(&self, recording: Option<&Character>) -> Figures {
        let recording = recording.copied().unwrap_or_default();
        let together = |a: Option<f64>, b: Option<f64>, of: fn(f64, f64) -> f64| Some(of(a?, b?));
        Figures {
            follows: self.follows,
            lines_db: together(self.output.lines_db, recording.lines_db, |output, own| (output - own).max(0.0)),
            crackle: together(self.output.kurtosis, recording.kurtosis, |output, own| output / own),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use pyrophone_synthesis::dsp::White;

    use super::*;

    const RATE_HZ: f64 = 44_100.0;

    fn noise(seed: u32) -> impl Iterator<Item = f32> {
        let white = White::new(seed, 0);
        (0..(6.0 * RATE_HZ) as i64).map(move |n| 0.1 * white.sample_at(n) as f32)
    }

    #[test]
    fn steady_noise_has_no_crackle_and_no_lines() {
        let character = Character::of_samples(noise(1), RATE_HZ);
        let (kurtosis, lines_db) = (character.kurtosis.unwrap(), character.lines_db.unwrap());
        // Samples that are evenly distributed have 1.8; a filter makes them a little more like a bell.
        assert!((1.7..2.6).contains(&kurtosis), "{kurtosis}");
        assert!((0.8..3.0).contains(&lines_db), "{lines_db} dB");
        // At another level it is the same.
        let quiet = Character::of_samples(noise(1).map(|x| 1e-3 * x), RATE_HZ);
        assert!((quiet.kurtosis.unwrap() / kurtosis - 1.0).abs() < 0.02);
    }

    #[test]
    fn bursts_crackle_and_tones_are_lines() {
        let white = White::new(7, 1);
        let snaps = noise(2)
            .enumerate()
            .map(|(n, x)| if n % 4001 < 12 { x + 0.8 * white.sample_at(n as i64) as f32 } else { x });
        let kurtosis = Character::of_samples(snaps, RATE_HZ).kurtosis.unwrap();
        assert!(kurtosis > 6.0, "{kurtosis}");
        // A buzz: thirty harmonics of 172 Hz, the hop of a texture window at the top level.
        let buzz = |n: usize| {
            let at = n as f64 / RATE_HZ;
            (3..60).map(|k| (TAU * 172.3 * f64::from(k) * at).sin() as f32).sum::<f32>() * 0.004
        };
        let clean = Character::of_samples(noise(3), RATE_HZ).lines_db.unwrap();
        let buzzing = Character::of_samples(noise(3).enumerate().map(|(n, x)| x + buzz(n)), RATE_HZ).lines_db.unwrap();
        assert!(buzzing > clean + 3.0, "{buzzing} dB, without {clean} dB");
    }

    #[test]
    fn following_is_told_from_not_following() {
        let run = |drive: &dyn Fn(usize) -> f32, output: &dyn Fn(usize) -> f32| {
            let mut follow = Follow::new(RATE_HZ);
            for (n, x) in noise(5).enumerate() {
                follow.push(x * drive(n), x * output(n));
            }
            follow.correlation()
        };
        let swell = |n: usize| 0.1 + (n as f32 / 9000.0).sin().powi(2);
        let other = |n: usize| 0.1 + (n as f32 / 3700.0 + 1.0).sin().powi(2);
        assert!(run(&swell, &swell).unwrap() > 0.95);
        assert!(run(&swell, &other).unwrap() < 0.5);
        assert_eq!(run(&swell, &|_| 0.0), None, "silence follows nothing");
        assert_eq!(Follow::new(RATE_HZ).correlation(), None);
    }

    #[test]
    fn advice_names_the_worst() {
        let good = Figures { follows: Some(0.9), lines_db: Some(0.5), crackle: Some(1.0) };
        assert_eq!(good.fault(), None);
        assert_eq!(Figures::default().fault(), None);
        let says = |figures: Figures| figures.fault().unwrap().advice(false);
        assert!(says(Figures { lines_db: Some(6.0), ..good }).contains("Scaling alpha"));
        assert!(!Diagnosis::Buzzes.advice(true).contains("Scaling alpha"), "that is down already");
        assert!(says(Figures { follows: Some(0.2), ..good }).contains("follow"));
        assert!(says(Figures { crackle: Some(4.0), ..good }).contains("crackles more"));
        assert!(says(Figures { crackle: Some(0.2), ..good }).contains("less"));
    }

    #[test]
    fn bad_samples_leave_finite_figures() {
        let mut fidelity = Fidelity::new(8_000.0);
        for n in 0..100_000 {
            let bad = [f32::NAN, f32::INFINITY, 1e30, 0.1][n % 4];
            fidelity.push(bad, bad);
        }
        for n in 0..400_000 {
            let x = White::new(1, 0).sample_at(n) as f32;
            fidelity.push(x, x);
        }
        let figures = fidelity.figures(Some(&Character { kurtosis: Some(3.0), lines_db: Some(2.0) }));
        assert!([figures.follows, figures.lines_db, figures.crackle].iter().flatten().all(|x| x.is_finite()));
    }
}
