//! A few neighbouring bins of a long transform of a short signal.

use std::f64::consts::PI;
use std::ops::Range;

use maths::fft::{self, Complex64, ComplexTransform};

/// The chirp transform (Bluestein 1970): bins of a transform of `bins` samples, at the cost of transforms as long as
/// signal and wanted bins together. Exact apart from rounding.
pub(crate) struct ChirpZ {
    fourier: ComplexTransform,
    /// Factors on the input.
    before: Vec<Complex64>,
    /// Factors on the output, scale included.
    after: Vec<Complex64>,
    /// Spectrum of the chirp.
    kernel: Vec<Complex64>,
    work: Vec<Complex64>,
}

impl ChirpZ {
    /// A transform for signals of at most `samples` samples, and the bins in `wanted` of `bins`.
    pub fn new(bins: usize, wanted: Range<usize>, samples: usize) -> Self {
        let len = (samples + wanted.len()).next_power_of_two();
        let fourier = ComplexTransform::new(len);
        // Phases in units of pi / bins, reduced as integers: their squares outgrow a double's angle.
        let phasor = |units: u128| fft::polar(1.0, PI * (units % (2 * bins as u128)) as f64 / bins as f64);
        let chirp = |n: usize| phasor(n as u128 * n as u128);
        let before = (0..samples).map(|n| (chirp(n) * phasor(2 * (wanted.start as u128) * n as u128)).conj()).collect();
        let after = (0..wanted.len()).map(|m| chirp(m).conj() / len as f64).collect();
        let mut kernel = vec![Complex64::default(); len];
        for (m, value) in kernel.iter_mut().enumerate().take(wanted.len()) {
            *value = chirp(m);
        }
        for n in 1..samples {
            kernel[len - n] = chirp(n);
        }
        fourier.forward(&mut kernel);
        Self { fourier, before, after, kernel, work: vec![Complex64::default(); len] }
    }

    /// The wanted bins of `signal`, whose first sample counts as sample 0.
    pub fn transform(&mut self, signal: impl Iterator<Item = Complex64>, out: &mut [Complex64]) {
        self.work.fill(Complex64::default());
        for (work, (sample, factor)) in self.work.iter_mut().zip(signal.zip(&self.before)) {
            *work = sample * factor;
        }
        self.fourier.forward(&mut self.work);
        self.work.iter_mut().zip(&self.kernel).for_each(|(work, kernel)| *work *= kernel);
        self.fourier.inverse(&mut self.work);
        for (bin, (work, factor)) in out.iter_mut().zip(self.work.iter().zip(&self.after)) {
            *bin = work * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    #[test]
    fn equals_the_long_transform() {
        let (bins, samples, wanted) = (4096, 300, 17..160);
        let signal: Vec<Complex64> = (0..samples)
            .map(|n| Complex64::new(White::new(1, 0).sample_at(n), White::new(1, 1).sample_at(n)))
            .collect();
        let mut long = signal.clone();
        long.resize(bins, Complex64::default());
        ComplexTransform::new(bins).forward(&mut long);
        let mut found = vec![Complex64::default(); wanted.len()];
        ChirpZ::new(bins, wanted.clone(), signal.len()).transform(signal.iter().copied(), &mut found);
        for (found, expected) in found.iter().zip(&long[wanted]) {
            assert!((found - expected).norm() < 1e-11, "{found} instead of {expected}");
        }
    }
}
