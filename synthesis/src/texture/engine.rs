//! Synchronized texture synthesis of a stream (§5.2).
//!
//! The same engine serves files and streams. Its samples have the indices of the reference's padded arrays; samples
//! before the start read as zero, and for a signal of known length so do those beyond the end.

mod buzz_guard;
mod level;
mod matcher;
mod matching;
mod target;

use std::ops::Range;
use std::sync::Arc;

use buzz_guard::BuzzGuard;
use level::Level;
use matcher::Matcher;

use super::dictionary::Dictionary;
use super::distribution::Distribution;
use super::drive_range::DriveRange;
use super::extents::Extent;
use super::gate::Gate;
use super::output::Outputs;
use super::pyramid::PyramidStream;
use super::schedule::Schedule;
use super::shape::PyramidConfig;
use super::slots::{self, Slots};
use super::traces::{Match, Traces};
use crate::Error;
use crate::controls::{SLOTS, TextureControls};
use crate::dsp::{Ring, Smoothed, Timeline};
use crate::error::within;

/// Texture synthesis: a drive in, the sound of the recording that follows it out.
#[derive(Debug)]
pub struct Texture {
    shape: PyramidConfig,
    schedule: Schedule,
    recordings: Recordings,
    drive: Drive,
    levels: Vec<Level>,
    outputs: Outputs,
    gate: Gate,
    timeline: Timeline<TextureControls>,
    matcher: Matcher,
    /// Samples of a level that are complete.
    done: Vec<f64>,
    clock: Clock,
    traces: Traces,
    /// Exponent of the drive's loudness.
    dynamics: Smoothed,
    buzz_guard: BuzzGuard,
}

/// The recordings, and when windows follow another choice of them.
#[derive(Debug)]
struct Recordings {
    slots: Slots<Dictionary>,
    /// Slot that the controls of the last call name first.
    slot: usize,
    /// Largest delay in samples with which a window follows another choice of recordings.
    crossfade_samples: f64,
}

/// What is known of the drive.
#[derive(Debug)]
struct Drive {
    range: DriveRange,
    pyramid: PyramidStream,
    /// Its top level.
    top: Ring,
}

/// Present sample.
#[derive(Debug)]
struct Clock {
    /// Index of the first sample after reset, and its offset from the host's position.
    origin: i64,
    base: i64,
    /// Index of the next sample.
    now: i64,
    latency_samples: i64,
}

/// Time constant in seconds with which the share of the recording's own dynamics follows its control.
const DYNAMICS_S: f64 = 0.02;

impl Texture {
    /// An engine of `shape` with `channels` outputs (1-10) at `sample_rate_hz`.
    pub fn new(shape: &PyramidConfig, channels: usize, sample_rate_hz: f64) -> Result<Self, Error> {
        shape.validate()?;
        crate::error::in_range("output channels", channels as f64, 1.0, 10.0)?;
        crate::error::in_range("sample rate in Hz", sample_rate_hz, 1000.0, 768_000.0)?;
        let latency = shape.latency_samples();
        let schedule = Schedule::new(shape);
        let top_rate_hz = sample_rate_hz / (1u64 << shape.top()) as f64;
        // A level's samples are needed from its own window, one half-width ahead of its centre, until the last finer
        // window has read them.
        let life = |level: usize| {
            let behind = if level == 0 { latency as i64 } else { schedule.offset[level - 1] };
            ((behind - schedule.offset.get(level).copied().unwrap_or(0)).max(0) as usize >> level)
                + 4 * shape.reach()
                + 8
        };
        let crossfade_samples = slots::CROSSFADE_S * sample_rate_hz;
        let longest_wait = schedule.offset[0] as usize + shape.period_samples() + crossfade_samples.ceil() as usize;
        let mut texture = Self {
            recordings: Recordings { slots: Slots::default(), slot: 0, crossfade_samples },
            drive: Drive {
                range: DriveRange::new(top_rate_hz),
                pyramid: PyramidStream::new(shape),
                top: Ring::new(life(shape.top())),
            },
            levels: (0..shape.top()).map(|level| Level::new(life(level))).collect(),
            outputs: Outputs::new(channels, life(0)),
            gate: Gate::new(latency.div_ceil(1 << shape.top())),
            timeline: Timeline::new(longest_wait, TextureControls::default()),
            matcher: Matcher::new(shape, sample_rate_hz),
            done: vec![0.0; shape.window],
            clock: Clock { origin: 0, base: 0, now: 0, latency_samples: latency as i64 },
            traces: Traces::new(shape.levels, sample_rate_hz),
            dynamics: Smoothed::new(DYNAMICS_S, sample_rate_hz / shape.window as f64),
            buzz_guard: BuzzGuard::new(shape.period_samples() / 2, sample_rate_hz),
            shape: *shape,
            schedule,
        };
        texture.reset(0);
        Ok(texture)
    }

    /// Delay of the output in samples: see [`PyramidConfig::latency_samples`].
    pub fn latency_samples(&self) -> usize {
        self.clock.latency_samples as usize
    }

    /// Samples that may sound after the drive has fallen silent, not counting latency: the gate's hold and the frame in
    /// which it closes.
    pub fn tail_samples(&self) -> usize {
        self.clock.latency_samples as usize + 4 * self.shape.period_samples()
    }

    /// Shape of the engine.
    pub fn shape(&self) -> &PyramidConfig {
        &self.shape
    }

    /// Restarts at `position` of the host's timeline, as if after silence. The grid of the windows is a function of the
    /// position.
    pub fn reset(&mut self, position: i64) {
        let origin = position.rem_euclid(self.shape.period_samples() as i64);
        self.start(origin, None);
        self.clock.base = position.wrapping_sub(origin);
    }

    /// Restarts for one signal in padded arrays of these sizes.
    pub(super) fn reset_for_arrays(&mut self, sizes: &[usize], eps: f64) {
        self.start(0, Some(sizes));
        self.matcher.eps = eps;
    }

    fn start(&mut self, origin: i64, sizes: Option<&[usize]>) {
        self.clock.origin = origin;
        self.clock.base = 0;
        self.clock.now = origin;
        self.matcher.eps = 0.0;
        self.drive.pyramid.reset(origin, sizes);
        self.drive.range.reset();
        self.gate.reset();
        self.timeline.reset(TextureControls::default());
        self.traces.reset(origin);
        self.buzz_guard.reset();
        let first_at = |level: usize| (origin + (1 << level) - 1) >> level;
        self.drive.top.reset(first_at(self.shape.top()));
        for (l, level) in self.levels.iter_mut().enumerate() {
            level.reset(origin, first_at(l), sizes.map_or(i64::MAX, |sizes| sizes[l] as i64));
            let w = self.shape.window as i64;
            level.next_window = (first_at(l) + w - 1) / w;
            level.due = level.next_window * self.schedule.period[l] + self.schedule.offset[l];
        }
        self.outputs.reset(origin);
    }

    /// Exchanges the recording of the first slot, as [`swap_slot`](Self::swap_slot) does, if there is no other.
    pub fn swap_dictionary(&mut self, dictionary: Option<Arc<Dictionary>>) -> Option<Arc<Dictionary>> {
        self.swap_slot(0, dictionary, 0.0)
    }

    /// Exchanges the recording of a slot; one of another shape, or for a slot that does not exist, is returned. The
    /// engine continues with the new one. `matched_rms` is the root mean square of the new one's matched signal, by whose
    /// ratio recordings are brought to one scale; 0 leaves them at their own.
    pub fn swap_slot(
        &mut self,
        slot: usize,
        dictionary: Option<Arc<Dictionary>>,
        matched_rms: f64,
    ) -> Option<Arc<Dictionary>> {
        if slot >= SLOTS || dictionary.as_ref().is_some_and(|x| *x.shape() != self.shape) {
            return dictionary;
        }
        for level in &mut self.levels {
            level.last_match = level.last_match.filter(|(of, _)| *of != slot);
        }
        self.recordings.slots.swap(slot, dictionary, matched_rms)
    }

    /// The recordings.
    pub(crate) fn slots(&self) -> &Slots<Dictionary> {
        &self.recordings.slots
    }

    /// Exchanges the learned distribution of the drive.
    pub fn swap_distribution(&mut self, learned: Option<Arc<Distribution>>) -> Option<Arc<Distribution>> {
        std::mem::replace(&mut self.drive.range.learned, learned)
    }

    /// Magnitudes of the drive's top level that arose in the last call of `process`.
    pub fn top_magnitudes(&self) -> &[f64] {
        &self.traces.top_magnitudes
    }

    /// Returns the matches on the level below the top, and the extents of all levels, since they were last returned; at
    /// most 512 of each.
    pub fn take_traces(&mut self) -> (std::vec::Drain<'_, Match>, std::vec::Drain<'_, Extent>) {
        self.traces.drain()
    }

    /// Present degree of mapping of the recording's amplitudes onto the drive's, 0-1: the control's value, reduced by
    /// the buzz.
    pub fn scaling_alpha(&self) -> f64 {
        self.buzz_guard.scaling_alpha
    }

    /// Number of windows and boxes compared since creation.
    pub fn compared(&self) -> u64 {
        self.matcher.compared
    }

    /// Processes `drive` and writes as many samples to every channel of `outputs`, delayed by the latency. `controls`
    /// apply to this call; a window uses those in force at its centre. If `loudness` is given, as long as the drive,
    /// the gate follows it instead of the drive.
    pub fn process(
        &mut self,
        drive: &[f64],
        loudness: Option<&[f64]>,
        controls: &TextureControls,
        outputs: &mut [&mut [f64]],
    ) {
        self.advance(drive, loudness, controls, |made, ready, range| made.sum(ready, range, outputs));
    }

    /// As [`process`](Self::process), but with the synthesized sound of each recording separately: `read` is called to
    /// read the samples from an index on for a range of the block.
    pub(crate) fn advance(
        &mut self,
        drive: &[f64],
        loudness: Option<&[f64]>,
        controls: &TextureControls,
        mut read: impl FnMut(&Outputs, i64, Range<usize>),
    ) {
        self.recordings.slot = controls.recordings.first();
        if self.timeline.end() == 0 {
            self.timeline.reset(*controls);
            self.dynamics.value = within(controls.companding.dynamics, 0.0, 1.0);
        }
        self.timeline.push(*controls, drive.len());
        self.traces.top_magnitudes.clear();
        let mut done = 0;
        while done < drive.len() {
            let due = self.levels.iter().map(|level| level.due).min().unwrap_or(i64::MAX);
            let end = drive.len().min(done + (due - self.clock.now + 1).max(1) as usize);
            for i in done..end {
                if let Some((index, value)) = self.drive.pyramid.push(drive[i]) {
                    self.push_top_sample(index, value, loudness.map(|loudness| loudness[i]));
                }
            }
            let ready = self.clock.now - self.clock.latency_samples;
            let last = ready + (end - done) as i64 - 1;
            (ready..last).for_each(|ready| self.listen(controls.scaling_auto, ready));
            self.clock.now += (end - done) as i64;
            for l in (0..self.shape.top()).rev() {
                if self.levels[l].due == self.clock.now - 1 {
                    self.match_window(l);
                }
            }
            // A window adds nothing to samples that were ready before it was matched, so all of them can be read now.
            read(&self.outputs, ready, done..end);
            self.listen(controls.scaling_auto, last);
            done = end;
        }
        self.buzz_guard.scaling_alpha = controls.scaling_alpha * self.share();
    }

    /// Remaining share of scalingAlpha if it is lowered automatically: none over a recording that is bound to buzz.
    fn share(&self) -> f64 {
        let is_impulsive = self.recordings.slots.get(self.recordings.slot).is_some_and(Dictionary::is_impulsive);
        if is_impulsive && self.buzz_guard.is_listening { 0.0 } else { self.buzz_guard.share() }
    }

    /// Listens for a buzz in the synthesized sample `ready`, if requested.
    fn listen(&mut self, is_asked: bool, ready: i64) {
        if !is_asked {
            self.buzz_guard.stop();
        } else if ready >= self.clock.origin {
            self.buzz_guard.push(self.levels[0].samples.get(ready));
        }
    }

    fn controls_at(&self, sample: i64) -> TextureControls {
        self.timeline.value_at((sample - self.clock.origin).max(0) as u64)
    }

    fn push_top_sample(&mut self, index: i64, value: f64, loudness: Option<f64>) {
        self.drive.top.set(index, value);
        self.traces.extents.add_sample(self.shape.top(), index, value);
        let magnitude = value.abs();
        self.traces.add_magnitude(magnitude);
        self.drive.range.push(magnitude);
        let controls = self.controls_at(index << self.shape.top());
        self.gate.push(index, loudness.unwrap_or(magnitude), controls.gate);
    }
}
