//! An equaliser towards a spectrum: minimum phase, so that it adds no latency.
//!
//! Partitioned convolution (Gardner, "Efficient Convolution without Input-Output Delay", 1995): the first taps
//! directly, all others by transforms of blocks of 64 samples, which are due only one block later. The work therefore
//! grows with the sample rate and not with its square, and is the same in every block. Blocks are aligned with the
//! samples counted since the reset, however the sound is divided.

mod design;

use std::ops::Range;

use maths::fft::Complex64;

pub use design::{LIMIT_DB, design, design_low_pass};

use crate::dsp::{Smoothed, Transform};

/// Samples of a block, and taps that are applied directly: the results of a transform are due one block later, so the
/// direct taps must cover one block.
const BLOCK: usize = 64;
/// Time constant in seconds with which the amount follows its control.
const SMOOTHING_S: f64 = 0.02;

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
mod tests;
