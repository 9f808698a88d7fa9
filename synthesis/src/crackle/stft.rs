//! Short-time spectra of a signal, and back.

use std::f64::consts::PI;

use maths::fft::Complex64;

use crate::dsp::Transform;

/// Length of a window in seconds, rounded to the nearest power of two: 256 samples at 44.1 kHz. A crackle is shorter,
/// and its octaves are resolved.
const WINDOW_S: f64 = 0.0058;
/// Windows overlap by three quarters.
const OVERLAP: usize = 4;
/// Sum of the squares of Hann windows that overlap so.
const SQUARES: f64 = 1.5;

/// Windows of Hann at analysis and synthesis. Frame k is centred on sample k hops.
#[derive(Debug)]
pub(super) struct Stft {
    transform: Transform,
    window: Vec<f64>,
}

impl Stft {
    /// A transform for signals at `sample_rate_hz`.
    pub fn new(sample_rate_hz: f64) -> Self {
        let len = 1usize << (maths::log2(WINDOW_S * sample_rate_hz).round() as u32).clamp(4, 12);
        let window = (0..len).map(|i| 0.5 - 0.5 * maths::cos(2.0 * PI * i as f64 / len as f64)).collect();
        Self { transform: Transform::new(len), window }
    }

    /// Samples of a window.
    pub fn len(&self) -> usize {
        self.window.len()
    }

    /// Samples from one frame to the next.
    pub fn hop(&self) -> usize {
        self.window.len() / OVERLAP
    }

    /// Frequencies of a spectrum.
    pub fn bins(&self) -> usize {
        self.transform.bins()
    }

    /// Frames that see a signal.
    pub fn frames(&self, samples: usize) -> usize {
        (samples + self.len() / 2).div_ceil(self.hop())
    }

    /// The root of the mean power of a white noise of variance 1 in one bin.
    pub fn white_rms(&self) -> f64 {
        self.window.iter().map(|x| x * x).sum::<f64>().sqrt()
    }

    /// Analyses `frame` of a signal; beyond its ends there is silence.
    pub fn analyse(&mut self, signal: &[f64], frame: usize) {
        let sample = |at: Option<usize>| at.and_then(|at| signal.get(at)).copied().unwrap_or(0.0);
        let half = self.len() / 2;
        let first = frame * self.hop();
        for (i, (time, weight)) in self.transform.time.iter_mut().zip(&self.window).enumerate() {
            *time = weight * sample((first + i).checked_sub(half));
        }
        self.transform.forward();
    }

    /// Spectrum of the last frame.
    pub fn spectrum(&self) -> &[Complex64] {
        &self.transform.spectrum
    }

    /// Adds the contribution of `frame` to a signal with `spectrum` to `out`.
    pub fn add(&mut self, spectrum: &[Complex64], frame: usize, out: &mut [f64]) {
        self.transform.spectrum.copy_from_slice(spectrum);
        self.transform.inverse();
        let (half, first) = (self.len() / 2, frame * self.hop());
        let scale = 1.0 / (SQUARES * self.len() as f64);
        for (i, (time, weight)) in self.transform.time.iter().zip(&self.window).enumerate() {
            if let Some(sample) = (first + i).checked_sub(half).and_then(|at| out.get_mut(at)) {
                *sample += scale * weight * time;
            }
        }
    }
}
