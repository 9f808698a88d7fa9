//! A burst of flame, added to the input, for trying settings without a flame.

use std::f64::consts::TAU;

use pyrophone_synthesis::dsp::White;

/// Length in seconds.
const LENGTH_S: f64 = 1.6;
/// Attack and decay times, in seconds.
const ATTACK_S: f64 = 0.03;
const DECAY_S: f64 = 0.35;
/// Upper cut-off in Hz: the limit up to which a flame is simulated.
const CUTOFF_HZ: f64 = 180.0;
/// Peak amplitude.
const PEAK: f64 = 0.5;

/// A burst, its playback position, and its level.
#[derive(Debug, Default)]
pub struct Burst {
    samples: Vec<f32>,
    at: usize,
    level: f32,
}

impl Burst {
    /// A burst that is not playing yet. Allocates.
    pub fn new(sample_rate_hz: f64) -> Self {
        let noise = White::new(0x4255_5253, 0);
        let part = 1.0 - maths::exp(-TAU * CUTOFF_HZ / sample_rate_hz);
        let mut poles = [0.0f64; 4];
        let sample = |n: usize| {
            let mut value = noise.sample_at(n as i64);
            for pole in &mut poles {
                *pole += part * (value - *pole);
                value = *pole;
            }
            let time_s = n as f64 / sample_rate_hz;
            let swell = (time_s / ATTACK_S).min(1.0);
            // The last fifth fades the remainder to zero.
            let end = ((LENGTH_S - time_s) / (0.2 * LENGTH_S)).min(1.0);
            value * swell * end * maths::exp(-time_s / DECAY_S)
        };
        let samples: Vec<f64> = (0..(LENGTH_S * sample_rate_hz) as usize).map(sample).collect();
        let peak = samples.iter().fold(1e-9f64, |peak, x| peak.max(x.abs()));
        let at = samples.len();
        Self { samples: samples.iter().map(|x| (x * PEAK / peak) as f32).collect(), at, level: 1.0 }
    }

    /// Starts the burst at a level of 0-1; one that is playing starts again.
    pub fn start(&mut self, level: f32) {
        self.level = if level.is_finite() { level.clamp(0.0, 1.0) } else { 0.0 };
        self.at = 0;
    }

    /// Stops at once.
    pub fn stop(&mut self) {
        self.at = self.samples.len();
    }

    /// The level.
    pub fn level(&self) -> f32 {
        self.level
    }

    /// The next samples at full level, `most` at most; none when it is over.
    pub fn next(&mut self, most: usize) -> &[f32] {
        let from = self.at;
        self.at = self.samples.len().min(from + most);
        &self.samples[from..self.at]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_bursts_once_and_is_low() {
        let mut burst = Burst::new(48_000.0);
        assert!(burst.next(100).is_empty(), "nobody has lit it");
        burst.start(1.0);
        let mut all = vec![];
        loop {
            let next = burst.next(1000);
            if next.is_empty() {
                break;
            }
            all.extend_from_slice(next);
        }
        assert_eq!(all.len(), 76_800);
        let energy = |samples: &[f32]| samples.iter().map(|x| x * x).sum::<f32>();
        let steps: Vec<f32> = all.windows(2).map(|pair| pair[1] - pair[0]).collect();
        // A tone's steps are (2 pi f / rate)^2 of its power: 180 Hz and less.
        let mean_hz = (energy(&steps) / energy(&all)).sqrt() * 48_000.0 / std::f32::consts::TAU;
        assert!((30.0..180.0).contains(&mean_hz), "{mean_hz} Hz");
        assert!(energy(&all[..24_000]) > 5.0 * energy(&all[24_000..]));
        assert!(all[0].abs() < 1e-3 && all.last().unwrap().abs() < 1e-3);
    }
}
