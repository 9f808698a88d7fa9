//! Swell: exaggerates or reduces the variation of the drive's slow loudness about its mean.

use crate::error::within;

/// Seconds over which loudness is measured, and those after which it counts 1/e in its mean.
const LOUDNESS_S: f64 = 0.04;
const MEMORY_S: f64 = 8.0;
/// Samples between two computations of the gain, which take a power each; and the time constant in seconds with which the
/// gain follows.
const STEP: u32 = 32;
const SMOOTHING_S: f64 = 0.01;
/// Largest change of a drive, up or down, as a factor: 15 dB.
const MOST: f64 = 5.623;
/// Power below which a drive is silent: -120 dBFS.
const SILENT: f64 = 1e-12;
/// Exponents allowed.
const EXPONENTS: (f64, f64) = (-1.0, 2.0);

/// The gain, and the measurements behind it.
#[derive(Debug, Clone)]
pub(super) struct Swell {
    parts: [f64; 2],
    smoothing: f64,
    power: f64,
    /// Decaying sums of powers and of their weights.
    mean: [f64; 2],
    gain: f64,
    target: f64,
    until_look: u32,
}

impl Swell {
    pub fn new(sample_rate_hz: f64) -> Self {
        let part = |seconds: f64| 1.0 - maths::exp(-1.0 / (seconds * sample_rate_hz));
        Self {
            parts: [part(LOUDNESS_S), part(MEMORY_S)],
            smoothing: part(SMOOTHING_S),
            power: 0.0,
            mean: [0.0; 2],
            gain: 1.0,
            target: 1.0,
            until_look: 0,
        }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        (self.power, self.mean, self.gain, self.target, self.until_look) = (0.0, [0.0; 2], 1.0, 1.0, 0);
    }

    /// Multiplies the drive by (loudness / mean loudness)^`exponent`; at 0 it passes bit for bit.
    pub fn process(&mut self, exponent: f64, drive: &mut [f64]) {
        if exponent == 0.0 || exponent.is_nan() {
            self.reset();
            return;
        }
        let exponent = within(exponent, EXPONENTS.0, EXPONENTS.1);
        let [fast, slow] = self.parts;
        for sample in drive {
            let square = *sample * *sample;
            self.power += fast * (square - self.power);
            // Silence does not count, or anything after it would be loud.
            if self.power > SILENT {
                let [sum, count] = self.mean;
                self.mean = [sum + slow * (self.power - sum), count + slow * (1.0 - count)];
            }
            if self.until_look == 0 {
                self.until_look = STEP;
                self.target = self.look(exponent);
            }
            self.until_look -= 1;
            self.gain += self.smoothing * (self.target - self.gain);
            *sample *= self.gain;
        }
    }

    fn look(&self, exponent: f64) -> f64 {
        let [sum, count] = self.mean;
        if self.power <= SILENT || sum <= 0.0 {
            return 1.0;
        }
        within(maths::pow(self.power * count / sum, 0.5 * exponent), 1.0 / MOST, MOST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Range in dB between loud and soft seconds of a drive that swells by 6 dB.
    fn range_db(exponent: f64) -> f64 {
        let rate_hz = 8000.0;
        let mut swell = Swell::new(rate_hz);
        let noise = crate::dsp::White::new(1, 0);
        let level = |n: usize| if (n / 8000).is_multiple_of(2) { 0.1 } else { 0.2 };
        let mut drive: Vec<f64> = (0..160_000).map(|n| level(n) * noise.sample_at(n as i64)).collect();
        swell.process(exponent, &mut drive);
        let power = |second: usize| drive[second * 8000 + 2000..(second + 1) * 8000].iter().map(|x| x * x).sum::<f64>();
        10.0 * (power(19) / power(18)).log10()
    }

    #[test]
    fn loudness_varies_more_or_less_as_asked() {
        for (exponent, expected_db) in [(-0.5, 3.0), (0.0, 6.0), (0.5, 9.0), (1.0, 12.0)] {
            let found = range_db(exponent);
            assert!((found - expected_db).abs() < 1.0, "{exponent}: {found} dB for {expected_db}");
        }
    }

    #[test]
    fn zero_is_bit_exact_and_nonsense_harmless() {
        let drive: Vec<f64> = (0..1000).map(|n| f64::from(n).sin()).collect();
        for exponent in [0.0, f64::NAN] {
            let mut same = drive.clone();
            Swell::new(48_000.0).process(exponent, &mut same);
            assert_eq!(same, drive);
        }
        let mut silence = vec![0.0; 1000];
        Swell::new(48_000.0).process(f64::INFINITY, &mut silence);
        assert_eq!(silence, [0.0; 1000]);
    }

    #[test]
    fn blocks_do_not_matter() {
        let drive: Vec<f64> = (0..5000).map(|n| f64::from(n).sin() * f64::from(n) * 1e-4).collect();
        let run = |block: usize| {
            let (mut swell, mut out) = (Swell::new(48_000.0), drive.clone());
            out.chunks_mut(block).for_each(|piece| swell.process(0.7, piece));
            out
        };
        assert_eq!(run(5000), run(17));
        assert_eq!(run(5000), run(1));
    }
}
