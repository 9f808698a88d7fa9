//! Transforms of any length, by means of longer ones whose length is a power of two.

use std::f64::consts::PI;

use super::{Complex64, ComplexTransform, Parts, polar};

/// Bluestein's chirp transform (1970): a transform is a convolution with a chirp.
#[derive(Debug)]
pub(super) struct Chirp {
    longer: ComplexTransform,
    chirp: Vec<Complex64>,
    /// Spectrum of the chirp, and the longer transform's scale.
    kernel: Vec<Complex64>,
}

impl Chirp {
    /// Transforms of `len` samples.
    pub fn new(len: usize) -> Self {
        let longer = ComplexTransform::new((2 * len - 1).next_power_of_two());
        // Phases in units of pi / len, reduced as integers: their squares outgrow a double's angle.
        let phase = |n: usize| (n as u128 * n as u128 % (2 * len as u128)) as f64;
        let chirp: Vec<Complex64> = (0..len).map(|n| polar(1.0, -PI * phase(n) / len as f64)).collect();
        let mut kernel = vec![Complex64::default(); longer.len()];
        for (n, value) in chirp.iter().enumerate() {
            let value = value.conj() / longer.len() as f64;
            kernel[n] = value;
            kernel[(longer.len() - n) % longer.len()] = value;
        }
        longer.forward(&mut kernel);
        Self { longer, chirp, kernel }
    }

    /// Length of working memory that [`run`](Self::run) needs.
    pub fn room(&self) -> usize {
        self.longer.room() + 2 * self.longer.len()
    }

    /// Transforms `samples` in place.
    pub fn run(&self, samples: &mut Parts<'_>, room: &mut [f64]) {
        let (room, kept) = room.split_at_mut(self.longer.room());
        let (kept_re, kept_im) = kept[..2 * self.longer.len()].split_at_mut(self.longer.len());
        let [input, _] = self.longer.halves(room);
        input.re.fill(0.0);
        input.im.fill(0.0);
        for (n, chirp) in self.chirp.iter().enumerate() {
            let value = Complex64::new(samples.re[n], samples.im[n]) * chirp;
            (input.re[n], input.im[n]) = (value.re, value.im);
        }
        let spectrum = self.longer.run(room);
        for (n, kernel) in self.kernel.iter().enumerate() {
            let value = Complex64::new(spectrum.re[n], spectrum.im[n]) * kernel;
            (kept_re[n], kept_im[n]) = (value.re, value.im);
        }
        // With real and imaginary parts exchanged, before and after, a transform is its inverse.
        let [input, _] = self.longer.halves(room);
        input.re.copy_from_slice(kept_im);
        input.im.copy_from_slice(kept_re);
        let result = self.longer.run(room);
        for (n, chirp) in self.chirp.iter().enumerate() {
            let value = Complex64::new(result.im[n], result.re[n]) * chirp;
            (samples.re[n], samples.im[n]) = (value.re, value.im);
        }
    }
}
