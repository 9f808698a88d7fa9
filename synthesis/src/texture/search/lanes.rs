//! Arithmetic on sixteen numbers at once, chosen at run time: AVX-512, AVX2, or whatever the compiler makes of plain
//! arrays (NEON on ARM, which always has it).
//!
//! All of them round in the same way, so that a search within a budget takes the same course on every machine. Bounds
//! allow for the rounding.

use super::codes::{CHUNK, CodeFrame, QUAD, Quad, ROUNDER, TakenIn, first_axes};
use super::sizes::{AXES_MAX, LANES};

/// Number of axes after which bounds are checked against the limit.
pub const STAGE: usize = 8;

/// Sixteen numbers in the machine's own vectors.
pub trait Lanes: Copy {
    /// Sixteen single-precision numbers.
    type Singles: Copy;
    /// Sixteen integers.
    type Integers: Copy;
    /// Eight double-precision numbers.
    type Doubles: Copy;

    /// The same number sixteen times.
    fn splat(self, x: f32) -> Self::Singles;
    /// Sixteen numbers from memory.
    fn load(self, numbers: &[f32; LANES]) -> Self::Singles;
    /// a - b
    fn sub(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// a b + c, rounded twice: not every processor fuses them.
    fn mul_add(self, a: Self::Singles, b: Self::Singles, c: Self::Singles) -> Self::Singles;
    /// The larger of a and b.
    fn max(self, a: Self::Singles, b: Self::Singles) -> Self::Singles;
    /// A bit for every number that is at most `limit`.
    fn within(self, a: Self::Singles, limit: f32) -> u32;
    /// The vector as an array.
    fn array(self, a: Self::Singles) -> [f32; LANES];
    /// Writes the distance of `point` from the middle, in half-steps, along each of the frame's axes; coordinates
    /// outside count as at the edge. Everything is rounded in the same way on every machine.
    fn take_in(
        self,
        frame: CodeFrame<'_>,
        per_half_step: f32,
        point: &[f32; AXES_MAX],
        steps: &mut [i8; AXES_MAX],
    ) -> TakenIn;
    /// Sixteen integers from memory.
    fn load_integers(self, integers: &[i32; LANES]) -> Self::Integers;
    /// a + b
    fn add_integers(self, a: Self::Integers, b: Self::Integers) -> Self::Integers;
    /// Squares of sixteen windows less four times the products of their codes and the query's steps.
    fn closeness(self, codes: &[Quad], query: &[[i8; QUAD]], squares: Self::Integers) -> Self::Integers;
    /// A bit for every integer that is at most `limit`.
    fn at_most(self, a: Self::Integers, limit: i32) -> u32;
    /// The vector as an array.
    fn integers(self, a: Self::Integers) -> [i32; LANES];
    /// Eight zeros.
    fn zeros(self) -> Self::Doubles;
    /// sum + (a - b)^2
    fn add_square(self, a: &[f64; 8], b: &[f64; 8], sum: Self::Doubles) -> Self::Doubles;
    /// sum + (a weight - b)^2, with a weight rounded like any product.
    fn add_weighted_square(self, a: &[f64; 8], weight: &[f64; 8], b: &[f64; 8], sum: Self::Doubles) -> Self::Doubles;
    /// The sum of the eight.
    fn sum(self, a: Self::Doubles) -> f64;
    /// Prefetches the first values, which will be read soon.
    fn prefetch<T>(self, values: &[T]);
}

/// The sum of eight numbers, in the order in which vectors of any width add their halves.
#[inline(always)]
fn sum_of([a, b, c, d, e, f, g, h]: [f64; 8]) -> f64 {
    ((a + e) + (c + g)) + ((b + f) + (d + h))
}

/// Plain arrays.
#[derive(Debug, Clone, Copy)]
pub struct Portable;

impl Lanes for Portable {
    type Singles = [f32; LANES];
    type Integers = [i32; LANES];
    type Doubles = [f64; 8];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::Singles {
        [x; LANES]
    }
    #[inline(always)]
    fn mul_add(self, a: Self::Singles, b: Self::Singles, c: Self::Singles) -> Self::Singles {
        std::array::from_fn(|i| a[i] * b[i] + c[i])
    }
    #[inline(always)]
    fn load(self, numbers: &[f32; LANES]) -> Self::Singles {
        *numbers
    }
    #[inline(always)]
    fn sub(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        std::array::from_fn(|i| a[i] - b[i])
    }
    #[inline(always)]
    fn max(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
        std::array::from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }
    #[inline(always)]
    fn within(self, a: Self::Singles, limit: f32) -> u32 {
        a.iter().enumerate().fold(0, |bits, (lane, x)| bits | u32::from(*x <= limit) << lane)
    }
    #[inline(always)]
    fn array(self, a: Self::Singles) -> [f32; LANES] {
        a
    }
    #[inline(always)]
    fn take_in(
        self,
        frame: CodeFrame<'_>,
        per_half_step: f32,
        point: &[f32; AXES_MAX],
        steps: &mut [i8; AXES_MAX],
    ) -> TakenIn {
        let mut taken = TakenIn::default();
        let chunks = frame.middles.as_chunks::<CHUNK>().0.iter().zip(frame.halves.as_chunks::<CHUNK>().0);
        let queries = point.as_chunks::<CHUNK>().0.iter().zip(steps.as_chunks_mut::<CHUNK>().0);
        for (number, ((middles, halves), (point, steps))) in chunks.zip(queries).enumerate() {
            if number * CHUNK == first_axes(frame.middles.len()) {
                (taken.sums[0], taken.squares[0]) = (taken.sums[1], taken.squares[1]);
            }
            for axis in 0..CHUNK {
                let from_middle = point[axis] - middles[axis];
                let inside = from_middle.max(-halves[axis]).min(halves[axis]);
                let beyond = from_middle - inside;
                taken.outside[axis] += beyond * beyond;
                let rounded = inside * per_half_step + ROUNDER;
                let lost = inside - (rounded - ROUNDER) * frame.scale.half_step;
                taken.error[axis] += lost * lost;
                // The low byte of such a number is the integer in two's complement.
                let step = rounded.to_bits() as u8 as i8;
                steps[axis] = step;
                taken.sums[1][axis] += i32::from(step);
                taken.squares[1][axis] += i32::from(step) * i32::from(step);
            }
        }
        taken
    }
    #[inline(always)]
    fn closeness(self, codes: &[Quad], query: &[[i8; QUAD]], squares: Self::Integers) -> Self::Integers {
        let mut sums = [0i32; LANES];
        for (codes, query) in codes.iter().zip(query) {
            for (sum, codes) in sums.iter_mut().zip(codes.as_chunks::<QUAD>().0) {
                *sum += (0..QUAD).map(|axis| i32::from(codes[axis]) * i32::from(query[axis])).sum::<i32>();
            }
        }
        std::array::from_fn(|lane| squares[lane] - 4 * sums[lane])
    }
    #[inline(always)]
    fn load_integers(self, integers: &[i32; LANES]) -> Self::Integers {
        *integers
    }
    #[inline(always)]
    fn add_integers(self, a: Self::Integers, b: Self::Integers) -> Self::Integers {
        std::array::from_fn(|i| a[i] + b[i])
    }
    #[inline(always)]
    fn at_most(self, a: Self::Integers, limit: i32) -> u32 {
        a.iter().enumerate().fold(0, |bits, (lane, x)| bits | u32::from(*x <= limit) << lane)
    }
    #[inline(always)]
    fn integers(self, a: Self::Integers) -> [i32; LANES] {
        a
    }
    #[inline(always)]
    fn zeros(self) -> Self::Doubles {
        [0.0; 8]
    }
    #[inline(always)]
    fn add_square(self, a: &[f64; 8], b: &[f64; 8], sum: Self::Doubles) -> Self::Doubles {
        std::array::from_fn(|i| sum[i] + (a[i] - b[i]) * (a[i] - b[i]))
    }
    #[inline(always)]
    fn add_weighted_square(self, a: &[f64; 8], weight: &[f64; 8], b: &[f64; 8], sum: Self::Doubles) -> Self::Doubles {
        self.add_square(&std::array::from_fn(|i| a[i] * weight[i]), b, sum)
    }
    #[inline(always)]
    fn sum(self, a: Self::Doubles) -> f64 {
        sum_of(a)
    }
    #[inline(always)]
    fn prefetch<T>(self, _: &[T]) {}
}

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::{
        __m256, __m256d, __m256i, __m512, __m512d, __m512i, _CMP_LE_OQ, _MM_HINT_T0, _mm_prefetch,
    };

    use bytemuck::cast;
    use pulp::x86::{V3, V4};

    use crate::texture::search::codes::{CHUNK, CodeFrame, QUAD, Quad, ROUNDER, TakenIn, first_axes};
    use crate::texture::search::lanes::{Lanes, sum_of};
    use crate::texture::search::sizes::{AXES_MAX, LANES};

    /// Fetches 256 bytes.
    #[inline(always)]
    fn prefetch<T>(values: &[T]) {
        for line in 0..4 {
            let address = values.as_ptr().cast::<i8>().wrapping_add(64 * line);
            // SAFETY: every x86-64 has SSE; a prefetch reads nothing and never faults, whatever the address.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(address) };
        }
    }

    /// Eight axes at once, in the same order and with the same rounding as one by one.
    #[inline(always)]
    fn take_in(
        V3 { avx, avx2, .. }: V3,
        frame: CodeFrame<'_>,
        per_half_step: f32,
        point: &[f32; AXES_MAX],
        steps: &mut [i8; AXES_MAX],
    ) -> TakenIn {
        let zero = avx._mm256_setzero_ps();
        let (half_step, per_half_step) = (avx._mm256_set1_ps(frame.scale.half_step), avx._mm256_set1_ps(per_half_step));
        let (rounder, rounder_bits) = (avx._mm256_set1_ps(ROUNDER), avx._mm256_set1_epi32(ROUNDER.to_bits() as i32));
        let (mut outside, mut error) = (zero, zero);
        let (mut sums, mut squares) = (avx._mm256_setzero_si256(), avx._mm256_setzero_si256());
        let (mut first_sums, mut first_squares) = (sums, squares);
        let chunks = frame.middles.as_chunks::<CHUNK>().0.iter().zip(frame.halves.as_chunks::<CHUNK>().0);
        let queries = point.as_chunks::<CHUNK>().0.iter().zip(steps.as_chunks_mut::<CHUNK>().0);
        for (number, ((middles, halves), (point, steps))) in chunks.zip(queries).enumerate() {
            if number * CHUNK == first_axes(frame.middles.len()) {
                (first_sums, first_squares) = (sums, squares);
            }
            let halves: __m256 = cast(*halves);
            let from_middle = avx._mm256_sub_ps(cast(*point), cast(*middles));
            // If one argument is NaN, the result is the second one.
            let inside = avx._mm256_min_ps(avx._mm256_max_ps(from_middle, avx._mm256_sub_ps(zero, halves)), halves);
            let beyond = avx._mm256_sub_ps(from_middle, inside);
            outside = avx._mm256_add_ps(outside, avx._mm256_mul_ps(beyond, beyond));
            let rounded = avx._mm256_add_ps(avx._mm256_mul_ps(inside, per_half_step), rounder);
            let coded = avx._mm256_mul_ps(avx._mm256_sub_ps(rounded, rounder), half_step);
            let lost = avx._mm256_sub_ps(inside, coded);
            error = avx._mm256_add_ps(error, avx._mm256_mul_ps(lost, lost));
            let step = avx2._mm256_sub_epi32(avx._mm256_castps_si256(rounded), rounder_bits);
            sums = avx2._mm256_add_epi32(sums, step);
            squares = avx2._mm256_add_epi32(squares, avx2._mm256_mullo_epi32(step, step));
            // Four bytes in each half.
            let words = avx2._mm256_packs_epi32(step, step);
            let bytes: [[i8; QUAD]; 8] = cast(avx2._mm256_packs_epi16(words, words));
            *steps = cast([bytes[0], bytes[QUAD]]);
        }
        TakenIn {
            outside: cast(outside),
            error: cast(error),
            sums: cast([first_sums, sums]),
            squares: cast([first_squares, squares]),
        }
    }

    impl Lanes for V4 {
        type Singles = __m512;
        type Integers = __m512i;
        type Doubles = __m512d;

        #[inline(always)]
        fn splat(self, x: f32) -> __m512 {
            self.avx512f._mm512_set1_ps(x)
        }
        #[inline(always)]
        fn mul_add(self, a: __m512, b: __m512, c: __m512) -> __m512 {
            self.avx512f._mm512_add_ps(self.avx512f._mm512_mul_ps(a, b), c)
        }
        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> __m512 {
            cast(*numbers)
        }
        #[inline(always)]
        fn sub(self, a: __m512, b: __m512) -> __m512 {
            self.avx512f._mm512_sub_ps(a, b)
        }
        #[inline(always)]
        fn max(self, a: __m512, b: __m512) -> __m512 {
            self.avx512f._mm512_max_ps(a, b)
        }
        #[inline(always)]
        fn within(self, a: __m512, limit: f32) -> u32 {
            u32::from(self.avx512f._mm512_cmple_ps_mask(a, self.splat(limit)))
        }
        #[inline(always)]
        fn array(self, a: __m512) -> [f32; LANES] {
            cast(a)
        }
        #[inline(always)]
        fn take_in(
            self,
            frame: CodeFrame<'_>,
            per_half_step: f32,
            point: &[f32; AXES_MAX],
            steps: &mut [i8; AXES_MAX],
        ) -> TakenIn {
            take_in(*self, frame, per_half_step, point, steps)
        }
        #[inline(always)]
        fn closeness(self, codes: &[Quad], query: &[[i8; QUAD]], squares: __m512i) -> __m512i {
            let ones = self.avx512f._mm512_set1_epi32(0x0001_0001);
            let mut sum = self.avx512f._mm512_setzero_si512();
            for (codes, query) in codes.iter().zip(query) {
                let query = self.avx512f._mm512_set1_epi32(cast(*query));
                // Two products of at most 127 squared fit into sixteen bits.
                let pairs = self.avx512bw._mm512_maddubs_epi16(cast(*codes), query);
                sum = self.avx512f._mm512_add_epi32(sum, self.avx512bw._mm512_madd_epi16(pairs, ones));
            }
            self.avx512f._mm512_sub_epi32(squares, self.avx512f._mm512_slli_epi32::<2>(sum))
        }
        #[inline(always)]
        fn load_integers(self, integers: &[i32; LANES]) -> __m512i {
            cast(*integers)
        }
        #[inline(always)]
        fn add_integers(self, a: __m512i, b: __m512i) -> __m512i {
            self.avx512f._mm512_add_epi32(a, b)
        }
        #[inline(always)]
        fn at_most(self, a: __m512i, limit: i32) -> u32 {
            u32::from(self.avx512f._mm512_cmple_epi32_mask(a, self.avx512f._mm512_set1_epi32(limit)))
        }
        #[inline(always)]
        fn integers(self, a: __m512i) -> [i32; LANES] {
            cast(a)
        }
        #[inline(always)]
        fn zeros(self) -> __m512d {
            self.avx512f._mm512_setzero_pd()
        }
        #[inline(always)]
        fn add_square(self, a: &[f64; 8], b: &[f64; 8], sum: __m512d) -> __m512d {
            let difference = self.avx512f._mm512_sub_pd(cast(*a), cast(*b));
            self.avx512f._mm512_add_pd(sum, self.avx512f._mm512_mul_pd(difference, difference))
        }
        #[inline(always)]
        fn add_weighted_square(self, a: &[f64; 8], weight: &[f64; 8], b: &[f64; 8], sum: __m512d) -> __m512d {
            let weighted = self.avx512f._mm512_mul_pd(cast(*a), cast(*weight));
            self.add_square(&cast(weighted), b, sum)
        }
        #[inline(always)]
        fn sum(self, a: __m512d) -> f64 {
            sum_of(cast(a))
        }
        #[inline(always)]
        fn prefetch<T>(self, values: &[T]) {
            prefetch(values);
        }
    }

    impl Lanes for V3 {
        type Singles = [__m256; 2];
        type Integers = [__m256i; 2];
        type Doubles = [__m256d; 2];

        #[inline(always)]
        fn splat(self, x: f32) -> Self::Singles {
            [self.avx._mm256_set1_ps(x); 2]
        }
        #[inline(always)]
        fn mul_add(self, a: Self::Singles, b: Self::Singles, c: Self::Singles) -> Self::Singles {
            let one = |at: usize| self.avx._mm256_add_ps(self.avx._mm256_mul_ps(a[at], b[at]), c[at]);
            [one(0), one(1)]
        }
        #[inline(always)]
        fn load(self, numbers: &[f32; LANES]) -> Self::Singles {
            cast(*numbers)
        }
        #[inline(always)]
        fn sub(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
            [self.avx._mm256_sub_ps(a[0], b[0]), self.avx._mm256_sub_ps(a[1], b[1])]
        }
        #[inline(always)]
        fn max(self, a: Self::Singles, b: Self::Singles) -> Self::Singles {
            [self.avx._mm256_max_ps(a[0], b[0]), self.avx._mm256_max_ps(a[1], b[1])]
        }
        #[inline(always)]
        fn within(self, a: Self::Singles, limit: f32) -> u32 {
            let limit = self.avx._mm256_set1_ps(limit);
            let bits = |x| self.avx._mm256_movemask_ps(self.avx._mm256_cmp_ps::<_CMP_LE_OQ>(x, limit)) as u32;
            bits(a[0]) | bits(a[1]) << 8
        }
        #[inline(always)]
        fn array(self, a: Self::Singles) -> [f32; LANES] {
            cast(a)
        }
        #[inline(always)]
        fn take_in(
            self,
            frame: CodeFrame<'_>,
            per_half_step: f32,
            point: &[f32; AXES_MAX],
            steps: &mut [i8; AXES_MAX],
        ) -> TakenIn {
            take_in(self, frame, per_half_step, point, steps)
        }
        #[inline(always)]
        fn closeness(self, codes: &[Quad], query: &[[i8; QUAD]], squares: Self::Integers) -> Self::Integers {
            let ones = self.avx._mm256_set1_epi16(1);
            let mut sums = [self.avx._mm256_setzero_si256(); 2];
            for (codes, query) in codes.iter().zip(query) {
                let codes: [__m256i; 2] = cast(*codes);
                let query = self.avx._mm256_set1_epi32(cast(*query));
                for (sum, codes) in sums.iter_mut().zip(codes) {
                    // Two products of at most 127 squared fit into sixteen bits.
                    let pairs = self.avx2._mm256_maddubs_epi16(codes, query);
                    *sum = self.avx2._mm256_add_epi32(*sum, self.avx2._mm256_madd_epi16(pairs, ones));
                }
            }
            let less = |square, sum| self.avx2._mm256_sub_epi32(square, self.avx2._mm256_slli_epi32::<2>(sum));
            [less(squares[0], sums[0]), less(squares[1], sums[1])]
        }
        #[inline(always)]
        fn load_integers(self, integers: &[i32; LANES]) -> Self::Integers {
            cast(*integers)
        }
        #[inline(always)]
        fn add_integers(self, a: Self::Integers, b: Self::Integers) -> Self::Integers {
            [self.avx2._mm256_add_epi32(a[0], b[0]), self.avx2._mm256_add_epi32(a[1], b[1])]
        }
        #[inline(always)]
        fn at_most(self, a: Self::Integers, limit: i32) -> u32 {
            let limit = self.avx._mm256_set1_epi32(limit);
            let above = |x| {
                let beyond = self.avx2._mm256_cmpgt_epi32(x, limit);
                self.avx._mm256_movemask_ps(self.avx._mm256_castsi256_ps(beyond)) as u32
            };
            !(above(a[0]) | above(a[1]) << 8) & 0xFFFF
        }
        #[inline(always)]
        fn integers(self, a: Self::Integers) -> [i32; LANES] {
            cast(a)
        }
        #[inline(always)]
        fn zeros(self) -> Self::Doubles {
            [self.avx._mm256_setzero_pd(); 2]
        }
        #[inline(always)]
        fn add_square(self, a: &[f64; 8], b: &[f64; 8], sum: Self::Doubles) -> Self::Doubles {
            let (a, b): ([__m256d; 2], [__m256d; 2]) = (cast(*a), cast(*b));
            let add = |a, b, sum| {
                let difference = self.avx._mm256_sub_pd(a, b);
                self.avx._mm256_add_pd(sum, self.avx._mm256_mul_pd(difference, difference))
            };
            [add(a[0], b[0], sum[0]), add(a[1], b[1], sum[1])]
        }
        #[inline(always)]
        fn add_weighted_square(
            self,
            a: &[f64; 8],
            weight: &[f64; 8],
            b: &[f64; 8],
            sum: Self::Doubles,
        ) -> Self::Doubles {
            let (a, weight): ([__m256d; 2], [__m256d; 2]) = (cast(*a), cast(*weight));
            let weighted = [self.avx._mm256_mul_pd(a[0], weight[0]), self.avx._mm256_mul_pd(a[1], weight[1])];
            self.add_square(&cast(weighted), b, sum)
        }
        #[inline(always)]
        fn sum(self, a: Self::Doubles) -> f64 {
            sum_of(cast(a))
        }
        #[inline(always)]
        fn prefetch<T>(self, values: &[T]) {
            prefetch(values);
        }
    }
}

/// The kinds of arithmetic that searches are compiled for.
#[derive(Debug, Clone, Copy)]
pub enum Machine {
    /// AVX-512.
    #[cfg(target_arch = "x86_64")]
    V4(pulp::x86::V4),
    /// AVX2 and FMA.
    #[cfg(target_arch = "x86_64")]
    V3(pulp::x86::V3),
    /// Any machine.
    Portable,
}

impl Machine {
    /// All that this machine has, fastest first.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(pulp::x86::V4::try_new().map(Self::V4));
            all.extend(pulp::x86::V3::try_new().map(Self::V3));
        }
        all.push(Self::Portable);
        all
    }

    /// The fastest.
    pub fn best() -> Self {
        Self::all()[0]
    }

    /// Does `work` with this arithmetic.
    #[inline(always)]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::V4(lanes) => lanes.vectorize(
                #[inline(always)]
                || work.with(lanes),
            ),
            #[cfg(target_arch = "x86_64")]
            Self::V3(lanes) => lanes.vectorize(
                #[inline(always)]
                || work.with(lanes),
            ),
            Self::Portable => work.with(Portable),
        }
    }
}

/// Work that is compiled for every kind of arithmetic; `with` must be inlined.
pub trait Work {
    /// Result of the work.
    type Output;
    /// Does it.
    fn with<L: Lanes>(self, lanes: L) -> Self::Output;
}

#[cfg(test)]
mod tests {
    use super::super::codes::Scale;
    use super::*;
    use crate::dsp::White;

    /// A query taken into a frame, and the weighted squares of eight numbers.
    struct Taken<'a> {
        frame: CodeFrame<'a>,
        point: &'a [f32; AXES_MAX],
        numbers: &'a [[f64; 8]; 3],
    }

    impl Work for Taken<'_> {
        type Output = ([i8; AXES_MAX], TakenIn, f64);

        fn with<L: Lanes>(self, lanes: L) -> Self::Output {
            let mut steps = [0; AXES_MAX];
            let taken = lanes.take_in(self.frame, 1.0 / self.frame.scale.half_step, self.point, &mut steps);
            let [a, weight, b] = self.numbers;
            (steps, taken, lanes.sum(lanes.add_weighted_square(a, weight, b, lanes.zeros())))
        }
    }

    #[test]
    fn every_machine_converts_queries_alike() {
        let white = White::new(5, 6);
        for round in 0..200 {
            let number = |at: i64| white.sample_at(100 * round + at);
            let axes = [8, 16, 24, 32, 40, 48][round as usize % 6];
            let middles: Vec<f32> = (0..axes).map(|axis| number(axis) as f32).collect();
            let halves: Vec<f32> = (0..axes).map(|axis| (0.3 * number(axis + 50)).abs() as f32).collect();
            let half_step = super::super::codes::half_step_for(halves.iter().copied());
            let frame = CodeFrame { middles: &middles, halves: &halves, scale: Scale { half_step, slack: 0.0 } };
            let point = std::array::from_fn(|axis| number(axis as i64 + 17) as f32);
            let numbers = [0, 8, 16].map(|from| std::array::from_fn(|i| number(from + i as i64)));
            let found: Vec<_> = Machine::all()
                .iter()
                .map(|machine| machine.run(Taken { frame, point: &point, numbers: &numbers }))
                .collect();
            let (steps, taken, _) = found[0];
            assert!(found.iter().all(|other| *other == found[0]), "round {round}");
            let all: i32 = steps[..axes as usize].iter().map(|step| i32::from(*step)).sum();
            assert_eq!(taken.sums[1].iter().sum::<i32>(), all);
            let first: i32 = steps[..first_axes(axes as usize)].iter().map(|step| i32::from(*step)).sum();
            if axes > 8 {
                assert_eq!(taken.sums[0].iter().sum::<i32>(), first);
            }
            assert!(taken.outside.iter().any(|square| *square > 0.0), "some of it lies outside");
        }
    }
}
