//! From the source over time to its sound: a period without a seam, its third derivative, band-limited.
//!
//! The period is a sum of waves, so derivative, low-pass and change of rate are exact, wave by wave.

use std::f64::consts::{PI, TAU};

use pyrophone_synthesis::vortex::texture::Row;

/// Number of series in a texture's row.
pub const COMPONENTS: usize = pyrophone_synthesis::vortex::texture::COMPONENTS;

/// Pass band of frequencies in Hz, with its transition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Start of the transition band.
    pub pass_hz: f64,
    /// End of the transition band.
    pub stop_hz: f64,
}

impl Band {
    /// The reliable band of a flow that crosses `voxels_hz` voxels per second, in steps of `step_hz` per second, for
    /// rows of `rate_hz`: the smallest eddies, of two voxels, pass with half the former. Above, the third derivative
    /// would raise only the grid's own noise.
    pub fn of_flow(voxels_hz: f64, step_hz: f64, rate_hz: f64) -> Self {
        let stop_hz = (0.6 * voxels_hz).min(0.45 * step_hz).min(0.45 * rate_hz);
        Self { pass_hz: 0.75 * stop_hz, stop_hz }
    }

    /// Factor of a frequency in Hz.
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        if frequency_hz <= self.pass_hz {
            return 1.0;
        }
        if frequency_hz >= self.stop_hz {
            return 0.0;
        }
        let share = (frequency_hz - self.pass_hz) / (self.stop_hz - self.pass_hz);
        0.5 + 0.5 * maths::cos(PI * share)
    }
}

/// Five series over one period that repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    values: Vec<[f64; COMPONENTS]>,
    step_s: f64,
}

impl Series {
    /// The first `period` of `values`, which are `step_s` apart: its beginning is crossfaded, at equal power, from the
    /// values after its end. The series' means are removed first, because such a fade would raise them in between. The
    /// fade's first three derivatives are continuous, so the sound has no seam.
    ///
    /// Values beyond twice the period are ignored.
    pub fn looped(values: &[[f64; COMPONENTS]], period: usize, step_s: f64) -> Self {
        let count = values.len().max(1) as f64;
        let mut mean = [0.0; COMPONENTS];
        for value in values {
            mean.iter_mut().zip(value).for_each(|(mean, value)| *mean += value / count);
        }
        let (body, tail) = values.split_at(period.min(values.len()));
        let fade = tail.len().min(body.len());
        let mix = |(step, value): (usize, &[f64; COMPONENTS])| {
            let rest = |value: &[f64; COMPONENTS], c: usize| value[c] - mean[c];
            std::array::from_fn(|c| {
                if step >= fade {
                    return rest(value, c);
                }
                let (sin, cos) = maths::sin_cos(0.5 * PI * smooth(step as f64 / fade as f64));
                sin * rest(value, c) + cos * rest(&tail[step], c)
            })
        };
        Self { values: body.iter().enumerate().map(mix).collect(), step_s }
    }

    /// The values, and the time between them in s.
    pub fn values(&self) -> (&[[f64; COMPONENTS]], f64) {
        (&self.values, self.step_s)
    }

    /// The third time derivative, in units per s³, as `samples` samples of the period, limited to `band`.
    pub fn sound(&self, samples: usize, band: Band) -> Self {
        let steps = self.values.len();
        let period_s = steps as f64 * self.step_s;
        let highest = (0.5 * steps.min(samples) as f64).min(band.stop_hz * period_s).ceil().max(1.0) as usize;
        let (forth, back) = (turns(steps), turns(samples));
        let mut sound = vec![[0.0; COMPONENTS]; samples];
        for wave in 1..highest {
            let (mut re, mut im) = ([0.0; COMPONENTS], [0.0; COMPONENTS]);
            let mut turn = 0;
            for value in &self.values {
                let (sin, cos) = forth[turn];
                for c in 0..COMPONENTS {
                    re[c] += value[c] * cos;
                    im[c] -= value[c] * sin;
                }
                turn = (turn + wave) % steps;
            }
            let frequency_hz = wave as f64 / period_s;
            // Both waves of the pair; (iω)³ = -iω³.
            let factor = 2.0 / steps as f64 * band.gain(frequency_hz) * maths::powi(TAU * frequency_hz, 3);
            let (re, im) = (im.map(|im| factor * im), re.map(|re| -factor * re));
            let mut turn = 0;
            for value in &mut sound {
                let (sin, cos) = back[turn];
                for c in 0..COMPONENTS {
                    value[c] += re[c] * cos - im[c] * sin;
                }
                turn = (turn + wave) % samples;
            }
        }
        Self { values: sound, step_s: period_s / samples as f64 }
    }

    /// A texture's row for `speed_m_s`; `pressure_pa` is the pressure of one unit at a distance of 1 m.
    pub fn row(&self, speed_m_s: f64, pressure_pa: f64) -> Row {
        let power: f64 = self.values.iter().flatten().map(|value| value * value).sum();
        let rms = (power / self.values.len().max(1) as f64).sqrt();
        let scale = if rms > 0.0 { 1.0 / rms } else { 0.0 };
        Row {
            speed_m_s,
            // Rounded as in a file.
            gain: f64::from((rms * pressure_pa) as f32),
            components: std::array::from_fn(|c| self.values.iter().map(|value| (value[c] * scale) as f32).collect()),
        }
    }
}

/// Sine and cosine at `parts` equal divisions of a turn.
fn turns(parts: usize) -> Vec<(f64, f64)> {
    (0..parts).map(|part| maths::sin_cos(TAU * part as f64 / parts as f64)).collect()
}

/// A step from 0 to 1 whose first three derivatives are 0 at both ends.
fn smooth(x: f64) -> f64 {
    maths::powi(x, 4) * (35.0 - 84.0 * x + 70.0 * x * x - 20.0 * maths::powi(x, 3))
}
