//! Transforms of real samples: complex transforms of half the length, made of the even and odd samples, whose results
//! are then separated.

use std::f64::consts::TAU;

use pulp::{Simd, WithSimd};

use super::complex::ComplexTransform;
use super::{Complex64, Machine, Parts};

/// Number of bins handled at once: the width of vectors of 256 bits.
const WIDTH: usize = 4;

/// Fourier transforms of one length. Nothing allocates after `new` but
/// [`spectrum`](Self::spectrum).
#[derive(Debug)]
pub struct RealTransform {
    samples: usize,
    /// Transform of half as many samples, or of all if their number is odd.
    fourier: ComplexTransform,
    half_len: usize,
    /// Cosine and sine of every bin's turn up to a quarter of the length.
    cos: Vec<f64>,
    sin: Vec<f64>,
    machine: Machine,
}

impl RealTransform {
    /// Transforms of `len` samples. Even lengths whose prime factors are 2, 3, 5 and 7 are quick.
    ///
    /// # Panics
    /// Panics if `len` is 0.
    pub fn new(len: usize) -> Self {
        let half_len = len / 2;
        let fourier = ComplexTransform::new(if len.is_multiple_of(2) { half_len } else { len });
        let (sin, cos) = (0..=half_len / 2).map(|bin| crate::sin_cos(TAU * bin as f64 / len as f64)).unzip();
        Self { samples: len, fourier, half_len, cos, sin, machine: Machine::best() }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.samples
    }

    fn is_odd(&self) -> bool {
        self.samples % 2 == 1
    }

    /// Number of bins, from 0 Hz to half the sample rate.
    pub fn bins(&self) -> usize {
        self.half_len + 1
    }

    /// Length of working memory that transforms need.
    pub fn room(&self) -> usize {
        self.fourier.room()
    }

    /// The spectrum of `time`, unscaled.
    pub fn spectrum(&self, time: &[f64]) -> Vec<Complex64> {
        let mut spectrum = vec![Complex64::default(); self.bins()];
        self.forward(time, &mut spectrum, &mut vec![0.0; self.room()]);
        spectrum
    }

    /// Transforms `time` to the bins of `spectrum`, unscaled. `room` must be at least [`room`](Self::room) long; its
    /// contents do not matter.
    pub fn forward(&self, time: &[f64], spectrum: &mut [Complex64], room: &mut [f64]) {
        if self.is_odd() {
            return self.forward_whole(time, spectrum, room);
        }
        let [input, _] = self.fourier.halves(room);
        for ((pair, re), im) in time.as_chunks::<2>().0.iter().zip(input.re).zip(input.im) {
            (*re, *im) = (pair[0], pair[1]);
        }
        let result = self.fourier.run(room);
        let spectrum = &mut spectrum[..=self.half_len];
        let (first_re, first_im) = (result.re[0], result.im[0]);
        spectrum[0] = Complex64::new(first_re + first_im, 0.0);
        spectrum[self.half_len] = Complex64::new(first_re - first_im, 0.0);
        self.machine.run(AllPairs { transform: self, pairs: Apart { spectrum, half: &result } });
    }

    /// Transforms the bins of `spectrum` to `time`, unscaled: after [`forward`](Self::forward) it is `samples` times
    /// the signal. The imaginary parts of the first and the last bin count as 0.
    pub fn inverse(&self, spectrum: &[Complex64], time: &mut [f64], room: &mut [f64]) {
        if self.is_odd() {
            return self.inverse_whole(spectrum, time, room);
        }
        // With real and imaginary parts exchanged, before and after, a transform is its inverse.
        let [Parts { re: im, im: re }, _] = self.fourier.halves(room);
        let spectrum = &spectrum[..=self.half_len];
        let (first, last) = (spectrum[0].re, spectrum[self.half_len].re);
        (re[0], im[0]) = (first + last, first - last);
        let mut half = Parts { re, im };
        self.machine.run(AllPairs { transform: self, pairs: Together { spectrum, half: &mut half } });
        let result = self.fourier.run(room);
        for ((pair, re), im) in time.as_chunks_mut::<2>().0.iter_mut().zip(&*result.im).zip(&*result.re) {
            *pair = [*re, *im];
        }
    }

    /// [`forward`](Self::forward) as a complex transform.
    fn forward_whole(&self, time: &[f64], spectrum: &mut [Complex64], room: &mut [f64]) {
        let [input, _] = self.fourier.halves(room);
        input.re.copy_from_slice(&time[..self.samples]);
        input.im.fill(0.0);
        let result = self.fourier.run(room);
        for (bin, (re, im)) in spectrum[..=self.half_len].iter_mut().zip(result.re.iter().zip(&*result.im)) {
            *bin = Complex64::new(*re, *im);
        }
    }

    /// [`inverse`](Self::inverse) as a complex transform of bins and their mirror images, with real and imaginary parts
    /// exchanged.
    fn inverse_whole(&self, spectrum: &[Complex64], time: &mut [f64], room: &mut [f64]) {
        let [Parts { re: im, im: re }, _] = self.fourier.halves(room);
        (re[0], im[0]) = (spectrum[0].re, 0.0);
        for (bin, value) in spectrum[..=self.half_len].iter().enumerate().skip(1) {
            (re[bin], im[bin]) = (value.re, value.im);
            (re[self.samples - bin], im[self.samples - bin]) = (value.re, -value.im);
        }
        let result = self.fourier.run(room);
        time[..self.samples].copy_from_slice(result.im);
    }

    /// Calls `pairs` for every bin but the first and its mirror image.
    #[inline(always)]
    fn for_pairs(&self, mut pairs: impl Pairs) {
        let mut bin = 1;
        while bin + WIDTH <= self.half_len.div_ceil(2) {
            pairs.several::<WIDTH>(bin, self.half_len - bin, self.turn(bin));
            bin += WIDTH;
        }
        while bin <= self.half_len / 2 {
            pairs.several::<1>(bin, self.half_len - bin, self.turn(bin));
            bin += 1;
        }
    }

    #[inline(always)]
    fn turn<const N: usize>(&self, bin: usize) -> [[f64; N]; 2] {
        let mut turn = [[0.0; N]; 2];
        turn[0].copy_from_slice(&self.cos[bin..][..N]);
        turn[1].copy_from_slice(&self.sin[bin..][..N]);
        turn
    }
}

/// All bins with their mirror images, in vectors.
struct AllPairs<'a, P> {
    transform: &'a RealTransform,
    pairs: P,
}

impl<P: Pairs> WithSimd for AllPairs<'_, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.transform.for_pairs(self.pairs);
    }
}

/// An operation on bins and their mirror images.
trait Pairs {
    /// The operation on N bins from `bin` on, and N from `mirror` down.
    fn several<const N: usize>(&mut self, bin: usize, mirror: usize, turn: [[f64; N]; 2]);
}

/// Conversion from the transform of half the length to the spectrum.
struct Apart<'a> {
    spectrum: &'a mut [Complex64],
    half: &'a Parts<'a>,
}

impl Pairs for Apart<'_> {
    #[inline(always)]
    fn several<const N: usize>(&mut self, bin: usize, mirror: usize, [cos, sin]: [[f64; N]; 2]) {
        let (up, down) = (bin..bin + N, mirror + 1 - N..mirror + 1);
        let (re, im) = (&self.half.re[up.clone()], &self.half.im[up.clone()]);
        let (mirror_re, mirror_im) = (&self.half.re[down.clone()], &self.half.im[down.clone()]);
        let (mut to, mut to_mirror) = ([Complex64::default(); N], [Complex64::default(); N]);
        // Plain loops: closures would be compiled for narrower vectors than this.
        for lane in 0..N {
            let back = N - 1 - lane;
            let (even_re, even_im) = (0.5 * (re[lane] + mirror_re[back]), 0.5 * (im[lane] - mirror_im[back]));
            let (odd_re, odd_im) = (0.5 * (im[lane] + mirror_im[back]), 0.5 * (mirror_re[back] - re[lane]));
            let turned_re = cos[lane] * odd_re + sin[lane] * odd_im;
            let turned_im = cos[lane] * odd_im - sin[lane] * odd_re;
            to_mirror[back] = Complex64::new(even_re - turned_re, turned_im - even_im);
            to[lane] = Complex64::new(even_re + turned_re, even_im + turned_im);
        }
        self.spectrum[down].copy_from_slice(&to_mirror);
        self.spectrum[up].copy_from_slice(&to);
    }
}

/// Conversion from the spectrum to that of half the length.
struct Together<'a, 'b> {
    spectrum: &'a [Complex64],
    half: &'a mut Parts<'b>,
}

impl Pairs for Together<'_, '_> {
    #[inline(always)]
    fn several<const N: usize>(&mut self, bin: usize, mirror: usize, [cos, sin]: [[f64; N]; 2]) {
        let (up, down) = (bin..bin + N, mirror + 1 - N..mirror + 1);
        let (bins, mirrored) = (&self.spectrum[up.clone()], &self.spectrum[down.clone()]);
        let (mut re, mut im, mut mirror_re, mut mirror_im) = ([0.0; N], [0.0; N], [0.0; N], [0.0; N]);
        for lane in 0..N {
            let back = N - 1 - lane;
            let (sum_re, sum_im) = (bins[lane].re + mirrored[back].re, bins[lane].im - mirrored[back].im);
            let (less_re, less_im) = (bins[lane].re - mirrored[back].re, bins[lane].im + mirrored[back].im);
            let turned_re = cos[lane] * less_re - sin[lane] * less_im;
            let turned_im = cos[lane] * less_im + sin[lane] * less_re;
            mirror_re[back] = sum_re + turned_im;
            mirror_im[back] = turned_re - sum_im;
            re[lane] = sum_re - turned_im;
            im[lane] = sum_im + turned_re;
        }
        self.half.re[down.clone()].copy_from_slice(&mirror_re);
        self.half.im[down].copy_from_slice(&mirror_im);
        self.half.re[up.clone()].copy_from_slice(&re);
        self.half.im[up].copy_from_slice(&im);
    }
}
