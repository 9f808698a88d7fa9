//! An equaliser towards a spectrum: minimum phase, so that it adds no latency.
//!
//! Partitioned convolution (Gardner, "Efficient Convolution without Input-Output Delay", 1995): the first taps
//! directly, all others by transforms of blocks of 64 samples, which are due only one block later. The work therefore
//! grows with the sample rate and not with its square, and is the same in every block. Blocks are aligned with the
//! samples counted since the reset, however the sound is divided.

use std::ops::Range;

use maths::fft::{self, Complex64};

use super::bands::centres_hz;
use crate::dsp::{Smoothed, Transform};

/// Most that a third octave is raised or lowered, in dB.
pub const LIMIT_DB: f64 = 20.0;
/// Stop-band attenuation of a low-pass in dB, below any recording's noise floor, and its slope in dB per octave.
const STOP_DB: f64 = 80.0;
const SLOPE_DB: f64 = 180.0;
/// Taps at 44.1 kHz.
const TAPS: f64 = 512.0;
/// Length of the transform for designing, in taps; long, so that the cepstrum does not wrap.
const DESIGN_FACTOR: usize = 16;
/// Samples of a block, and taps that are applied directly: the results of a transform are due one block later, so the
/// direct taps must cover one block.
const BLOCK: usize = 64;
/// Time constant in seconds with which the amount follows its control.
const SMOOTHING_S: f64 = 0.02;

/// Taps of the minimum-phase filter whose gains in dB at [`centres_hz`] are `gains_db`, and constant beyond the
/// outermost.
pub fn design(gains_db: &[f64], sample_rate_hz: f64) -> Vec<f64> {
    let centres: Vec<f64> = centres_hz(sample_rate_hz).iter().map(|hz| maths::ln(*hz)).collect();
    let gain_db = |hz: f64| interpolate(&centres, gains_db, maths::ln(hz.max(1.0))).clamp(-LIMIT_DB, LIMIT_DB);
    minimum_phase(gain_db, sample_rate_hz)
}

/// Taps of a low-pass that is flat up to a frequency in Hz, and falls by 80 dB within half an octave.
pub fn design_low_pass(corner_hz: f64, sample_rate_hz: f64) -> Vec<f64> {
    minimum_phase(|hz| -(SLOPE_DB * maths::log2(hz.max(1.0) / corner_hz)).clamp(0.0, STOP_DB), sample_rate_hz)
}

/// Taps of the minimum-phase filter with a gain in dB by frequency in Hz.
fn minimum_phase(gain_db: impl Fn(f64) -> f64, sample_rate_hz: f64) -> Vec<f64> {
    let taps = ((TAPS * sample_rate_hz / 44_100.0).ceil() as usize).next_multiple_of(STRIDE);
    let mut transform = Transform::new((taps * DESIGN_FACTOR).next_power_of_two());
    let len = transform.len();
    for (bin, value) in transform.spectrum.iter_mut().enumerate() {
        let gain_db = gain_db(bin as f64 * sample_rate_hz / len as f64);
        *value = Complex64::new(gain_db / 20.0 * std::f64::consts::LN_10 / len as f64, 0.0);
    }
    // The cepstrum, folded onto positive times, is that of the minimum-phase filter
    // (Oppenheim & Schafer, "Discrete-Time Signal Processing", §13.5).
    transform.inverse();
    let half = len / 2;
    transform.time[1..half].iter_mut().for_each(|x| *x *= 2.0);
    transform.time[half + 1..].fill(0.0);
    transform.forward();
    transform.spectrum.iter_mut().for_each(|x| *x = fft::exp(*x) / len as f64);
    transform.inverse();
    let fade = taps / 4;
    let ending = |tap: usize| match (tap + fade).checked_sub(taps) {
        Some(into) => maths::square(maths::cos(std::f64::consts::FRAC_PI_2 * into as f64 / fade as f64)),
        None => 1.0,
    };
    (0..taps).map(|tap| transform.time[tap] * ending(tap)).collect()
}

fn interpolate(places: &[f64], values: &[f64], at: f64) -> f64 {
    let above = places.partition_point(|place| *place <= at);
    match (above.checked_sub(1), values.get(above)) {
        (None, first) => first.copied().unwrap_or(0.0),
        (Some(below), None) => values.get(below.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0),
        (Some(below), Some(next)) => {
            let part = (at - places[below]) / (places[above] - places[below]);
            values[below] + part * (next - values[below])
        }
    }
}

/// The number of taps is a multiple of this.
const STRIDE: usize = 8;

/// Samples to which the first taps are applied at a time: few enough that their sums stay in registers.
const AT_ONCE: usize = 16;

/// Bins of a block's spectrum, rounded up for vectors.
const BINS: usize = (BLOCK + 1).next_multiple_of(STRIDE);

/// A spectrum with separate arrays for its parts.
#[derive(Debug, Clone, Copy)]
struct Spectrum {
    re: [f64; BINS],
    im: [f64; BINS],
}

impl Spectrum {
    const ZERO: Self = Self { re: [0.0; BINS], im: [0.0; BINS] };

    fn prepared(transform: &mut Transform) -> Self {
        transform.forward();
        let mut spectrum = Self::ZERO;
        for (bin, value) in transform.spectrum.iter().enumerate() {
            (spectrum.re[bin], spectrum.im[bin]) = (value.re, value.im);
        }
        spectrum
    }

    /// Adds a product.
    #[inline(always)]
    fn add(&mut self, a: &Self, b: &Self) {
        for bin in 0..BINS {
            self.re[bin] += a.re[bin] * b.re[bin] - a.im[bin] * b.im[bin];
            self.im[bin] += a.re[bin] * b.im[bin] + a.im[bin] * b.re[bin];
        }
    }
}

/// State of a channel.
#[derive(Debug, Clone)]
struct Channel {
    /// Whole blocks of the past, the present block, and as many samples as are filtered at a time.
    line: Vec<f64>,
    /// Spectra of two blocks at a time, the newest at `newest`, older ones after it, cyclically.
    spectra: Vec<Spectrum>,
    newest: usize,
    /// Output of all but the first taps over the past, for the present block.
    tail: [f64; BLOCK],
}

/// Filter for channels, with taps that may be exchanged, fully or in part.
#[derive(Debug)]
pub struct Equalizer {
    channels: Vec<Channel>,
    transform: Transform,
    length: usize,
    /// The taps in use, or none; exchanged at the start of a block.
    taps: Vec<f64>,
    /// Spectra of the taps beyond the first block's, a block each.
    parts: Vec<Spectrum>,
    /// Samples of the present block.
    filled: usize,
    amount: Smoothed,
    fresh: bool,
    /// True if the present block is filtered.
    is_on: bool,
    /// True if the channels' spectra are up to date with their past.
    is_followed: bool,
    /// Samples for which every channel has been silent.
    silent_samples: usize,
}

impl Equalizer {
    /// An equaliser for `channels`.
    pub fn new(sample_rate_hz: f64, channels: usize) -> Self {
        let length = design(&[0.0], sample_rate_hz).len();
        let parts = length.div_ceil(BLOCK) - 1;
        let channel = Channel {
            line: vec![0.0; (parts + 2) * BLOCK + AT_ONCE],
            spectra: vec![Spectrum::ZERO; parts],
            newest: 0,
            tail: [0.0; BLOCK],
        };
        Self {
            channels: vec![channel; channels],
            transform: Transform::new(2 * BLOCK),
            length,
            taps: Vec::with_capacity(length),
            parts: vec![Spectrum::ZERO; parts],
            filled: BLOCK,
            amount: Smoothed::new(SMOOTHING_S, sample_rate_hz),
            fresh: true,
            is_on: false,
            is_followed: false,
            silent_samples: length,
        }
    }

    /// Samples for which it continues to sound.
    pub fn tail_samples(&self) -> usize {
        self.length
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.channels.iter_mut().for_each(|channel| channel.line.fill(0.0));
        self.filled = BLOCK;
        self.fresh = true;
        self.is_on = false;
        self.is_followed = false;
        self.silent_samples = self.length;
    }

    /// Samples of silence after which nothing of the past remains.
    pub fn memory_samples(&self) -> usize {
        self.length.next_multiple_of(BLOCK) + 2 * BLOCK
    }

    /// Skips `samples` of silence, if nothing of the past remains.
    pub fn skip(&mut self, samples: usize) {
        let into = (self.filled % BLOCK + samples) % BLOCK;
        self.filled = if into == 0 { BLOCK } else { into };
        self.silent_samples = self.silent_samples.saturating_add(samples);
    }

    /// Filters the samples in `range` of every channel with `taps`, made by [`design`], by `amount` (0-1).
    pub fn process(&mut self, taps: &[f64], amount: f64, channels: &mut [&mut [f64]], range: Range<usize>) {
        if std::mem::take(&mut self.fresh) {
            self.amount.value = amount;
        }
        let mut start = range.start;
        while start < range.end {
            if self.filled == BLOCK {
                self.begin(taps, amount);
            }
            let end = range.end.min(start + BLOCK - self.filled);
            self.filter(amount, channels, start..end);
            start = end;
        }
    }

    /// Begins a block.
    fn begin(&mut self, taps: &[f64], amount: f64) {
        self.filled = 0;
        for channel in &mut self.channels {
            channel.line.copy_within(BLOCK.., 0);
        }
        let is_silent = self.silent_samples >= self.length;
        self.is_on = taps.len() == self.length && (amount != 0.0 || self.amount.value != 0.0);
        if !self.is_on || is_silent {
            // After silence nothing is left to sound; otherwise the past is processed once it is needed again.
            self.channels.iter_mut().for_each(|channel| channel.tail = [0.0; BLOCK]);
            self.is_followed = false;
        }
        if !self.is_on {
            return;
        }
        if self.taps != taps {
            self.set_taps(taps);
        }
        if !is_silent {
            let every = !std::mem::replace(&mut self.is_followed, true);
            for channel in &mut self.channels {
                channel.update_spectra(&mut self.transform, every);
                channel.set_tail(&mut self.transform, &self.parts);
            }
        }
    }

    fn set_taps(&mut self, taps: &[f64]) {
        self.taps.clear();
        self.taps.extend_from_slice(taps);
        for (part, taps) in self.parts.iter_mut().zip(taps[BLOCK..].chunks(BLOCK)) {
            self.transform.time.fill(0.0);
            for (value, tap) in self.transform.time.iter_mut().zip(taps) {
                *value = tap / (2 * BLOCK) as f64;
            }
            *part = Spectrum::prepared(&mut self.transform);
        }
    }

    /// Filters samples within one block.
    fn filter(&mut self, amount: f64, channels: &mut [&mut [f64]], range: Range<usize>) {
        let (at, count) = (self.filled, range.len());
        self.filled += count;
        let mut shares = [0.0; BLOCK];
        self.set_shares(amount, channels, range.clone(), &mut shares[..count]);
        let is_heard = shares[..count].iter().any(|share| *share != 0.0);
        for (channel, kept) in channels.iter_mut().zip(&mut self.channels) {
            let block = &mut channel[range.clone()];
            let now = kept.begin() + at;
            kept.line[now..now + count].copy_from_slice(block);
            if is_heard {
                let filtered = head(&self.taps[..BLOCK], &kept.line, now, count);
                for (i, sample) in block.iter_mut().enumerate() {
                    let filtered = filtered[i] + kept.tail[at + i];
                    *sample += shares[i] * (filtered - *sample);
                }
            }
        }
    }
}

impl Equalizer {
    /// Writes the amount for every sample in `range`; zero if all has been silent for long, so that silence is exact.
    fn set_shares(&mut self, amount: f64, channels: &[&mut [f64]], range: Range<usize>, shares: &mut [f64]) {
        let is_silent = |i: usize| channels.iter().all(|channel| channel[i] == 0.0);
        let stays = !self.is_on || self.amount.value == amount;
        if stays && self.silent_samples.saturating_add(shares.len()) < self.length {
            // Too little silence for an end, so only what there is of it at the end of the range counts.
            shares.fill(if self.is_on { amount } else { 0.0 });
            let trailing = range.rev().take_while(|i| is_silent(*i)).count();
            self.silent_samples = if trailing == shares.len() { self.silent_samples + trailing } else { trailing };
            return;
        }
        for (share, i) in shares.iter_mut().zip(range) {
            self.silent_samples = if is_silent(i) { self.silent_samples.saturating_add(1) } else { 0 };
            if self.is_on {
                let amount = self.amount.next(amount);
                *share = if self.silent_samples < self.length { amount } else { 0.0 };
            }
        }
    }
}

impl Channel {
    /// Start of the present block in the line.
    fn begin(&self) -> usize {
        self.line.len() - AT_ONCE - BLOCK
    }

    /// Adds the last block to the spectra, or `every` block of the past.
    fn update_spectra(&mut self, transform: &mut Transform, every: bool) {
        let (parts, end) = (self.spectra.len(), self.begin());
        self.newest = (self.newest + parts - 1) % parts;
        for age in 0..if every { parts } else { 1 } {
            let from = end - (age + 2) * BLOCK;
            transform.time.copy_from_slice(&self.line[from..from + 2 * BLOCK]);
            self.spectra[(self.newest + age) % parts] = Spectrum::prepared(transform);
        }
    }

    fn set_tail(&mut self, transform: &mut Transform, parts: &[Spectrum]) {
        let (older, newer) = self.spectra.split_at(self.newest);
        let mut sum = Spectrum::ZERO;
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || newer.iter().chain(older).zip(parts).for_each(|(past, part)| sum.add(past, part)),
        );
        for (bin, value) in transform.spectrum.iter_mut().enumerate() {
            *value = Complex64::new(sum.re[bin], sum.im[bin]);
        }
        transform.inverse();
        self.tail.copy_from_slice(&transform.time[BLOCK..]);
    }
}

/// Output of the first taps for `line` from `from` on.
fn head(taps: &[f64], line: &[f64], from: usize, count: usize) -> [f64; BLOCK] {
    let mut out = [0.0; BLOCK];
    pulp::Arch::new().dispatch(Head { taps, line, from, out: &mut out[..count.next_multiple_of(AT_ONCE)] });
    out
}

/// The same, compiled for every kind of machine.
struct Head<'a> {
    taps: &'a [f64],
    line: &'a [f64],
    from: usize,
    out: &'a mut [f64],
}

impl pulp::WithSimd for Head<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        for (piece, out) in self.out.as_chunks_mut::<AT_ONCE>().0.iter_mut().enumerate() {
            // Local sums, which stay in registers.
            let mut sums = [0.0; AT_ONCE];
            for (delay, tap) in self.taps.iter().enumerate() {
                // Beyond the requested samples this reads future input, whose results are discarded.
                let past = &self.line[self.from + piece * AT_ONCE - delay..][..AT_ONCE];
                for (sum, sample) in sums.iter_mut().zip(past) {
                    *sum += tap * sample;
                }
            }
            *out = sums;
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    const RATE_HZ: f64 = 44_100.0;

    fn gain_db(taps: &[f64], frequency_hz: f64) -> f64 {
        let sum: Complex64 = taps
            .iter()
            .enumerate()
            .map(|(i, tap)| Complex64::from_polar(*tap, -2.0 * PI * frequency_hz * i as f64 / RATE_HZ))
            .sum();
        20.0 * sum.norm().log10()
    }

    #[test]
    fn filter_has_the_designed_gains() {
        let centres = centres_hz(RATE_HZ);
        let gains: Vec<f64> = centres.iter().map(|hz| 6.0 * (hz / 1000.0).log2().sin()).collect();
        let taps = design(&gains, RATE_HZ);
        for (hz, gain) in centres.iter().zip(&gains).filter(|(hz, _)| **hz > 250.0) {
            let found = gain_db(&taps, *hz);
            assert!((found - gain).abs() < 0.7, "{hz} Hz: {found} dB instead of {gain} dB");
        }
    }

    #[test]
    fn low_pass_is_flat_below_its_corner_and_attenuates_above() {
        let taps = design_low_pass(11_000.0, RATE_HZ);
        for hz in [100.0, 1000.0, 8000.0, 10_500.0] {
            assert!(gain_db(&taps, hz).abs() < 1.0, "{hz} Hz: {} dB", gain_db(&taps, hz));
        }
        for hz in [13_000.0, 16_000.0, 20_000.0] {
            assert!(gain_db(&taps, hz) < -25.0, "{hz} Hz: {} dB", gain_db(&taps, hz));
        }
    }

    #[test]
    fn is_minimum_phase_and_flat_is_one() {
        let flat = design(&[0.0; 23], RATE_HZ);
        assert!((flat[0] - 1.0).abs() < 1e-9 && flat[1..].iter().all(|x| x.abs() < 1e-9));
        let tilt: Vec<f64> = (0..23).map(|i| f64::from(i) - 11.0).collect();
        let taps = design(&tilt, RATE_HZ);
        let energy = |taps: &[f64]| taps.iter().map(|x| x * x).sum::<f64>();
        assert!(energy(&taps[..32]) > 0.95 * energy(&taps));
    }

    #[test]
    fn a_change_of_the_amount_does_not_click() {
        let taps = design(&[6.0; 23], RATE_HZ);
        let mut equalizer = Equalizer::new(RATE_HZ, 1);
        let mut signal = vec![1.0; 20_000];
        for i in 0..signal.len() {
            let amount = if i / 5000 % 2 == 0 { 0.0 } else { 1.0 };
            equalizer.process(&taps, amount, &mut [&mut signal], i..i + 1);
        }
        let largest = signal.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
        assert!((signal[9999] - 2.0).abs() < 0.02 && largest < 2e-3, "{largest}");
    }

    #[test]
    fn amount_0_is_bit_exact_and_silence_ends() {
        let taps = design(&[6.0; 23], RATE_HZ);
        let mut equalizer = Equalizer::new(RATE_HZ, 1);
        let mut signal: Vec<f64> = (0..3000).map(|i| if i < 1000 { (f64::from(i) * 0.1).sin() } else { 0.0 }).collect();
        let untouched = signal.clone();
        let all = 0..signal.len();
        equalizer.process(&taps, 0.0, &mut [&mut signal], all.clone());
        assert_eq!(signal, untouched);
        equalizer.reset();
        equalizer.process(&taps, 1.0, &mut [&mut signal], all);
        assert!((signal[500] / untouched[500] - 2.0).abs() < 0.02);
        assert!(signal[1000 + equalizer.tail_samples()..].iter().all(|x| *x == 0.0));
    }

    fn noise(samples: usize) -> Vec<f64> {
        let mut noise = vec![0.0; samples];
        crate::dsp::White::new(3, 4).fill(0, &mut noise);
        noise
    }

    #[test]
    fn equals_the_plain_convolution_at_every_rate() {
        for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
            let tilt: Vec<f64> = (0..23).map(|i| f64::from(i) - 11.0).collect();
            let taps = design(&tilt, rate_hz);
            let input = noise(6_000);
            let mut output = input.clone();
            let mut equalizer = Equalizer::new(rate_hz, 1);
            equalizer.process(&taps, 1.0, &mut [&mut output], 0..input.len());
            let scale = taps.iter().map(|tap| tap.abs()).sum::<f64>();
            for (i, found) in output.iter().enumerate() {
                let expected: f64 = taps.iter().zip(input[..=i].iter().rev()).map(|(tap, x)| tap * x).sum();
                assert!((found - expected).abs() < 1e-13 * scale, "{rate_hz} Hz, {i}: {found} instead of {expected}");
            }
        }
    }

    #[test]
    fn output_does_not_depend_on_how_the_sound_is_cut() {
        let taps = [design(&[6.0; 23], RATE_HZ), design(&[-3.0; 23], RATE_HZ), Vec::new()];
        // Silence, other taps and other amounts, at places that lie in no block's middle.
        let run = |cut: usize| {
            let mut equalizer = Equalizer::new(RATE_HZ, 2);
            let (mut left, mut right) = (noise(12_000), noise(12_000));
            left[5_000..7_000].fill(0.0);
            right[5_000..7_000].fill(0.0);
            let mut at = 0;
            while at < left.len() {
                let amount = [0.0, 1.0, 0.4, 1.0, 0.0][at / 1_000 % 5];
                let end = (at + cut).min((at / 1_000 + 1) * 1_000);
                equalizer.process(&taps[at / 3_000 % 3], amount, &mut [&mut left, &mut right], at..end);
                at = end;
            }
            (left, right)
        };
        let whole = run(1_000);
        for cut in [1, 7, 64, 333] {
            assert!(run(cut) == whole, "cut into {cut}");
        }
    }

    #[test]
    fn equalizer_turned_on_late_equals_one_always_on() {
        let taps = design(&(0..23).map(|i| f64::from(i) - 11.0).collect::<Vec<f64>>(), RATE_HZ);
        let run = |first: f64| {
            let mut equalizer = Equalizer::new(RATE_HZ, 1);
            let mut signal = noise(16_000);
            equalizer.process(&taps, first, &mut [&mut signal], 0..3_000);
            equalizer.process(&taps, 1.0, &mut [&mut signal], 3_000..16_000);
            signal
        };
        let (always, later) = (run(1.0), run(0.0));
        // A quarter of a second later the amount has arrived, apart from rounding.
        let error = always[15_000..].iter().zip(&later[15_000..]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(error < 1e-9, "{error}");
    }
}
