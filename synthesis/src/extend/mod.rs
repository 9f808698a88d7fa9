//! Spectral bandwidth extension (Chadwick & James 2011, §4, Algorithm 1), streaming.
//!
//! The drive's spectrum ends at a cutoff. Above it there is noise whose power falls as frequency^(-alpha), which
//! follows the drive's envelope and is scaled, window by window, so that it joins the drive's spectrum at the cutoff.
//!
//! | module | content |
//! |---|---|
//! | [`band`] | the blend between drive and noise, and the filters made from it |
//! | [`window`] | triangular windows on the host's timeline |
//! | `low` | the drive below the blend |
//! | [`noise`] | endless power-law noise |
//! | [`beta`] | the fit, and the rule against its outliers |
//! | `high` | windows of noise |
//! | [`mod@reference`] | the whole-file algorithm in double precision, as published |

pub mod band;
pub mod beta;
mod high;
mod layout;
mod low;
pub mod noise;
pub mod reference;
pub mod window;

use band::Band;
use beta::Fit;
use high::{High, Surroundings};
use layout::ExtensionSizes;
use low::{DESIGN_PARTS, Half, Low};
use noise::{NoiseSource, PowerLaw};
use window::into_hop;

use crate::controls::ExtendControls;
use crate::dsp::{OverlapAdd, RingBuffer, Timeline};
use crate::error::{Error, in_range};
use crate::structure::EngineConfig;

/// Largest number of channels: those of 7.1.2.
const MAX_CHANNELS: usize = 10;

/// Drive below this amplitude counts as silence, which avoids denormals.
const SILENCE: f64 = 1e-30;

/// Seconds, in addition to the latency, for which the low part continues after it is no longer needed: by then, levels
/// that follow their controls have fallen to nothing.
const LOW_HOLD_S: f64 = 0.5;

/// Parts of a hop between which the low part's events are scheduled.
const LOW_PARTS: usize = 16;
/// The event at which a block's second half begins, in the middle of a hop.
const LOW_SECOND: usize = LOW_PARTS / 2;
/// Events of the low part in a hop: half a block in three, the next filter's design, and the other half.
const LOW_EVENTS: usize = LOW_SECOND + 3;
const _: () = assert!(3 + DESIGN_PARTS == LOW_SECOND);

/// The streaming engine.
///
/// Windows are aligned with multiples of the half-width on the host's timeline, so that the work of each window, and
/// its time, depend neither on block sizes nor on the start of playback.
#[derive(Debug)]
pub struct Extend<N = PowerLaw> {
    layout: ExtensionSizes,
    source: N,
    low: Low,
    high: High,
    drive: RingBuffer,
    chunk: Vec<f64>,
    controls: Timeline<ExtendControls>,
    /// Position of the first sample after reset.
    origin: i64,
    /// Position of the latest drive that was not 0.
    last_loud: i64,
    /// Offsets in samples, after a window is due, of each step towards the next.
    step_offsets: Vec<usize>,
    low_schedule: LowSchedule,
    noise_out: Vec<OverlapAdd>,
    fits: Vec<Fit>,
    /// The first channel's noise factors since they were last taken.
    betas: Vec<f32>,
}

/// When the low part is made, and where it goes.
#[derive(Debug)]
struct LowSchedule {
    /// Samples from the start of a block of the low part until the drive of its first half has arrived, and from then
    /// to each event.
    start: usize,
    offsets: [usize; LOW_EVENTS],
    out: OverlapAdd,
    /// Position up to which the low part is made, and whether it included the last block.
    until: i64,
    is_on: bool,
    hold_samples: i64,
}

/// Largest number of stored factors, six seconds of them at the default half-width. If nothing takes them, as without a
/// window, later ones are lost.
const BETA_CAPACITY: usize = 512;

impl Extend {
    /// An engine at position 0.
    ///
    /// Fails if a value of the structure is out of its range, `channels` is not 1-10, or `sample_rate_hz` is not
    /// 8,000-384,000.
    pub fn new(structure: &EngineConfig, channels: usize, sample_rate_hz: f64) -> Result<Self, Error> {
        in_range("number of channels", channels as f64, 1.0, MAX_CHANNELS as f64)?;
        let layout = ExtensionSizes::new(structure, sample_rate_hz)?;
        let source = PowerLaw::new(&layout, channels, sample_rate_hz);
        Self::with_noise(structure, channels, sample_rate_hz, source)
    }
}

/// Output delay in samples of engines with this structure at this sample rate in Hz.
///
/// # Errors
/// [`Error::OutOfRange`] if the structure or the rate is out of range.
pub fn latency_samples(structure: &EngineConfig, sample_rate_hz: f64) -> Result<usize, Error> {
    Ok(ExtensionSizes::new(structure, sample_rate_hz)?.latency)
}

impl<N: NoiseSource> Extend<N> {
    /// An engine with noise of another source; fails as [`new`](Extend::new) does.
    pub fn with_noise(
        structure: &EngineConfig,
        channels: usize,
        sample_rate_hz: f64,
        source: N,
    ) -> Result<Self, Error> {
        in_range("number of channels", channels as f64, 1.0, MAX_CHANNELS as f64)?;
        let layout = ExtensionSizes::new(structure, sample_rate_hz)?;
        // The oldest sample still needed: for a low block's filter, or a window's envelope.
        let keep = (layout.half_width + 2 * layout.low_reach).max(2 * (layout.half_width + layout.envelope_reach));
        let span = layout.latency + layout.half_width + layout.high_reach;
        let high = High::new(&layout, channels, sample_rate_hz, structure.fit_width_hz);
        let (hop, steps) = (layout.half_width, high.steps(source.steps()));
        // Halves need the controls at the block's end; if windows are longer than the filter, these come too late.
        let first_half = if layout.low_reach < hop { hop } else { hop.div_ceil(2) };
        let mut extend = Self {
            source,
            step_offsets: (0..steps).map(|step| (step * hop / steps).clamp(1, (hop - 1).max(1))).collect(),
            low_schedule: LowSchedule {
                start: layout.low_reach + first_half,
                offsets: std::array::from_fn(|event| event * hop / LOW_PARTS),
                out: OverlapAdd::new(span),
                until: 0,
                is_on: true,
                hold_samples: (layout.latency + layout.half_width) as i64 + (LOW_HOLD_S * sample_rate_hz) as i64,
            },
            low: Low::new(&layout, sample_rate_hz),
            high,
            drive: RingBuffer::new(keep),
            chunk: vec![0.0; layout.half_width],
            controls: Timeline::new(layout.latency + layout.half_width, ExtendControls::default()),
            origin: 0,
            last_loud: i64::MIN,
            noise_out: (0..channels).map(|_| OverlapAdd::new(span)).collect(),
            fits: vec![Fit::default(); channels],
            betas: Vec::with_capacity(BETA_CAPACITY),
            layout,
        };
        extend.reset(0);
        Ok(extend)
    }

    /// Delay of all outputs in samples; a function of structure and sample rate only.
    pub fn latency_samples(&self) -> usize {
        self.layout.latency
    }

    /// Samples for which outputs may differ from 0 after the drive has become 0, counted from that drive sample's own
    /// position in the output, [`latency_samples`](Self::latency_samples) later.
    pub fn tail_samples(&self) -> usize {
        (self.layout.low_reach + self.layout.half_width).max(2 * self.layout.half_width + self.layout.high_reach)
    }

    /// Half-width of a window in samples, which is the distance between windows.
    pub fn hop_samples(&self) -> usize {
        self.layout.half_width
    }

    /// Resets to silence; the next sample is at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        // Leaves room for years of sound on either side.
        let position = position.clamp(-(1 << 60), 1 << 60);
        self.origin = position;
        self.last_loud = i64::MIN;
        self.low.reset();
        self.high.reset();
        self.drive.reset(position);
        self.controls.reset(ExtendControls::default());
        let front = position - self.layout.latency as i64;
        self.low_schedule.out.reset(front);
        self.low_schedule.until = i64::MIN;
        self.low_schedule.is_on = true;
        self.noise_out.iter_mut().for_each(|out| out.reset(front));
        self.fits.fill(Fit::default());
        self.betas.clear();
    }

    /// Processes one block of any length. `controls` apply to the whole block; a window uses those in force at its
    /// centre. `low` and every channel of `noise` are as long as `drive`, and delayed by the latency.
    pub fn process(&mut self, drive: &[f64], controls: &ExtendControls, low: &mut [f64], noise: &mut [&mut [f64]]) {
        self.process_wanted(drive, controls, true, low, noise);
    }

    /// The same with an optional low part: half a second plus the latency after it was last needed, it is no longer
    /// computed, and `low` is 0. When it is needed again it fades in at once, and is complete before that sound comes
    /// out.
    pub fn process_wanted(
        &mut self,
        drive: &[f64],
        controls: &ExtendControls,
        is_low_wanted: bool,
        low: &mut [f64],
        noise: &mut [&mut [f64]],
    ) {
        let count = noise.iter().map(|channel| channel.len()).fold(drive.len().min(low.len()), usize::min);
        if is_low_wanted {
            self.low_schedule.until = (self.drive.end() + count as i64).saturating_add(self.low_schedule.hold_samples);
        }
        let mut done = 0;
        while done < count {
            let position = self.drive.end();
            let step = ((self.next_event(position) - position) as usize).min(count - done);
            self.push_drive(&drive[done..done + step], controls);
            self.low_schedule.out.read(&mut low[done..done + step]);
            for (out, channel) in self.noise_out.iter_mut().zip(noise.iter_mut()) {
                out.read(&mut channel[done..done + step]);
            }
            done += step;
            self.work(position + step as i64);
        }
    }

    /// Processes the drive up to the next event.
    fn push_drive(&mut self, drive: &[f64], controls: &ExtendControls) {
        let chunk = &mut self.chunk[..drive.len()];
        for (kept, sample) in chunk.iter_mut().zip(drive) {
            *kept = if sample.abs() < SILENCE { 0.0 } else { *sample };
        }
        if let Some(last) = chunk.iter().rposition(|sample| *sample != 0.0) {
            self.last_loud = self.drive.end() + last as i64;
        }
        self.drive.push(chunk);
        self.controls.push(*controls, drive.len());
    }

    /// The first position after `position` at which there is work to do: a function of the position only.
    fn next_event(&self, position: i64) -> i64 {
        let hop = self.layout.half_width;
        let into = into_hop(position, self.layout.envelope_reach, hop);
        let next_step = self.step_offsets[self.steps_by(into)..].first().copied().unwrap_or(hop);
        let into_low = into_hop(position, self.low_schedule.start, hop);
        let next_low = self.low_schedule.offsets.iter().copied().find(|offset| *offset > into_low).unwrap_or(hop);
        position + (next_step - into).min(next_low - into_low) as i64
    }

    /// Steps that are planned for the first `into` samples after a window was due.
    fn steps_by(&self, into: usize) -> usize {
        self.step_offsets.partition_point(|offset| *offset <= into)
    }

    /// Does the work that is due once the drive has reached `end`.
    fn work(&mut self, end: i64) {
        let hop = self.layout.half_width;
        let into = into_hop(end, self.layout.envelope_reach, hop);
        let window = (end - into as i64 - self.layout.envelope_reach as i64) / hop as i64 - 1;
        if into == 0 {
            self.process_window(window);
        } else {
            self.compute_ahead(window + 1, into);
        }
        let into = into_hop(end, self.low_schedule.start, hop);
        let block = end - (self.low_schedule.start + into) as i64;
        for event in 0..LOW_EVENTS {
            if self.low_schedule.offsets[event] == into {
                self.low_event(event, block);
            }
        }
    }

    /// Samples of the first half of a block of the low part.
    fn first_half(&self) -> usize {
        self.low_schedule.start - self.layout.low_reach
    }

    /// Does the steps towards `window` that are planned for `into` samples after the one before.
    fn compute_ahead(&mut self, window: i64, into: usize) {
        let hop = self.layout.half_width;
        let planned = self.steps_by(into);
        let centre = window * hop as i64;
        let controls = self.controls_at(centre);
        let start = centre - hop as i64;
        // After a silence, or a reset within a hop, two at a time catch up; the rest is done when the window is due.
        for _ in 0..2 {
            let is_silent = self.high.is_ahead() && self.last_loud < start;
            if self.high.done() >= planned || is_silent {
                return;
            }
            let mut with = Surroundings { drive: &self.drive, source: &mut self.source, out: &mut self.noise_out };
            self.high.step((start, &controls), &mut with);
        }
    }

    /// The factor in use by the last window, in the first channel.
    pub fn beta(&self) -> f64 {
        self.last_fit(0).applied
    }

    /// The last window's fit in `channel`; zeros before the first window, in silence, if the noise amount is 0, and for
    /// a channel that does not exist.
    pub fn last_fit(&self, channel: usize) -> Fit {
        self.fits.get(channel).copied().unwrap_or_default()
    }

    /// Returns the first channel's noise factors since they were last taken, at most 512.
    pub fn take_betas(&mut self) -> std::vec::Drain<'_, f32> {
        self.betas.drain(..)
    }

    /// Handles one of the events of the low part's block from `start` on.
    fn low_event(&mut self, event: usize, start: i64) {
        let hop = self.layout.half_width;
        match event {
            0 | LOW_SECOND => self.begin_low(start, event == 0),
            1 => self.low.filter_from(&mut self.low_schedule.out),
            2 => self.low.filter_to(&mut self.low_schedule.out),
            _ if event < LOW_SECOND => {
                // The end of the next block, if its controls are known already.
                let at = start + 2 * hop as i64;
                if self.low_schedule.is_on && at < self.drive.end() {
                    self.low.design(event - 3, &self.band_at(at));
                }
            }
            _ if event == LOW_SECOND + 1 => self.low.filter_from(&mut self.low_schedule.out),
            _ => self.low.filter_to(&mut self.low_schedule.out),
        }
    }

    /// Begins half a block.
    fn begin_low(&mut self, block: i64, is_first: bool) {
        let (hop, first) = (self.layout.half_width, self.first_half());
        let is_on = self.drive.end() <= self.low_schedule.until;
        let was_on = std::mem::replace(&mut self.low_schedule.is_on, is_on);
        if is_on && (is_first || first < hop) {
            let (offset, len) = if is_first { (0, first) } else { (first, hop - first) };
            let (from, to) = (self.band_at(block), self.band_at(block + hop as i64));
            let half = Half { start: block + offset as i64, offset, len, from, to, fades_in: !was_on };
            self.low.begin(half, &self.drive);
        }
    }

    fn process_window(&mut self, window: i64) {
        let centre = window * self.layout.half_width as i64;
        let controls = self.controls_at(centre);
        let start = centre - self.layout.half_width as i64;
        let mut with = Surroundings { drive: &self.drive, source: &mut self.source, out: &mut self.noise_out };
        self.high.process((window, start), &controls, &mut with, &mut self.fits);
        if self.betas.len() < BETA_CAPACITY {
            self.betas.push(self.fits[0].applied as f32);
        }
    }

    fn controls_at(&self, position: i64) -> ExtendControls {
        self.controls.value_at((position - self.origin).max(0) as u64)
    }

    fn band_at(&self, position: i64) -> Band {
        // The noise's exponent does not affect the low part.
        Band { alpha: 0.0, ..Band::new(&self.controls_at(position)) }
    }
}
