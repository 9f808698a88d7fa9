//! Power-law noise that never ends (§4): white noise, a function of (seed, channel, position),
//! shaped to frequency^(-alpha/2) above the blend.

use super::band::Band;
use super::layout::Layout;
use super::spectrum::Transform;
use crate::controls::ExtendControls;
use crate::error::within;
use crate::noise::White;

/// Where the extension's noise comes from.
pub trait NoiseSource {
    /// Writes the noise of `channel` at the positions from `start` on: real, its amplitude falling
    /// as frequency^(-alpha/2), times the blend's upper ramp. `out` is as long as a window, or two
    /// half-widths; at width 0 every channel gets the same.
    fn fill(&mut self, channel: usize, start: i64, controls: &ExtendControls, out: &mut [f64]);

    /// Amplitude density of the noise at the cutoff, the ramp left out: the root of the mean power
    /// of a stretch's Fourier transform per sample of the stretch.
    fn level(&self, controls: &ExtendControls) -> f64;
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
    /// Blocks stand on multiples of their length, so that a block is the same whoever asks for it.
    block_len: usize,
    /// One per channel.
    blocks: Vec<Block>,
    /// White noise around the block: one stream shared by all channels, then one of each.
    streams: Vec<Stream>,
}

impl PowerLaw {
    /// Noise for `channels` channels in windows of the given layout.
    pub(crate) fn new(layout: &Layout, channels: usize, sample_rate_hz: f64) -> Self {
        let transform = Transform::new(layout.transform_len);
        let reach = layout.low_reach.min((layout.transform_len - 2 * layout.half_width) / 2);
        let bin_hz = sample_rate_hz / layout.transform_len as f64;
        Self {
            sample_rate_hz,
            reach,
            log_frequency: (0..transform.bins()).map(|bin| (bin as f64 * bin_hz).ln()).collect(),
            band: None,
            shape: vec![0.0; transform.bins()],
            taps: vec![0.0; reach + 1],
            block_len: 2 * layout.half_width,
            blocks: (0..channels).map(|_| Block { kind: None, samples: vec![0.0; 2 * layout.half_width] }).collect(),
            streams: (0..=channels as u32).map(|stream| Stream::new(stream, layout.transform_len)).collect(),
            transform,
        }
    }

    fn make(&mut self, channel: usize, kind: &Kind) {
        if self.band != Some(kind.band) {
            self.set_band(&kind.band);
        }
        let from = kind.number * self.block_len as i64 - self.reach as i64;
        let count = self.block_len + 2 * self.reach;
        let time = &mut self.transform.time;
        time.fill(0.0);
        // Powers add up to 1, so width does not change the level.
        let shared = (1.0 - kind.own * kind.own).sqrt();
        for (gain, stream) in [(shared, 0), (kind.own, channel + 1)] {
            if gain > 0.0 {
                let white = self.streams[stream].at(kind.seed, from, count);
                time.iter_mut().zip(white).for_each(|(sum, white)| *sum += gain * white);
            }
        }
        self.transform.forward();
        self.transform.filter(&self.shape);
        let block = &mut self.blocks[channel];
        block.samples.copy_from_slice(&self.transform.time[self.reach..self.reach + self.block_len]);
        block.kind = Some(*kind);
    }

    /// Samples the wanted response, cuts it to the filter's length and tapers its last quarter, so
    /// that blocks join without a seam.
    fn set_band(&mut self, band: &Band) {
        let bin_hz = self.sample_rate_hz / self.transform.len() as f64;
        let log_cutoff = band.cutoff_hz.ln();
        for (bin, (value, log_hz)) in self.transform.spectrum.iter_mut().zip(&self.log_frequency).enumerate() {
            let upper = if bin == 0 { 0.0 } else { band.upper(bin as f64 * bin_hz) };
            let gain = if upper == 0.0 { 0.0 } else { upper * (-0.5 * band.alpha * (log_hz - log_cutoff)).exp() };
            *value = gain.into();
        }
        self.transform.inverse();
        let scale = 1.0 / self.transform.len() as f64;
        for (tap, value) in self.taps.iter_mut().enumerate() {
            let along = (tap as f64 / (self.reach + 1) as f64 - 0.75).max(0.0) * 4.0;
            *value = self.transform.time[tap] * scale * (0.5 + 0.5 * (std::f64::consts::PI * along).cos());
        }
        self.transform.response(&self.taps, &mut self.shape);
        self.band = Some(*band);
    }
}

impl NoiseSource for PowerLaw {
    fn fill(&mut self, channel: usize, start: i64, controls: &ExtendControls, out: &mut [f64]) {
        // One channel alone has no width.
        let own = if self.blocks.len() == 1 { 0.0 } else { within(controls.width, 0.0, 1.0) };
        let len = self.block_len as i64;
        let mut done = 0;
        while done < out.len() {
            let at = start + done as i64;
            let offset = at.rem_euclid(len) as usize;
            let kind = Kind { number: at.div_euclid(len), band: Band::new(controls), seed: controls.seed, own };
            if self.blocks[channel].kind != Some(kind) {
                self.make(channel, &kind);
            }
            let piece = &self.blocks[channel].samples[offset..];
            let count = piece.len().min(out.len() - done);
            out[done..done + count].copy_from_slice(&piece[..count]);
            done += count;
        }
    }

    fn level(&self, _controls: &ExtendControls) -> f64 {
        1.0
    }
}

/// All that a block of noise depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kind {
    /// The block begins at this times the blocks' length.
    number: i64,
    band: Band,
    seed: u32,
    /// Part of the channel's own stream in amplitude.
    own: f64,
}

/// A channel's latest block. Windows overlap, so the next one mostly begins with it.
#[derive(Debug)]
struct Block {
    kind: Option<Kind>,
    samples: Vec<f64>,
}

/// The stretch of one white stream that was last asked for; the next one overlaps it.
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

    fn at(&mut self, seed: u32, start: i64, count: usize) -> &[f64] {
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
