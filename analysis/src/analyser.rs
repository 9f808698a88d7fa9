//! A running spectrum.

use crate::bands::{BANDS, Bands};
use crate::welch::Welch;

/// Power density by band, over a window that moves along a signal in steps.
pub struct Analyser {
    welch: Welch,
    bands: Bands,
    /// The last samples, oldest first from `next` on.
    past: Vec<f32>,
    next: usize,
    until_step: usize,
    step: usize,
    power: Vec<f32>,
    density: [f32; BANDS],
}

impl Analyser {
    /// An analyser with windows of about `window_s`, one every `step_s`.
    pub fn new(sample_rate_hz: f64, window_s: f64, step_s: f64) -> Self {
        let length = ((window_s * sample_rate_hz) as usize).next_power_of_two().clamp(64, 1 << 16);
        let bins = length / 2 + 1;
        let step = ((step_s * sample_rate_hz).round() as usize).clamp(1, length);
        Self {
            welch: Welch::new(length, sample_rate_hz),
            bands: Bands::new(sample_rate_hz, bins),
            past: vec![0.0; length],
            next: 0,
            until_step: step,
            step,
            power: vec![0.0; bins],
            density: [0.0; BANDS],
        }
    }

    /// Restores silence.
    pub fn reset(&mut self) {
        self.past.fill(0.0);
        self.next = 0;
        self.until_step = self.step;
    }

    /// Adds a sample; returns the densities when a step is complete, in full scale squared per Hz.
    pub fn push(&mut self, sample: f32) -> Option<&[f32; BANDS]> {
        self.past[self.next] = if sample.is_finite() { sample } else { 0.0 };
        self.next += 1;
        if self.next == self.past.len() {
            self.next = 0;
        }
        self.until_step -= 1;
        if self.until_step > 0 {
            return None;
        }
        self.until_step = self.step;
        let (newer, older) = self.past.split_at(self.next);
        self.welch.reset();
        self.welch.add(older.iter().chain(newer).map(|sample| f64::from(*sample)));
        self.power.iter_mut().zip(self.welch.density()).for_each(|(power, density)| *power = density as f32);
        self.bands.gather(&self.power, &mut self.density);
        Some(&self.density)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bands::position;

    #[test]
    fn noise_has_its_density_and_a_tone_its_place() {
        let rate_hz = 48_000.0;
        let noise = pyrophone_synthesis::dsp::White::new(1, 0);
        let mut analyser = Analyser::new(rate_hz, 0.18, 0.02);
        let (mut mean, mut count) = ([0.0f32; BANDS], 0.0);
        for n in 0..480_000 {
            if let Some(density) = analyser.push(0.1 * noise.sample_at(n) as f32) {
                mean.iter_mut().zip(density).for_each(|(sum, x)| *sum += x);
                count += 1.0;
            }
        }
        // Power 0.01 over 24 kHz.
        let expected_db = 10.0 * (0.01f32 / 24_000.0).log10();
        for (band, sum) in mean.iter().enumerate().skip(20) {
            let found_db = 10.0 * (sum / count).log10();
            assert!((found_db - expected_db).abs() < 1.5, "band {band}: {found_db} dB, expected {expected_db} dB");
        }
        let mut analyser = Analyser::new(rate_hz, 0.18, 0.02);
        let mut last = [0.0; BANDS];
        for n in 0..48_000 {
            let tone = (std::f32::consts::TAU * 1000.0 * n as f32 / rate_hz as f32).sin();
            if let Some(density) = analyser.push(tone) {
                last = *density;
            }
        }
        let loudest = (0..BANDS).max_by(|a, b| last[*a].total_cmp(&last[*b])).expect("bands");
        assert!(loudest.abs_diff((position(1000.0) * BANDS as f64) as usize) <= 1, "band {loudest}");
    }

    #[test]
    fn nan_input_produces_silence() {
        let mut analyser = Analyser::new(44_100.0, 0.05, 0.01);
        for _ in 0..10_000 {
            if let Some(density) = analyser.push(f32::NAN) {
                assert!(density.iter().all(|x| *x == 0.0));
            }
        }
    }
}
