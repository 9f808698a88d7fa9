//! Spectral bandwidth extension (Chadwick & James 2011, §4, Algorithm 1), streaming.
//!
//! The drive's spectrum ends at a cutoff. Above it stands noise whose power falls as
//! frequency^(-alpha), which follows the drive's envelope and is scaled, window by window, so that
//! it joins the drive's spectrum at the cutoff.
//!
//! | module | does |
//! |---|---|
//! | [`band`] | the blend between drive and noise, and filters made of it |
//! | [`window`] | triangular windows on the host's timeline |
//! | `low` | the drive below the blend |
//! | [`noise`] | endless power-law noise |
//! | [`beta`] | the fit, and the rule that tames its outliers |
//! | `high` | one window of noise |
//! | [`mod@reference`] | the whole-file algorithm in double precision, as published |

pub mod band;
pub mod beta;
mod high;
mod layout;
mod low;
pub mod noise;
pub mod reference;
pub(crate) mod spectrum;
pub mod window;
mod zoom;

use band::Band;
use beta::Fit;
use high::High;
use layout::Layout;
use low::Low;
use noise::{NoiseSource, PowerLaw};
use window::{History, Overlap, next_on_grid};

use crate::controls::ExtendControls;
use crate::error::{Error, in_range};
use crate::structure::Structure;
use crate::timeline::Timeline;

/// Largest number of channels.
const MAX_CHANNELS: usize = 10;

/// Drive below this amplitude counts as silence, which keeps denormals out.
const SILENCE: f64 = 1e-30;

/// The streaming engine.
///
/// Windows stand on multiples of the half-width on the host's timeline, so that which window does
/// what, and when, depends neither on block sizes nor on where playing began.
#[derive(Debug)]
pub struct Extend<N = PowerLaw> {
    layout: Layout,
    source: N,
    low: Low,
    high: High,
    drive: History,
    chunk: Vec<f64>,
    controls: Timeline<ExtendControls>,
    /// Position of the first sample after reset.
    origin: i64,
    low_out: Overlap,
    noise_out: Vec<Overlap>,
    fits: Vec<Fit>,
    /// The first channel's factors of windows since they were taken.
    betas: Vec<f32>,
}

/// Most factors that are kept until they are taken; later ones are lost.
const BETA_CAPACITY: usize = 512;

impl Extend {
    /// An engine at position 0.
    ///
    /// Fails where a structure's value is out of its range, `channels` is not 1-10, or
    /// `sample_rate_hz` is not 8,000-384,000.
    pub fn new(structure: &Structure, channels: usize, sample_rate_hz: f64) -> Result<Self, Error> {
        in_range("number of channels", channels as f64, 1.0, MAX_CHANNELS as f64)?;
        let layout = Layout::new(structure, sample_rate_hz)?;
        let source = PowerLaw::new(&layout, channels, sample_rate_hz);
        Self::with_noise(structure, channels, sample_rate_hz, source)
    }
}

impl<N: NoiseSource> Extend<N> {
    /// An engine with noise of another source; fails as [`new`](Extend::new) does.
    pub fn with_noise(structure: &Structure, channels: usize, sample_rate_hz: f64, source: N) -> Result<Self, Error> {
        in_range("number of channels", channels as f64, 1.0, MAX_CHANNELS as f64)?;
        let layout = Layout::new(structure, sample_rate_hz)?;
        // The oldest sample still needed: a low block's filter, or a window's envelope.
        let keep = (layout.half_width + 2 * layout.low_reach).max(2 * (layout.half_width + layout.envelope_reach));
        let span = layout.latency + layout.half_width + layout.high_reach;
        let mut extend = Self {
            source,
            low: Low::new(&layout, sample_rate_hz),
            high: High::new(&layout, sample_rate_hz, structure.fit_width_hz),
            drive: History::new(keep),
            chunk: vec![0.0; layout.half_width],
            controls: Timeline::new(layout.latency + layout.half_width, ExtendControls::default()),
            origin: 0,
            low_out: Overlap::new(span),
            noise_out: (0..channels).map(|_| Overlap::new(span)).collect(),
            fits: vec![Fit::default(); channels],
            betas: Vec::with_capacity(BETA_CAPACITY),
            layout,
        };
        extend.reset(0);
        Ok(extend)
    }

    /// Delay of all outputs in samples; a function of structure and sample rate alone.
    pub fn latency_samples(&self) -> usize {
        self.layout.latency
    }

    /// Samples for which outputs may differ from 0 after the drive has become 0, counted from
    /// that drive sample's own place in the output, [`latency_samples`](Self::latency_samples)
    /// later.
    pub fn tail_samples(&self) -> usize {
        (self.layout.low_reach + self.layout.half_width).max(2 * self.layout.half_width + self.layout.high_reach)
    }

    /// Half-width of a window in samples, which is the distance from one window to the next.
    pub fn hop_samples(&self) -> usize {
        self.layout.half_width
    }

    /// Back to silence; the next sample stands at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        // Room for years of sound on either side.
        let position = position.clamp(-(1 << 60), 1 << 60);
        self.origin = position;
        self.drive.reset(position);
        self.controls.reset(ExtendControls::default());
        let front = position - self.layout.latency as i64;
        self.low_out.reset(front);
        self.noise_out.iter_mut().for_each(|out| out.reset(front));
        self.fits.fill(Fit::default());
        self.betas.clear();
    }

    /// Processes one block of any length. `controls` hold for the whole block; a window works with
    /// those in force at its centre. `low` and every channel of `noise` are as long as `drive`, and
    /// delayed by the latency.
    pub fn process(&mut self, drive: &[f64], controls: &ExtendControls, low: &mut [f64], noise: &mut [&mut [f64]]) {
        let count = noise.iter().map(|channel| channel.len()).fold(drive.len().min(low.len()), usize::min);
        let mut done = 0;
        while done < count {
            let position = self.drive.end();
            let hop = self.layout.half_width;
            let next_window = next_on_grid(position, self.layout.envelope_reach, hop);
            let next_low = next_on_grid(position, self.layout.low_reach, hop);
            let step = ((next_window.min(next_low) - position) as usize).min(count - done);

            let chunk = &mut self.chunk[..step];
            for (kept, sample) in chunk.iter_mut().zip(&drive[done..]) {
                *kept = if sample.abs() < SILENCE { 0.0 } else { *sample };
            }
            self.drive.push(chunk);
            self.controls.push(*controls, step);
            self.low_out.take(&mut low[done..done + step]);
            for (out, channel) in self.noise_out.iter_mut().zip(noise.iter_mut()) {
                out.take(&mut channel[done..done + step]);
            }
            done += step;

            let end = position + step as i64;
            if end == next_window {
                self.process_window((end - self.layout.envelope_reach as i64).div_euclid(hop as i64) - 1);
            }
            if end == next_low {
                let start = end - (self.layout.low_reach + hop) as i64;
                let (from, to) = (self.band_at(start), self.band_at(start + hop as i64));
                self.low.process(start, &self.drive, &from, &to, &mut self.low_out);
            }
        }
    }

    /// The factor in use by the last window, in the first channel.
    pub fn beta(&self) -> f64 {
        self.last_fit(0).applied
    }

    /// What the last window found in `channel`; zeros before the first window, in silence, where
    /// the noise amount is 0, and for a channel that is not there.
    pub fn last_fit(&self, channel: usize) -> Fit {
        self.fits.get(channel).copied().unwrap_or_default()
    }

    /// Takes the factors that windows have found in the first channel since this was taken last, 512 at most.
    pub fn take_betas(&mut self) -> std::vec::Drain<'_, f32> {
        self.betas.drain(..)
    }

    fn process_window(&mut self, window: i64) {
        let controls = self.controls_at(window * self.layout.half_width as i64);
        self.high.process(window, &self.drive, &controls, &mut self.source, &mut self.fits, &mut self.noise_out);
        if self.betas.len() < BETA_CAPACITY {
            self.betas.push(self.fits[0].applied as f32);
        }
    }

    fn controls_at(&self, position: i64) -> ExtendControls {
        self.controls.at((position - self.origin).max(0) as u64)
    }

    fn band_at(&self, position: i64) -> Band {
        // The noise's exponent does not shape the low part.
        Band { alpha: 0.0, ..Band::new(&self.controls_at(position)) }
    }
}
