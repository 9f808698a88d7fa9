//! Endless power-law noise (§4): white noise, a function of (seed, channel, position), shaped to frequency^(-alpha/2)
//! above the blend.

use std::ops::Range;

use super::band::Band;
use super::layout::ExtensionSizes;
use crate::controls::ExtendControls;
use crate::dsp::{Transform, White};
use crate::error::within;

/// Source of the extension's noise.
pub trait NoiseSource {
    /// Writes the noise of `channel` from position `start` on: real, with an amplitude that falls as
    /// frequency^(-alpha/2), times the blend's upper ramp. `out` is as long as a window, two half-widths; at width 0
    /// every channel gets the same noise.
    fn fill(&mut self, channel: usize, start: i64, controls: &ExtendControls, out: &mut [f64]);

    /// Amplitude density of the noise at the cutoff, without the ramp: the root of the mean power of a section's
    /// Fourier transform per sample of the section.
    fn level(&self, controls: &ExtendControls) -> f64;

    /// Number of steps in which a window's noise can be made in advance; 0 if it cannot.
    fn steps(&self) -> usize {
        0
    }

    /// Does one of these steps for the window whose noise [`fill`](Self::fill) will request next, in order. `fill` does
    /// whatever has not been done by then.
    fn prepare(&mut self, _step: usize, _start: i64, _controls: &ExtendControls) {}
}

/// The product's noise, of unit density at the cutoff.
#[derive(Debug)]
pub struct PowerLaw {
    transform: Transform,
    sample_rate_hz: f64,
    /// Half-length of the shaping filter in samples.
    reach: usize,
    /// Logarithm of every bin's frequency in Hz.
    log_frequency: Vec<f64>,
    band: Option<Band>,
    shape: Vec<f64>,
    taps: Vec<f64>,
    /// The shape being designed, and the steps of it that are done.
    design: Option<(Band, usize)>,
    /// The block being made, its channel, and its finished steps.
    making: Option<(usize, NoiseKind, usize)>,
    /// Blocks are aligned with multiples of their length, so that a block is the same for every caller.
    block_len: usize,
    /// Per channel the latest of even and of odd number.
    blocks: Vec<[Block; 2]>,
    /// White noise around the block: one stream shared by all channels, then one for each.
    streams: Vec<Stream>,
}

impl PowerLaw {
    /// Noise for `channels` channels in windows of the given layout.
    pub(crate) fn new(layout: &ExtensionSizes, channels: usize, sample_rate_hz: f64) -> Self {
        let transform = Transform::new(layout.transform_len);
        let reach = layout.low_reach.min((layout.transform_len - 2 * layout.half_width) / 2);
        let bin_hz = sample_rate_hz / layout.transform_len as f64;
        Self {
            sample_rate_hz,
            reach,
            log_frequency: (0..transform.bins()).map(|bin| maths::ln(bin as f64 * bin_hz)).collect(),
            band: None,
            design: None,
            making: None,
            shape: vec![0.0; transform.bins()],
            taps: vec![0.0; reach + 1],
            block_len: 2 * layout.half_width,
            blocks: (0..channels).map(|_| [0, 1].map(|_| Block::new(2 * layout.half_width))).collect(),
            streams: (0..=channels as u32).map(|stream| Stream::new(stream, layout.transform_len)).collect(),
            transform,
        }
    }

    fn kind(&self, number: i64, controls: &ExtendControls) -> NoiseKind {
        // A single channel has no width.
        let own = if self.blocks.len() == 1 { 0.0 } else { within(controls.width, 0.0, 1.0) };
        NoiseKind { number, band: Band::new(controls), seed: controls.seed, own }
    }

    fn block(&mut self, channel: usize, number: i64) -> &mut Block {
        &mut self.blocks[channel][number.rem_euclid(2) as usize]
    }

    /// Makes a block that was not made in advance.
    fn make(&mut self, channel: usize, kind: &NoiseKind) {
        (self.design, self.making) = (None, None);
        if self.band != Some(kind.band) {
            (0..DESIGN_STEPS).for_each(|step| self.design_step(step, &kind.band));
        }
        (0..BLOCK_STEPS).for_each(|step| self.block_step(step, channel, kind));
    }

    fn block_step(&mut self, step: usize, channel: usize, kind: &NoiseKind) {
        match step {
            0 => self.white(channel, kind),
            1 => self.transform.forward(),
            _ => {
                self.transform.filter(&self.shape);
                let (reach, len) = (self.reach, self.block_len);
                let block = &mut self.blocks[channel][kind.number.rem_euclid(2) as usize];
                block.samples.copy_from_slice(&self.transform.time[reach..reach + len]);
                block.kind = Some(*kind);
            }
        }
    }

    /// White noise for a block.
    fn white(&mut self, channel: usize, kind: &NoiseKind) {
        let from = kind.number * self.block_len as i64 - self.reach as i64;
        let count = self.block_len + 2 * self.reach;
        let time = &mut self.transform.time;
        time.fill(0.0);
        // Powers add up to 1, so width does not change the level.
        let shared = (1.0 - kind.own * kind.own).sqrt();
        for (gain, stream) in [(shared, 0), (kind.own, channel + 1)] {
            if gain > 0.0 {
                let white = self.streams[stream].samples_from(kind.seed, from, count);
                time.iter_mut().zip(white).for_each(|(sum, white)| *sum += gain * white);
            }
        }
    }

    /// Samples the wanted response, cuts it to the filter's length and tapers its last quarter, so
    /// that blocks join without a seam.
    fn design_step(&mut self, step: usize, band: &Band) {
        self.band = None;
        if step < BIN_STEPS {
            let bins = self.transform.bins();
            self.set_bins(step * bins / BIN_STEPS..(step + 1) * bins / BIN_STEPS, band);
        } else if step == BIN_STEPS {
            self.transform.inverse();
            let scale = 1.0 / self.transform.len() as f64;
            for (tap, value) in self.taps.iter_mut().enumerate() {
                let along = (tap as f64 / (self.reach + 1) as f64 - 0.75).max(0.0) * 4.0;
                *value = self.transform.time[tap] * scale * (0.5 + 0.5 * maths::cos(std::f64::consts::PI * along));
            }
        } else {
            self.transform.response(&self.taps, &mut self.shape);
            self.band = Some(*band);
        }
    }

    fn set_bins(&mut self, bins: Range<usize>, band: &Band) {
        let bin_hz = self.sample_rate_hz / self.transform.len() as f64;
        let log_cutoff = maths::ln(band.cutoff_hz);
        for bin in bins {
            let upper = if bin == 0 { 0.0 } else { band.upper(bin as f64 * bin_hz) };
            let falls = -0.5 * band.alpha * (self.log_frequency[bin] - log_cutoff);
            let gain = if upper == 0.0 { 0.0 } else { upper * maths::exp(falls) };
            self.transform.spectrum[bin] = gain.into();
        }
    }
}

/// Number of steps in which the bins of a shape are set.
const BIN_STEPS: usize = 4;
/// Steps of designing a shape: its bins, to time and back.
const DESIGN_STEPS: usize = BIN_STEPS + 2;
/// Steps of making a block: white noise, forward, and back.
const BLOCK_STEPS: usize = 3;

impl NoiseSource for PowerLaw {
    fn fill(&mut self, channel: usize, start: i64, controls: &ExtendControls, out: &mut [f64]) {
        let len = self.block_len as i64;
        let mut done = 0;
        while done < out.len() {
            let at = start + done as i64;
            let offset = at.rem_euclid(len) as usize;
            let kind = self.kind(at.div_euclid(len), controls);
            if self.block(channel, kind.number).kind != Some(kind) {
                self.make(channel, &kind);
            }
            let piece = &self.block(channel, kind.number).samples[offset..];
            let count = piece.len().min(out.len() - done);
            out[done..done + count].copy_from_slice(&piece[..count]);
            done += count;
        }
    }

    fn steps(&self) -> usize {
        DESIGN_STEPS + self.blocks.len() * 2 * BLOCK_STEPS
    }

    fn prepare(&mut self, step: usize, start: i64, controls: &ExtendControls) {
        let band = Band::new(controls);
        let Some(step) = step.checked_sub(DESIGN_STEPS) else {
            if step == 0 {
                self.making = None;
                self.design = (self.band != Some(band)).then_some((band, 0));
            }
            if self.design == Some((band, step)) {
                self.design = Some((band, step + 1));
                self.design_step(step, &band);
            }
            return;
        };
        let (channel, step) = (step / (2 * BLOCK_STEPS), step % (2 * BLOCK_STEPS));
        let (which, step) = ((step / BLOCK_STEPS) as i64, step % BLOCK_STEPS);
        // A window that begins with a block also ends with it.
        let is_asked = which == 0 || start.rem_euclid(self.block_len as i64) != 0;
        // At width 0 all channels equal the first.
        if !is_asked || channel > 0 && controls.width <= 0.0 || self.band != Some(band) {
            return;
        }
        let kind = self.kind(start.div_euclid(self.block_len as i64) + which, controls);
        if step == 0 {
            self.making = (self.block(channel, kind.number).kind != Some(kind)).then_some((channel, kind, 0));
        }
        if self.making == Some((channel, kind, step)) {
            self.making = Some((channel, kind, step + 1));
            self.block_step(step, channel, &kind);
        }
    }

    fn level(&self, _controls: &ExtendControls) -> f64 {
        1.0
    }
}

/// All parameters of a block of noise.
#[derive(Debug, Clone, Copy, PartialEq)]
struct NoiseKind {
    /// The block begins at this multiple of the blocks' length.
    number: i64,
    band: Band,
    seed: u32,
    /// Share of the channel's own stream, in amplitude.
    own: f64,
}

/// A channel's block.
#[derive(Debug)]
struct Block {
    kind: Option<NoiseKind>,
    samples: Vec<f64>,
}

impl Block {
    fn new(len: usize) -> Self {
        Self { kind: None, samples: vec![0.0; len] }
    }
}

/// The section of one white stream that was requested last; the next one overlaps it.
#[derive(Debug)]
struct Stream {
    number: u32,
    seed: u32,
    start: i64,
    samples: Vec<f64>,
    /// Samples that are valid, from `start` on.
    filled: usize,
}

impl Stream {
    fn new(number: u32, longest: usize) -> Self {
        Self { number, seed: 0, start: 0, samples: vec![0.0; longest], filled: 0 }
    }

    fn samples_from(&mut self, seed: u32, start: i64, count: usize) -> &[f64] {
        let end = self.start + self.filled as i64;
        let kept = if seed == self.seed && start >= self.start && start < end {
            let skip = (start - self.start) as usize;
            self.samples.copy_within(skip..self.filled, 0);
            (self.filled - skip).min(count)
        } else {
            0
        };
        White::new(seed, self.number).fill(start + kept as i64, &mut self.samples[kept..count]);
        (self.seed, self.start, self.filled) = (seed, start, count);
        &self.samples[..count]
    }
}
