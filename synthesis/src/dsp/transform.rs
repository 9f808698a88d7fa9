//! Filtering by real Fourier transforms of one fixed length.

use maths::fft::{Complex64, RealTransform};

/// Forward and inverse transforms of one length, and zero-phase filters for them. Nothing
/// allocates after `new`.
pub(crate) struct Transform {
    transform: RealTransform,
    room: Vec<f64>,
    /// Time signal: the input of `forward`, the output of `inverse`.
    pub time: Vec<f64>,
    /// Spectrum of bins 0..=len/2.
    pub spectrum: Vec<Complex64>,
}

/// The shortest quick length of at least `samples`: a power of two, or 3 or 9 times one.
pub(crate) fn quick_len(samples: usize) -> usize {
    [1, 3, 9]
        .map(|factor| factor * samples.div_ceil(factor).next_power_of_two().max(2))
        .into_iter()
        .fold(usize::MAX, usize::min)
}

impl std::fmt::Debug for Transform {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.debug_struct("Transform").field("len", &self.len()).finish_non_exhaustive()
    }
}

impl Transform {
    /// Transforms of `len` samples; `len` is even.
    pub fn new(len: usize) -> Self {
        let transform = RealTransform::new(len);
        Self {
            room: vec![0.0; transform.room()],
            time: vec![0.0; len],
            spectrum: vec![Complex64::default(); transform.bins()],
            transform,
        }
    }

    /// Length in samples.
    pub fn len(&self) -> usize {
        self.transform.samples()
    }

    /// Number of bins from 0 Hz to half the sample rate.
    pub fn bins(&self) -> usize {
        self.transform.bins()
    }

    /// `time` to `spectrum`.
    pub fn forward(&mut self) {
        self.transform.forward(&self.time, &mut self.spectrum, &mut self.room);
    }

    /// `spectrum` to `time`, scaled by `len`.
    pub fn inverse(&mut self) {
        self.transform.inverse(&self.spectrum, &mut self.time, &mut self.room);
    }

    /// Multiplies `spectrum` by a zero-phase filter's, made by [`response`](Self::response), and transforms back.
    /// Sample i of `time` is then sample i of the filtered signal wherever the filter did not reach around the ends.
    pub fn filter(&mut self, response: &[f64]) {
        for (bin, gain) in self.spectrum.iter_mut().zip(response) {
            *bin *= gain;
        }
        self.inverse();
    }

    /// Spectrum of the zero-phase filter whose taps at 0, 1, 2, ... are `half`, and which mirrors
    /// them at -1, -2, ...; divided by `len`, so that [`filter`](Self::filter) has gain 1.
    /// Overwrites `time` and `spectrum`.
    pub fn response(&mut self, half: &[f64], out: &mut [f64]) {
        let scale = 1.0 / self.len() as f64;
        let len = self.len();
        self.time.fill(0.0);
        self.time[0] = half[0] * scale;
        for (tap, value) in half.iter().enumerate().skip(1) {
            self.time[tap] = value * scale;
            self.time[len - tap] = value * scale;
        }
        self.forward();
        for (gain, bin) in out.iter_mut().zip(&self.spectrum) {
            *gain = bin.re;
        }
    }
}
