//! One pass over all samples of a transform: Stockham's, which leaves them in order.
//!
//! A pass of radix r makes transforms of n samples into r times as many of n / r. With `stride` transforms side by side, sample
//! p of transform q lies at `q + stride p`. All that is read is contiguous, and so is all that is written but in the first pass.

use std::f64::consts::TAU;

use super::Parts;

/// Samples handled at once: what vectors of 256 bits hold.
const WIDTH: usize = 4;

/// Largest radix.
const RADIX_MAX: usize = 7;

/// Several complex numbers, real and imaginary parts.
type Numbers<const N: usize> = ([f64; N], [f64; N]);

/// A pass over a transform's samples.
#[derive(Debug)]
pub(super) struct Pass {
    radix: usize,
    stride: usize,
    /// For each output of a butterfly but the first, the factor on it for every p: real parts, then imaginary ones.
    twiddles: Vec<[Vec<f64>; 2]>,
    /// Cosine and sine of the turns of a circle in `radix` parts, for radices that have no butterfly of their own.
    turns: [(f64, f64); RADIX_MAX],
}

impl Pass {
    /// A pass of `radix` over `stride` transforms of `len` samples each.
    pub fn new(radix: usize, len: usize, stride: usize) -> Self {
        let factors = |output: usize| {
            // Reduced as integers, so that the angle keeps its digits.
            let turn = |p: usize| crate::sin_cos(TAU * ((output * p) % len) as f64 / len as f64);
            let (sin, cos): (Vec<f64>, Vec<f64>) = (0..len / radix).map(turn).unzip();
            [cos, sin.into_iter().map(|sin| -sin).collect()]
        };
        let turns = std::array::from_fn(|part| {
            let (sin, cos) = crate::sin_cos(TAU * (part % radix) as f64 / radix as f64);
            (cos, sin)
        });
        Self { radix, stride, twiddles: (1..radix).map(factors).collect(), turns }
    }

    /// From all samples of `input` to all of `output`.
    #[inline(always)]
    pub fn run(&self, input: &Parts<'_>, output: &mut Parts<'_>) {
        match self.radix {
            2 => self.butterflies::<2>(input, output),
            3 => self.butterflies::<3>(input, output),
            4 => self.butterflies::<4>(input, output),
            5 => self.butterflies::<5>(input, output),
            _ => self.butterflies::<7>(input, output),
        }
    }

    #[inline(always)]
    fn butterflies<const R: usize>(&self, input: &Parts<'_>, output: &mut Parts<'_>) {
        let count = input.re.len() / R;
        if self.stride == 1 {
            let wide = count - count % WIDTH;
            (0..wide).step_by(WIDTH).for_each(|p| self.side_by_side::<R, WIDTH>(input, output, p));
            (wide..count).for_each(|p| self.side_by_side::<R, 1>(input, output, p));
        } else if self.stride.is_multiple_of(WIDTH) {
            self.blocks::<R, WIDTH>(input, output);
        } else {
            self.blocks::<R, 1>(input, output);
        }
    }

    /// Butterflies of N neighbours of one transform; what comes out of one lies together.
    #[inline(always)]
    fn side_by_side<const R: usize, const N: usize>(&self, input: &Parts<'_>, output: &mut Parts<'_>, p: usize) {
        let count = input.re.len() / R;
        let samples: [Numbers<N>; R] = std::array::from_fn(|part| load(input, part * count + p));
        let mut results = butterfly(samples, &self.turns);
        for (result, [re, im]) in results[1..].iter_mut().zip(&self.twiddles) {
            *result = times(*result, (several(re, p), several(im, p)));
        }
        let (re, im) = (&mut output.re[R * p..][..R * N], &mut output.im[R * p..][..R * N]);
        for at in 0..N {
            for (part, result) in results.iter().enumerate() {
                re[R * at + part] = result.0[at];
                im[R * at + part] = result.1[at];
            }
        }
    }

    /// Butterflies of whole blocks of transforms side by side, N at once.
    #[inline(always)]
    fn blocks<const R: usize, const N: usize>(&self, input: &Parts<'_>, output: &mut Parts<'_>) {
        let (count, stride) = (input.re.len() / R, self.stride);
        for p in 0..count / stride {
            let factors: [(f64, f64); R] = std::array::from_fn(|part| match part.checked_sub(1) {
                Some(part) => (self.twiddles[part][0][p], self.twiddles[part][1][p]),
                None => (1.0, 0.0),
            });
            for q in (0..stride).step_by(N) {
                let samples: [Numbers<N>; R] = std::array::from_fn(|part| load(input, part * count + stride * p + q));
                let results = butterfly(samples, &self.turns);
                for (part, (result, factor)) in results.into_iter().zip(factors).enumerate() {
                    // Of the last pass all factors are 1, as is that of the first sample.
                    let result = if p == 0 { result } else { times(result, ([factor.0; N], [factor.1; N])) };
                    store(output, stride * (R * p + part) + q, result);
                }
            }
        }
    }
}

#[inline(always)]
fn several<const N: usize>(numbers: &[f64], at: usize) -> [f64; N] {
    let numbers = &numbers[at..][..N];
    std::array::from_fn(|lane| numbers[lane])
}

#[inline(always)]
fn load<const N: usize>(from: &Parts<'_>, at: usize) -> Numbers<N> {
    (several(from.re, at), several(from.im, at))
}

#[inline(always)]
fn store<const N: usize>(to: &mut Parts<'_>, at: usize, numbers: Numbers<N>) {
    to.re[at..][..N].copy_from_slice(&numbers.0);
    to.im[at..][..N].copy_from_slice(&numbers.1);
}

#[inline(always)]
fn each<const N: usize>(a: Numbers<N>, b: Numbers<N>, f: impl Fn(f64, f64) -> f64) -> Numbers<N> {
    (std::array::from_fn(|lane| f(a.0[lane], b.0[lane])), std::array::from_fn(|lane| f(a.1[lane], b.1[lane])))
}

#[inline(always)]
fn plus<const N: usize>(a: Numbers<N>, b: Numbers<N>) -> Numbers<N> {
    each(a, b, |a, b| a + b)
}

#[inline(always)]
fn minus<const N: usize>(a: Numbers<N>, b: Numbers<N>) -> Numbers<N> {
    each(a, b, |a, b| a - b)
}

#[inline(always)]
fn times<const N: usize>(a: Numbers<N>, b: Numbers<N>) -> Numbers<N> {
    (
        std::array::from_fn(|lane| a.0[lane] * b.0[lane] - a.1[lane] * b.1[lane]),
        std::array::from_fn(|lane| a.0[lane] * b.1[lane] + a.1[lane] * b.0[lane]),
    )
}

/// Times the imaginary unit.
#[inline(always)]
fn turned<const N: usize>(a: Numbers<N>) -> Numbers<N> {
    (a.1.map(|x| -x), a.0)
}

#[inline(always)]
fn scaled<const N: usize>(a: Numbers<N>, factor: f64) -> Numbers<N> {
    (a.0.map(|x| x * factor), a.1.map(|x| x * factor))
}

/// The transform of R samples.
#[inline(always)]
fn butterfly<const R: usize, const N: usize>(
    samples: [Numbers<N>; R],
    turns: &[(f64, f64); RADIX_MAX],
) -> [Numbers<N>; R] {
    let mut results = samples;
    match R {
        2 => {
            results[0] = plus(samples[0], samples[1]);
            results[1] = minus(samples[0], samples[1]);
        }
        3 => {
            let (sum, difference) = (plus(samples[1], samples[2]), minus(samples[1], samples[2]));
            let middle = minus(samples[0], scaled(sum, 0.5));
            let turned = turned(scaled(difference, SIN_60));
            results[0] = plus(samples[0], sum);
            results[1] = minus(middle, turned);
            results[2] = plus(middle, turned);
        }
        4 => {
            let (sum, difference) = (plus(samples[0], samples[2]), minus(samples[0], samples[2]));
            let (other_sum, turned) = (plus(samples[1], samples[3]), turned(minus(samples[1], samples[3])));
            results[0] = plus(sum, other_sum);
            results[1] = minus(difference, turned);
            results[2] = minus(sum, other_sum);
            results[3] = plus(difference, turned);
        }
        _ => {
            for (output, result) in results.iter_mut().enumerate() {
                *result = (1..R).fold(samples[0], |sum, part| {
                    let (cos, sin) = turns[output * part % R];
                    plus(sum, times(samples[part], ([cos; N], [-sin; N])))
                });
            }
        }
    }
    results
}

/// The sine of 60 degrees.
const SIN_60: f64 = 0.866_025_403_784_438_6;
