//! One pass over all samples of a transform: Stockham's, which leaves them in order.
//!
//! A pass of radix r turns transforms of n samples into r times as many of n / r. With `stride` transforms side by
//! side, sample p of transform q lies at `q + stride p`. All reads are contiguous, and so are all writes except in the
//! first pass.

use std::f64::consts::TAU;

use pulp::{Scalar, Simd, bytemuck};

use super::Parts;

/// Largest radix.
const RADIX_MAX: usize = 7;

/// A vector of complex numbers, real and imaginary parts.
type Numbers<S> = (<S as Simd>::f64s, <S as Simd>::f64s);

/// A pass over a transform's samples.
#[derive(Debug)]
pub(super) struct Pass {
    radix: usize,
    stride: usize,
    /// For each output of a butterfly except the first, its factor for every p: real parts, then imaginary ones.
    twiddles: Vec<[Vec<f64>; 2]>,
    /// Cosine and sine of the multiples of a turn divided by `radix`, for radices without a dedicated butterfly.
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
    pub fn run<S: Simd>(&self, simd: S, input: &Parts<'_>, output: &mut Parts<'_>) {
        match self.radix {
            2 => self.butterflies::<S, 2>(simd, input, output),
            3 => self.butterflies::<S, 3>(simd, input, output),
            4 => self.butterflies::<S, 4>(simd, input, output),
            5 => self.butterflies::<S, 5>(simd, input, output),
            _ => self.butterflies::<S, 7>(simd, input, output),
        }
    }

    #[inline(always)]
    fn butterflies<S: Simd, const R: usize>(&self, simd: S, input: &Parts<'_>, output: &mut Parts<'_>) {
        if self.stride == 1 {
            let count = input.re.len() / R;
            let wide = count - count % S::F64_LANES;
            self.side_by_side::<S, R>(simd, input, output, 0, wide);
            self.side_by_side::<Scalar, R>(Scalar, input, output, wide, count);
        } else if self.stride.is_multiple_of(S::F64_LANES) {
            self.blocks::<S, R>(simd, input, output);
        } else {
            self.blocks::<Scalar, R>(Scalar, input, output);
        }
    }

    /// Butterflies `from` to `to` of one transform, whose outputs are contiguous.
    #[inline(always)]
    fn side_by_side<S: Simd, const R: usize>(
        &self,
        simd: S,
        input: &Parts<'_>,
        output: &mut Parts<'_>,
        from: usize,
        to: usize,
    ) {
        let count = input.re.len() / R;
        let none: &[S::f64s] = &[];
        let (mut samples, mut factors) = ([[none; 2]; R], [[none; 2]; R]);
        for part in 0..R {
            let range = part * count + from..part * count + to;
            samples[part] = [S::as_simd_f64s(&input.re[range.clone()]).0, S::as_simd_f64s(&input.im[range]).0];
            if part > 0 {
                let [re, im] = &self.twiddles[part - 1];
                factors[part] = [S::as_simd_f64s(&re[from..to]).0, S::as_simd_f64s(&im[from..to]).0];
            }
        }
        let written = R * S::F64_LANES;
        let outputs = output.re[R * from..R * to].chunks_exact_mut(written);
        let outputs = outputs.zip(output.im[R * from..R * to].chunks_exact_mut(written));
        for (at, (to_re, to_im)) in outputs.enumerate() {
            let mut inputs = [(samples[0][0][at], samples[0][1][at]); R];
            for part in 1..R {
                inputs[part] = (samples[part][0][at], samples[part][1][at]);
            }
            let results = butterfly::<S, R>(simd, inputs, &self.turns);
            for part in 0..R {
                let mut result = results[part];
                if part > 0 {
                    result = times(simd, result, (factors[part][0][at], factors[part][1][at]));
                }
                let re: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&result.0));
                let im: &[f64] = bytemuck::cast_slice(std::slice::from_ref(&result.1));
                for lane in 0..S::F64_LANES {
                    to_re[R * lane + part] = re[lane];
                    to_im[R * lane + part] = im[lane];
                }
            }
        }
    }

    /// Butterflies of whole blocks of transforms side by side.
    #[inline(always)]
    fn blocks<S: Simd, const R: usize>(&self, simd: S, input: &Parts<'_>, output: &mut Parts<'_>) {
        let (count, stride) = (input.re.len() / R, self.stride);
        let vectors = stride / S::F64_LANES;
        let none: &[S::f64s] = &[];
        for p in 0..count / stride {
            let mut factors = [(simd.splat_f64s(1.0), simd.splat_f64s(0.0)); R];
            let mut samples = [(none, none); R];
            for part in 0..R {
                if part > 0 {
                    let [re, im] = &self.twiddles[part - 1];
                    factors[part] = (simd.splat_f64s(re[p]), simd.splat_f64s(im[p]));
                }
                let range = part * count + stride * p..part * count + stride * (p + 1);
                let re = &S::as_simd_f64s(&input.re[range.clone()]).0[..vectors];
                samples[part] = (re, &S::as_simd_f64s(&input.im[range]).0[..vectors]);
            }
            let range = stride * R * p..stride * R * (p + 1);
            let to_re = &mut S::as_mut_simd_f64s(&mut output.re[range.clone()]).0[..R * vectors];
            let to_im = &mut S::as_mut_simd_f64s(&mut output.im[range]).0[..R * vectors];
            for at in 0..vectors {
                let mut inputs = [(samples[0].0[at], samples[0].1[at]); R];
                for part in 1..R {
                    inputs[part] = (samples[part].0[at], samples[part].1[at]);
                }
                let results = butterfly::<S, R>(simd, inputs, &self.turns);
                for part in 0..R {
                    // In the last pass all factors are 1, as is that of the first sample.
                    let result = if p == 0 { results[part] } else { times(simd, results[part], factors[part]) };
                    to_re[part * vectors + at] = result.0;
                    to_im[part * vectors + at] = result.1;
                }
            }
        }
    }
}

#[inline(always)]
fn plus<S: Simd>(simd: S, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
    (simd.add_f64s(a.0, b.0), simd.add_f64s(a.1, b.1))
}

#[inline(always)]
fn minus<S: Simd>(simd: S, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
    (simd.sub_f64s(a.0, b.0), simd.sub_f64s(a.1, b.1))
}

/// Not fused: processors that can fuse would round differently.
#[inline(always)]
fn times<S: Simd>(simd: S, a: Numbers<S>, b: Numbers<S>) -> Numbers<S> {
    (
        simd.sub_f64s(simd.mul_f64s(a.0, b.0), simd.mul_f64s(a.1, b.1)),
        simd.add_f64s(simd.mul_f64s(a.0, b.1), simd.mul_f64s(a.1, b.0)),
    )
}

/// `a` and the imaginary unit times `b`: their sum, and their difference.
#[inline(always)]
fn with_turned<S: Simd>(simd: S, a: Numbers<S>, b: Numbers<S>) -> [Numbers<S>; 2] {
    [(simd.sub_f64s(a.0, b.1), simd.add_f64s(a.1, b.0)), (simd.add_f64s(a.0, b.1), simd.sub_f64s(a.1, b.0))]
}

#[inline(always)]
fn scaled<S: Simd>(simd: S, a: Numbers<S>, factor: f64) -> Numbers<S> {
    let factor = simd.splat_f64s(factor);
    (simd.mul_f64s(a.0, factor), simd.mul_f64s(a.1, factor))
}

/// The transform of R samples.
#[inline(always)]
fn butterfly<S: Simd, const R: usize>(
    simd: S,
    samples: [Numbers<S>; R],
    turns: &[(f64, f64); RADIX_MAX],
) -> [Numbers<S>; R] {
    let mut results = samples;
    match R {
        2 => {
            results[0] = plus(simd, samples[0], samples[1]);
            results[1] = minus(simd, samples[0], samples[1]);
        }
        3 => {
            let (sum, difference) = (plus(simd, samples[1], samples[2]), minus(simd, samples[1], samples[2]));
            let middle = minus(simd, samples[0], scaled(simd, sum, 0.5));
            results[0] = plus(simd, samples[0], sum);
            [results[2], results[1]] = with_turned(simd, middle, scaled(simd, difference, SIN_60));
        }
        4 => {
            let (sum, difference) = (plus(simd, samples[0], samples[2]), minus(simd, samples[0], samples[2]));
            let (other_sum, other) = (plus(simd, samples[1], samples[3]), minus(simd, samples[1], samples[3]));
            results[0] = plus(simd, sum, other_sum);
            results[2] = minus(simd, sum, other_sum);
            [results[3], results[1]] = with_turned(simd, difference, other);
        }
        _ => {
            for output in 0..R {
                let mut sum = samples[0];
                for part in 1..R {
                    let (cos, sin) = turns[output * part % R];
                    let turn = (simd.splat_f64s(cos), simd.splat_f64s(-sin));
                    sum = plus(simd, sum, times(simd, samples[part], turn));
                }
                results[output] = sum;
            }
        }
    }
    results
}

/// The sine of 60 degrees.
const SIN_60: f64 = 0.866_025_403_784_438_6;
