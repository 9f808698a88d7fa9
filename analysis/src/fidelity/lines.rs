//! How tonal a sound is.

use std::f64::consts::TAU;

use maths::fft::{Complex64, RealTransform};

use super::memory::{MEMORY_S, PATIENCE_S};

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
        self.next += 1;
        if self.next == self.past.len() {
            self.next = 0;
        }
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
        let index = (above.len() as f64 * Self::PERCENTILE) as usize;
        (index < above.len()).then(|| {
            let (_, found, _) = above.select_nth_unstable_by(index, f32::total_cmp);
            10.0 * f64::from(*found).log10()
        })
    }
}
