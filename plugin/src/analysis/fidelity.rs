//! Running scores of the output: its similarity to the recording, and its correlation with the drive. They are the
//! figures by which whole results are scored, each over the last seconds.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use pyrophone_synthesis::fft::{Complex64, RealTransform};

/// Seconds over which figures are averaged.
const MEMORY_S: f64 = 8.0;

/// Seconds of sound before a figure is given.
const PATIENCE_S: f64 = 2.0;

/// Two cascaded low-pass poles at one frequency; the remainder is the high-pass.
#[derive(Debug, Clone, Copy)]
struct Poles {
    part: f64,
    state: [f64; 2],
}

impl Poles {
    fn new(cutoff_hz: f64, rate_hz: f64) -> Self {
        Self { part: 1.0 - (-TAU * cutoff_hz / rate_hz).exp(), state: [0.0; 2] }
    }

    fn low(&mut self, value: f64) -> f64 {
        self.state[0] += self.part * (value - self.state[0]);
        self.state[1] += self.part * (self.state[0] - self.state[1]);
        // Values this small matter to no figure, and denormals are slow.
        self.state.iter_mut().filter(|state| state.abs() < 1e-30).for_each(|state| *state = 0.0);
        self.state[1]
    }

    fn high(&mut self, value: f64) -> f64 {
        let low = self.low(value);
        value - low
    }
}

/// Suddenness of a sound: the kurtosis of its part above 1 kHz, with the slow loudness removed. 3 for Gaussian noise.
#[derive(Debug, Clone)]
pub struct Crackle {
    high: [Poles; 2],
    loudness: Poles,
    /// Powers waiting until the loudness after them is known too.
    waiting: VecDeque<f64>,
    loudest: f64,
    forget: f64,
    moments: [f64; 2],
    weight: f64,
}

impl Crackle {
    /// Lowest frequency in Hz that crackles, and the fastest loudness in Hz that is slow.
    const LOW_HZ: f64 = 1000.0;
    const SLOW_HZ: f64 = 8.0;
    /// Share of the loudest power below which a sound counts as silent: -40 dB.
    const ACTIVE: f64 = 1e-2;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let forget = 1.0 / (MEMORY_S * rate_hz);
        let high = [Poles::new(Self::LOW_HZ, rate_hz); 2];
        let loudness = Poles::new(Self::SLOW_HZ, rate_hz);
        // Two poles lag by their time constants.
        let lag = (2.0 * rate_hz / (TAU * Self::SLOW_HZ)) as usize;
        let waiting = VecDeque::from(vec![0.0; lag]);
        Self { high, loudness, waiting, loudest: 0.0, forget, moments: [0.0; 2], weight: 0.0 }
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: f32) {
        let sample = if sample.is_finite() { f64::from(sample) } else { 0.0 };
        let high = self.high.iter_mut().fold(sample, |sample, poles| poles.high(sample));
        let power = self.loudness.low(high * high);
        self.waiting.push_back(high * high);
        let square = self.waiting.pop_front().unwrap_or(0.0);
        self.loudest = power.max(self.loudest * (1.0 - self.forget));
        if power > Self::ACTIVE * Self::ACTIVE * self.loudest && power > 1e-20 {
            let flat = square / power;
            for (moment, value) in self.moments.iter_mut().zip([flat, flat * flat]) {
                *moment += self.forget * (value - *moment);
            }
            self.weight += self.forget * (1.0 - self.weight);
        }
    }

    /// The recent kurtosis; none before two seconds of sound.
    pub fn kurtosis(&self) -> Option<f64> {
        let known = 1.0 - (-PATIENCE_S / MEMORY_S).exp();
        let [square, fourth] = self.moments;
        // Both have the same weight, so one of it is left over.
        (self.weight >= known && square > 0.0).then(|| fourth * self.weight / (square * square))
    }
}

/// Tones in a sound: the height of its spectrum above its own neighbourhood, as the 99th percentile from 500 Hz to 10
/// kHz. Noise has some 2 dB; a buzz has more.
pub struct Lines {
    transform: RealTransform,
    room: Vec<f64>,
    window: Vec<f32>,
    past: Vec<f32>,
    next: usize,
    until_step: usize,
    time: Vec<f64>,
    spectrum: Vec<Complex64>,
    power: Vec<f32>,
    part: f32,
    steps: usize,
    bin_hz: f64,
}

impl Lines {
    /// Length of a window in seconds, at most, and windows that overlap.
    const WINDOW_S: f64 = 0.38;
    const OVERLAP: usize = 4;
    /// Half the width of the neighbourhood in Hz, the same as in the figure for whole files.
    const NEAR_HZ: f64 = 135.0;
    /// Band in Hz, and the percentile given.
    const BAND_HZ: (f64, f64) = (500.0, 10_000.0);
    const PERCENTILE: f64 = 0.99;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let length = 1 << ((rate_hz * Self::WINDOW_S).log2() as usize).clamp(8, 17);
        // Blackman-Harris: its side lobes lie 92 dB down.
        let window = (0..length).map(|n| {
            let angle = TAU * n as f64 / length as f64;
            (0.35875 - 0.48829 * angle.cos() + 0.14128 * (2.0 * angle).cos() - 0.01168 * (3.0 * angle).cos()) as f32
        });
        let transform = RealTransform::new(length);
        let step_s = length as f64 / Self::OVERLAP as f64 / rate_hz;
        Self {
            window: window.collect(),
            past: vec![0.0; length],
            next: 0,
            until_step: length,
            time: vec![0.0; length],
            spectrum: vec![Complex64::default(); transform.bins()],
            room: vec![0.0; transform.room()],
            power: vec![0.0; length / 2 + 1],
            part: (step_s / MEMORY_S) as f32,
            steps: 0,
            bin_hz: rate_hz / length as f64,
            transform,
        }
    }

    /// Adds a sample.
    pub fn push(&mut self, sample: f32) {
        self.past[self.next] = if sample.is_finite() { sample } else { 0.0 };
        self.next = (self.next + 1) % self.past.len();
        self.until_step -= 1;
        if self.until_step > 0 {
            return;
        }
        self.until_step = self.past.len() / Self::OVERLAP;
        let (newer, older) = self.past.split_at(self.next);
        for ((out, sample), weight) in self.time.iter_mut().zip(older.iter().chain(newer)).zip(&self.window) {
            *out = f64::from(sample * weight);
        }
        self.transform.forward(&self.time, &mut self.spectrum, &mut self.room);
        // A plain mean until the memory is full.
        let part = self.part.max(1.0 / (self.steps + 1) as f32);
        for (power, bin) in self.power.iter_mut().zip(&self.spectrum) {
            *power += part * (bin.norm_sqr() as f32 - *power);
        }
        self.steps += 1;
    }

    /// The figure in dB; none before two seconds of sound. Computing it needs some milliseconds.
    pub fn prominence_db(&self) -> Option<f64> {
        let step_s = f64::from(self.part) * MEMORY_S;
        if (self.steps as f64) * step_s < PATIENCE_S {
            return None;
        }
        let near = ((Self::NEAR_HZ / self.bin_hz) as usize).max(10);
        let top = Self::BAND_HZ.1.min(0.45 * self.bin_hz * 2.0 * self.power.len() as f64);
        let band = (Self::BAND_HZ.0 / self.bin_hz) as usize..(top / self.bin_hz) as usize;
        let mut around = vec![];
        let mut above: Vec<f32> = band
            .filter_map(|bin| {
                around.clear();
                around.extend_from_slice(self.power.get(bin.saturating_sub(near)..bin + near + 1)?);
                let middle = around.len() / 2;
                let (_, median, _) = around.select_nth_unstable_by(middle, f32::total_cmp);
                (*median > 0.0).then(|| self.power[bin] / *median)
            })
            .collect();
        let place = (above.len() as f64 * Self::PERCENTILE) as usize;
        (place < above.len()).then(|| {
            let (_, found, _) = above.select_nth_unstable_by(place, f32::total_cmp);
            10.0 * f64::from(*found).log10()
        })
    }
}

/// Agreement of two sounds' loudness: correlation of both envelopes in dB.
#[derive(Debug, Clone)]
pub struct Follow {
    high: [Poles; 2],
    envelopes: [Poles; 2],
    step: usize,
    until_step: usize,
    pairs: VecDeque<[f64; 2]>,
}

impl Follow {
    /// Lowest frequency in Hz of the sound that follows; the fastest envelope in Hz; pairs per second.
    const LOW_HZ: f64 = 500.0;
    const ENVELOPE_HZ: f64 = 20.0;
    const PAIRS_HZ: f64 = 100.0;
    /// Level in dB below the loudest at which all sounds count as equally soft.
    const RANGE_DB: f64 = 50.0;

    /// The state before the first sample.
    pub fn new(rate_hz: f64) -> Self {
        let step = ((rate_hz / Self::PAIRS_HZ).round() as usize).max(1);
        let high = [Poles::new(Self::LOW_HZ, rate_hz); 2];
        let envelopes = [Poles::new(Self::ENVELOPE_HZ, rate_hz); 2];
        Self { high, envelopes, step, until_step: step, pairs: VecDeque::new() }
    }

    /// Adds one sample of the leading and one of the following sound, at the same moment.
    pub fn push(&mut self, leads: f32, follows: f32) {
        let clean = |sample: f32| if sample.is_finite() { f64::from(sample) } else { 0.0 };
        let follows = self.high.iter_mut().fold(clean(follows), |sample, poles| poles.high(sample));
        let [led, following] = &mut self.envelopes;
        let now = [led.low(clean(leads).abs()), following.low(follows.abs())];
        self.until_step -= 1;
        if self.until_step == 0 {
            self.until_step = self.step;
            self.pairs.push_back(now);
            if self.pairs.len() as f64 > MEMORY_S * Self::PAIRS_HZ {
                self.pairs.pop_front();
            }
        }
    }

    /// The correlation, -1 to 1; none before two seconds, and where one of the two does not change.
    pub fn correlation(&self) -> Option<f64> {
        if (self.pairs.len() as f64) < PATIENCE_S * Self::PAIRS_HZ {
            return None;
        }
        let loudest = self.pairs.iter().fold([0.0f64; 2], |[a, b], pair| [a.max(pair[0]), b.max(pair[1])]);
        let level = |pair: &[f64; 2], which: usize| {
            let floor = loudest[which] * 10f64.powf(-Self::RANGE_DB / 20.0);
            20.0 * (pair[which].max(floor) + 1e-30).log10()
        };
        let count = self.pairs.len() as f64;
        let mean = [0, 1].map(|which| self.pairs.iter().map(|pair| level(pair, which)).sum::<f64>() / count);
        let (mut both, mut squares) = (0.0, [0.0; 2]);
        for pair in &self.pairs {
            let [a, b] = [0, 1].map(|which| level(pair, which) - mean[which]);
            both += a * b;
            squares[0] += a * a;
            squares[1] += b * b;
        }
        let changes = squares.iter().all(|square| square / count > 0.01);
        changes.then(|| both / (squares[0] * squares[1]).sqrt())
    }
}

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
    pub fn of(samples: impl Iterator<Item = f32>, rate_hz: f64) -> Self {
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

/// Fault of the output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Diagnosis {
    /// Tones are prominent.
    Buzzes,
    /// Tones are likely: loudness is matched over a large range.
    MayBuzz,
    /// Its loudness does not follow the drive.
    Wanders,
    /// It is more sudden than the recording.
    Sudden,
    /// It is less sudden than the recording.
    Dull,
}

impl Diagnosis {
    /// The suggested change, in plain words; `is_calm` if none of the texture's controls has room left for it.
    pub fn advice(self, is_calm: bool) -> &'static str {
        match self {
            Self::Buzzes if is_calm => {
                "It has tones that the recording does not have: try a longer, livelier recording."
            }
            Self::Buzzes => "It buzzes: turn Scaling auto on, Scaling alpha down, or Dynamics mode to companded.",
            Self::MayBuzz => {
                "Drive and recording differ so much in loudness that this may buzz: turn Scaling auto on, or Scaling alpha down."
            }
            Self::Wanders if is_calm => "It does not follow the drive: turn a steady layer down.",
            Self::Wanders => "It does not follow the drive: turn Dynamics up, or a steady layer down.",
            Self::Sudden if is_calm => "It crackles more than the recording.",
            Self::Sudden => "It crackles more than the recording: turn Drive match down.",
            Self::Dull if is_calm => "It crackles less than the recording: turn extension and vortex down.",
            Self::Dull => "It crackles less than the recording: turn Drive match up, or extension and vortex down.",
        }
    }
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
    use pyrophone_synthesis::noise::White;

    use super::*;

    const RATE_HZ: f64 = 44_100.0;

    fn noise(seed: u32) -> impl Iterator<Item = f32> {
        let white = White::new(seed, 0);
        (0..(6.0 * RATE_HZ) as i64).map(move |n| 0.1 * white.at(n) as f32)
    }

    #[test]
    fn steady_noise_has_no_crackle_and_no_lines() {
        let character = Character::of(noise(1), RATE_HZ);
        let (kurtosis, lines_db) = (character.kurtosis.unwrap(), character.lines_db.unwrap());
        // Samples that are evenly distributed have 1.8; a filter makes them a little more like a bell.
        assert!((1.7..2.6).contains(&kurtosis), "{kurtosis}");
        assert!((0.8..3.0).contains(&lines_db), "{lines_db} dB");
        // At another level it is the same.
        let quiet = Character::of(noise(1).map(|x| 1e-3 * x), RATE_HZ);
        assert!((quiet.kurtosis.unwrap() / kurtosis - 1.0).abs() < 0.02);
    }

    #[test]
    fn bursts_crackle_and_tones_are_lines() {
        let white = White::new(7, 1);
        let snaps =
            noise(2).enumerate().map(|(n, x)| if n % 4001 < 12 { x + 0.8 * white.at(n as i64) as f32 } else { x });
        let kurtosis = Character::of(snaps, RATE_HZ).kurtosis.unwrap();
        assert!(kurtosis > 6.0, "{kurtosis}");
        // A buzz: thirty harmonics of 172 Hz, the hop of a texture window at the top level.
        let buzz = |n: usize| {
            let at = n as f64 / RATE_HZ;
            (3..60).map(|k| (TAU * 172.3 * f64::from(k) * at).sin() as f32).sum::<f32>() * 0.004
        };
        let clean = Character::of(noise(3), RATE_HZ).lines_db.unwrap();
        let buzzing = Character::of(noise(3).enumerate().map(|(n, x)| x + buzz(n)), RATE_HZ).lines_db.unwrap();
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
            let x = White::new(1, 0).at(n) as f32;
            fidelity.push(x, x);
        }
        let figures = fidelity.figures(Some(&Character { kurtosis: Some(3.0), lines_db: Some(2.0) }));
        assert!([figures.follows, figures.lines_db, figures.crackle].iter().flatten().all(|x| x.is_finite()));
    }
}
