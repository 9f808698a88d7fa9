//! Transforms of complex samples.

use pulp::{Simd, WithSimd};

use super::chirp::Chirp;
use super::passes::Pass;
use super::{Complex64, Machine, Parts};

/// Fourier transforms of one length.
#[derive(Debug)]
pub struct ComplexTransform {
    len: usize,
    way: Way,
    machine: Machine,
}

#[derive(Debug)]
enum Way {
    /// Passes for prime factors up to 7.
    Passes(Vec<Pass>),
    /// All other lengths use a longer transform.
    Chirp(Box<Chirp>),
}

impl ComplexTransform {
    /// Transforms of `len` samples. Lengths whose prime factors are 2, 3, 5 and 7 are fast; others take about six times
    /// as long.
    ///
    /// # Panics
    /// If `len` is 0.
    pub fn new(len: usize) -> Self {
        assert!(len > 0, "a transform of nothing");
        let (mut passes, mut left) = (Vec::new(), len);
        // Fours first: everything after that then works in whole vectors.
        for radix in [4, 2, 3, 5, 7] {
            while left.is_multiple_of(radix) {
                passes.push(Pass::new(radix, left, len / left));
                left /= radix;
            }
        }
        let way = if left == 1 { Way::Passes(passes) } else { Way::Chirp(Box::new(Chirp::new(len))) };
        Self { len, way, machine: Machine::best() }
    }

    /// Number of samples.
    #[allow(clippy::len_without_is_empty, reason = "no transform is empty")]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Length of working memory that [`run`](Self::run) needs.
    pub(super) fn room(&self) -> usize {
        4 * self.len
            + match &self.way {
                Way::Passes(_) => 0,
                Way::Chirp(chirp) => chirp.room(),
            }
    }

    /// The two halves of `room`: the contents of the first are transformed.
    pub(super) fn halves<'a>(&self, room: &'a mut [f64]) -> [Parts<'a>; 2] {
        let (first, second) = room[..4 * self.len].split_at_mut(2 * self.len);
        [first, second].map(|half| {
            let (re, im) = half.split_at_mut(self.len);
            Parts { re, im }
        })
    }

    /// Transforms the first half of `room`, and returns the half that contains the result.
    pub(super) fn run<'a>(&self, room: &'a mut [f64]) -> Parts<'a> {
        let (own, rest) = room.split_at_mut(4 * self.len);
        let [mut input, output] = self.halves(own);
        match &self.way {
            Way::Passes(passes) => (input, _) = self.machine.run(AllPasses { passes, input, output }),
            Way::Chirp(chirp) => chirp.run(&mut input, rest),
        }
        input
    }

    /// The spectrum of `samples`, in place, unscaled.
    pub fn forward(&self, samples: &mut [Complex64]) {
        self.in_place(samples, false);
    }

    /// The signal of this spectrum, in place, unscaled: after [`forward`](Self::forward) it is `len` times the signal.
    pub fn inverse(&self, samples: &mut [Complex64]) {
        self.in_place(samples, true);
    }

    /// With real and imaginary parts exchanged, before and after, a transform is its inverse.
    fn in_place(&self, samples: &mut [Complex64], is_inverse: bool) {
        let mut room = vec![0.0; self.room()];
        let [input, _] = self.halves(&mut room);
        for ((sample, re), im) in samples.iter().zip(input.re).zip(input.im) {
            (*re, *im) = if is_inverse { (sample.im, sample.re) } else { (sample.re, sample.im) };
        }
        let result = self.run(&mut room);
        for ((sample, re), im) in samples.iter_mut().zip(&*result.re).zip(&*result.im) {
            *sample = if is_inverse { Complex64::new(*im, *re) } else { Complex64::new(*re, *im) };
        }
    }
}

/// All passes of a transform, from one half of the working memory to the other and back; the half written last comes
/// first.
struct AllPasses<'a, 'b> {
    passes: &'a [Pass],
    input: Parts<'b>,
    output: Parts<'b>,
}

impl<'b> WithSimd for AllPasses<'_, 'b> {
    type Output = (Parts<'b>, Parts<'b>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let (mut input, mut output) = (self.input, self.output);
        for pass in self.passes {
            pass.run(simd, &input, &mut output);
            std::mem::swap(&mut input, &mut output);
        }
        (input, output)
    }
}
