//! Power density from windowed frames (Welch 1967).

use std::f64::consts::TAU;

use maths::fft::{Complex64, RealTransform};

/// Hann's window of `size` samples, periodic: windows that overlap by half add up to 1.
pub fn hann(size: usize) -> Vec<f64> {
    (0..size).map(|n| 0.5 - 0.5 * (TAU * n as f64 / size as f64).cos()).collect()
}

/// Sums the power of frames of one size under Hann's window.
pub struct Welch {
    transform: RealTransform,
    room: Vec<f64>,
    window: Vec<f64>,
    frame: Vec<f64>,
    spectrum: Vec<Complex64>,
    sums: Vec<f64>,
    frames: usize,
    /// Sum of the window's squares.
    energy: f64,
    sample_rate_hz: f64,
}

impl Welch {
    /// Nothing summed yet; frames have `size` samples, at least 2.
    pub fn new(size: usize, sample_rate_hz: f64) -> Self {
        let (transform, window) = (RealTransform::new(size), hann(size));
        Self {
            room: vec![0.0; transform.room()],
            energy: window.iter().map(|x| x * x).sum(),
            window,
            frame: vec![0.0; size],
            spectrum: vec![Complex64::default(); transform.bins()],
            sums: vec![0.0; transform.bins()],
            frames: 0,
            sample_rate_hz,
            transform,
        }
    }

    /// Distance of two bins in Hz.
    pub fn bin_hz(&self) -> f64 {
        self.sample_rate_hz / self.frame.len() as f64
    }

    /// Forgets all frames.
    pub fn reset(&mut self) {
        self.sums.fill(0.0);
        self.frames = 0;
    }

    /// Adds a frame; where the samples end early, silence follows.
    pub fn add(&mut self, samples: impl IntoIterator<Item = f64>) {
        let samples = samples.into_iter().chain(std::iter::repeat(0.0));
        for ((value, sample), weight) in self.frame.iter_mut().zip(samples).zip(&self.window) {
            *value = sample * weight;
        }
        self.transform.forward(&self.frame, &mut self.spectrum, &mut self.room);
        self.sums.iter_mut().zip(&self.spectrum).for_each(|(sum, bin)| *sum += bin.norm_sqr());
        self.frames += 1;
    }

    /// Mean density of the frames by bin, in full scale squared per Hz; all bins except the outermost stand for two.
    pub fn density(&self) -> impl Iterator<Item = f64> + '_ {
        let scale = 2.0 / (self.energy * self.sample_rate_hz * self.frames.max(1) as f64);
        self.sums.iter().map(move |sum| scale * sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sines_power_is_its_own_and_frames_may_end_early() {
        let mut welch = Welch::new(1000, 1000.0);
        let sine = |n: usize| (TAU * 0.1 * n as f64).sin();
        for start in (0..4000).step_by(500) {
            welch.add((start..start + 1000).map(sine));
        }
        let power: f64 = welch.density().sum::<f64>() * welch.bin_hz();
        assert!((power - 0.5).abs() < 1e-9, "{power}");
        welch.reset();
        welch.add([]);
        assert!(welch.density().all(|density| density == 0.0));
    }

    #[test]
    fn half_overlapping_windows_add_up_to_one() {
        let window = hann(64);
        assert!((0..32).all(|n| (window[n] + window[n + 32] - 1.0).abs() < 1e-12));
    }
}
