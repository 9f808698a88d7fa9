//! Synchronized texture synthesis of a stream (§5.2).
//!
//! The same engine serves files and streams. Its samples have the indices of the reference's padded arrays; samples
//! before the start read as zero, and for a signal of known length so do those beyond the end.

use std::ops::Range;
use std::sync::Arc;

use super::buzz::Buzz;
use super::dictionary::Dictionary;
use super::distribution::Distribution;
use super::drive_range::DriveRange;
use super::extents::Extent;
use super::feature::{Excerpt, WindowPosition};
use super::gate::Gate;
use super::output::Outputs;
use super::pyramid::PyramidStream;
use super::schedule::Schedule;
use super::search::{Budget, Searcher};
use super::shape::PyramidConfig;
use super::slots::{self, Slots};
use super::traces::{Match, Traces};
use super::window_feature::WindowFeature;
use crate::Error;
use crate::controls::{Quality, SLOTS, TextureControls};
use crate::dsp::{Ring, Smoothed, Timeline, White};
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

/// The search for a window's match, and its working memory.
#[derive(Debug)]
struct Matcher {
    hat: Vec<f64>,
    /// Relative error allowed to an exact search.
    eps: f64,
    searcher: Searcher,
    /// Feature of the window that is to be matched.
    query: WindowFeature,
    window: Vec<f64>,
    /// Largest number of consecutive windows, by level, that may continue a run although another is nearer.
    longest_run: Vec<usize>,
    /// Number of windows and boxes compared since creation.
    compared: u64,
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

/// Lowers scalingAlpha against a buzz.
#[derive(Debug)]
struct BuzzGuard {
    buzz: Buzz,
    /// True if it has listened for a buzz since the reset.
    is_listening: bool,
    scaling_alpha: f64,
}

/// One level below the top.
#[derive(Debug, Clone)]
struct Level {
    /// Synthesized samples: the mean of the channels.
    samples: Ring,
    /// Next window to match, and when.
    next_window: i64,
    due: i64,
    /// True if the gate skipped the last window.
    closed: bool,
    /// Sample (of level 0) before which this level ignores everything.
    floor: i64,
    /// Array size, for a signal of known length.
    size: i64,
    /// Slot and window of the last match.
    last_match: Option<(usize, usize)>,
    /// Windows in a row that followed one another in the recording.
    run: usize,
}

/// Limit of continuity: where loudness was removed from a recording, the window that follows the last one in the recording is used if its
/// squared distance is at most this many times the smallest: 1.3 squared. Fewer joins bring texture closer to the
/// recording (docs/sound.md).
const CONTINUITY: f64 = 1.69;
/// Number of levels below the top with continuity: runs there remain varied on finer levels, where continuity had no
/// effect.
const CONTINUOUS_LEVELS: usize = 3;
/// Seconds after which a run ends in any case, so that the recording is not played back: without a limit, stretches of
/// 0.4 s were copied.
const LONGEST_RUN_S: f64 = 0.034;
/// Time constant in seconds with which the share of the recording's own dynamics follows its control.
const DYNAMICS_S: f64 = 0.02;

/// Noise streams that no other stage uses, one for each level, and the share of noise in the coarse half of a feature,
/// which describes the drive and must be followed more closely.
const VARIETY_STREAM: u32 = 0x5641_5200;
const COARSE_VARIETY: f64 = 0.5;

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
        let level = |level: usize| Level {
            samples: Ring::new(life(level)),
            next_window: 0,
            due: 0,
            closed: true,
            floor: 0,
            size: i64::MAX,
            last_match: None,
            run: 0,
        };
        let crossfade_samples = slots::CROSSFADE_S * sample_rate_hz;
        let longest_wait = schedule.offset[0] as usize + shape.period_samples() + crossfade_samples.ceil() as usize;
        let longest_run = |level: usize| {
            let windows = (LONGEST_RUN_S * sample_rate_hz) as usize / (shape.window << level);
            if level + CONTINUOUS_LEVELS < shape.top() { 0 } else { windows }
        };
        let mut texture = Self {
            recordings: Recordings { slots: Slots::default(), slot: 0, crossfade_samples },
            drive: Drive {
                range: DriveRange::new(top_rate_hz),
                pyramid: PyramidStream::new(shape),
                top: Ring::new(life(shape.top())),
            },
            levels: (0..shape.top()).map(level).collect(),
            outputs: Outputs::new(channels, life(0)),
            gate: Gate::new(latency.div_ceil(1 << shape.top())),
            timeline: Timeline::new(longest_wait, TextureControls::default()),
            matcher: Matcher {
                hat: shape.hat(),
                eps: 0.0,
                searcher: Searcher::new(),
                query: WindowFeature::new(shape),
                window: vec![0.0; shape.hat().len()],
                longest_run: (0..shape.top()).map(longest_run).collect(),
                compared: 0,
            },
            done: vec![0.0; shape.window],
            clock: Clock { origin: 0, base: 0, now: 0, latency_samples: latency as i64 },
            traces: Traces::new(shape.levels, sample_rate_hz),
            dynamics: Smoothed::new(DYNAMICS_S, sample_rate_hz / shape.window as f64),
            buzz_guard: BuzzGuard {
                buzz: Buzz::new(shape.period_samples() / 2, sample_rate_hz),
                is_listening: false,
                scaling_alpha: 0.0,
            },
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
        self.buzz_guard.buzz.reset();
        self.buzz_guard.is_listening = false;
        self.buzz_guard.scaling_alpha = 0.0;
        let first_at = |level: usize| (origin + (1 << level) - 1) >> level;
        self.drive.top.reset(first_at(self.shape.top()));
        for (l, level) in self.levels.iter_mut().enumerate() {
            level.samples.reset(first_at(l));
            let w = self.shape.window as i64;
            level.next_window = (first_at(l) + w - 1) / w;
            level.due = level.next_window * self.schedule.period[l] + self.schedule.offset[l];
            level.closed = true;
            level.floor = origin;
            level.size = sizes.map_or(i64::MAX, |sizes| sizes[l] as i64);
            level.last_match = None;
            level.run = 0;
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
        if is_impulsive && self.buzz_guard.is_listening { 0.0 } else { self.buzz_guard.buzz.share() }
    }

    /// Listens for a buzz in the synthesized sample `ready`, if requested.
    fn listen(&mut self, is_asked: bool, ready: i64) {
        if is_asked && ready >= self.clock.origin {
            self.buzz_guard.is_listening = true;
            self.buzz_guard.buzz.push(self.levels[0].samples.get(ready));
        } else if !is_asked && self.buzz_guard.is_listening {
            self.buzz_guard.is_listening = false;
            self.buzz_guard.buzz.reset();
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

    /// Matches the next window of level `l`, if it is to sound, and adds the match.
    fn match_window(&mut self, l: usize) {
        let w = self.shape.window as i64;
        let level = &mut self.levels[l];
        let window = level.next_window;
        level.next_window += 1;
        level.due += self.schedule.period[l];
        let centre = window * w;
        let end = (centre + w + 1).min(level.size);
        level.samples.prepare(end);
        if l == 0 {
            self.outputs.prepare(end);
        }
        if centre > level.size {
            return;
        }
        if self.passes_gate(l, centre) {
            let slot = self.slot_of(centre << l);
            if let Some(dictionary) = self.recordings.slots.take_out(slot) {
                self.synthesize(l, window, slot, &dictionary);
                self.recordings.slots.put_back(slot, dictionary);
            }
        }
        // The next window begins with a weight of 0 at this one's centre, so samples up to there are complete.
        let done = &mut self.done[..w as usize];
        self.levels[l].samples.copy(centre - w + 1, i64::MIN, done);
        self.traces.extents.add_samples(l, centre - w + 1, done);
    }

    /// The slot of the window whose centre is at this sample: the same for all windows over one window of the level
    /// below the top.
    fn slot_of(&self, centre: i64) -> usize {
        let coarsest = self.shape.period_samples() as i64 / 2;
        let place = self.clock.base.wrapping_add(centre).div_euclid(coarsest.max(1));
        let controls = self.controls_at(centre);
        let late = self.recordings.crossfade_samples * slots::lateness(controls.seed, place);
        let recordings = self.controls_at(centre - late as i64).recordings;
        self.recordings.slots.choose(&recordings, controls.seed, place)
    }

    /// Returns whether the gate passes; at an opening, the level forgets everything before.
    fn passes_gate(&mut self, l: usize, centre: i64) -> bool {
        let frame_samples = self.shape.period_samples() as i64;
        let frame = (centre << l) / frame_samples;
        let start = frame * frame_samples;
        let threshold = self.controls_at(start).gate;
        if l + 1 == self.shape.top() {
            self.gate.decide(frame, start >> self.shape.top(), threshold);
        }
        let level = &mut self.levels[l];
        if !self.gate.is_open(frame) {
            level.closed = true;
        } else if level.closed {
            level.closed = false;
            level.floor = start.max(self.clock.origin);
            level.last_match = None;
        }
        !level.closed
    }

    fn synthesize(&mut self, l: usize, window: i64, slot: usize, dictionary: &Dictionary) {
        let Some(index) = dictionary.index(l) else { return };
        let w = self.shape.window as i64;
        let controls = self.controls_at((window * w) << l);
        self.gather(l, window);
        self.vary(l, window, &controls);
        let own_scale = self.recordings.slots.scale(slot);
        self.matcher.query.scale(own_scale);
        let is_mapped = l + 1 == self.shape.top();
        let (magnitude, factor) = if is_mapped { self.map_dynamic_range(&controls, dictionary) } else { (0.0, 1.0) };
        let budget = match controls.quality {
            Quality::Exact => Budget::Exact { eps: self.matcher.eps },
            Quality::Bounded { candidates } => Budget::Bounded { candidates },
        };
        let features = dictionary.features(l);
        let hint = self.levels[l].last_match.filter(|(of, _)| *of == slot).map(|(_, window)| window + 1);
        let answer = self.matcher.searcher.nearest(index, &features, &self.matcher.query.values, hint, budget);
        self.matcher.compared += u64::from(answer.compared);
        let goes_on = || {
            let next =
                hint.filter(|next| index.windows().contains(next) && self.levels[l].run < self.matcher.longest_run[l])?;
            let limit = CONTINUITY * features.distance(answer.window, &self.matcher.query.values);
            (features.distance(next, &self.matcher.query.values) <= limit).then_some(next)
        };
        let removed = dictionary.removed_loudness();
        let chosen = removed.and_then(|_| goes_on()).unwrap_or(answer.window);
        let level = &mut self.levels[l];
        level.run = if hint == Some(chosen) { level.run + 1 } else { 0 };
        level.last_match = Some((slot, chosen));

        if is_mapped && slot == self.recordings.slot {
            let place_s = dictionary.place_s(l, chosen) as f32;
            self.traces.add_match(Match { place_s, magnitude: magnitude as f32, factor: factor as f32 });
        }

        let scale = 1.0 / (factor * own_scale);
        for (factor, hat) in self.matcher.window.iter_mut().zip(&self.matcher.hat) {
            *factor = hat * scale;
        }
        let target = Target {
            from: w * (chosen as i64 - 1),
            to: w * (window - 1),
            floor: level.floor.max(self.clock.origin).div_ceil_shift(l),
            end: level.size,
        };
        target.add(&self.matcher.window, dictionary.level(l), &mut level.samples);
        if l == 0 {
            if own_scale != 1.0 {
                self.matcher.window.iter_mut().for_each(|factor| *factor *= own_scale);
            }
            if let Some(removed) = removed {
                let exponent = self.dynamics.next(within(controls.companding.dynamics, 0.0, 1.0));
                let own = removed.gain_at(w * chosen as i64, exponent);
                self.matcher.window.iter_mut().for_each(|factor| *factor *= own);
            }
            let channels = self.outputs.channels();
            let end = target.to + self.matcher.window.len() as i64;
            for (channel, output) in self.outputs.channels_mut(slot, end).iter_mut().enumerate() {
                target.add(&self.matcher.window, dictionary.channel(channel, channels), output);
            }
        }
    }

    /// Collects the window's feature.
    fn gather(&mut self, l: usize, window: i64) {
        let level = &self.levels[l];
        let floor = level.floor;
        let coarser = match self.levels.get(l + 1) {
            Some(coarser) => (&coarser.samples, floor.div_ceil_shift(l + 1)),
            None => (&self.drive.top, self.clock.origin.div_ceil_shift(l + 1)),
        };
        let place = WindowPosition::of_window(window, &self.shape);
        self.matcher.query.gather(&place, (&level.samples, floor.div_ceil_shift(l)), coarser);
    }

    /// Adds noise to `query`, so that another seed finds another window of the same kind.
    fn vary(&mut self, l: usize, window: i64, controls: &TextureControls) {
        let variety = within(controls.variety, 0.0, 1.0);
        if variety == 0.0 {
            return;
        }
        let noise = White::new(controls.seed, VARIETY_STREAM + l as u32);
        let mut position = window.wrapping_mul(self.matcher.query.values.len() as i64);
        let (causal, coarse) = self.matcher.query.halves();
        for (part, share) in [(causal, 1.0), (coarse, COARSE_VARIETY)] {
            let power = part.iter().map(|x| x * x).sum::<f64>() / part.len().max(1) as f64;
            let level = variety * share * power.sqrt();
            for x in part {
                *x += level * noise.sample_at(position);
                position = position.wrapping_add(1);
            }
        }
    }

    /// Maps the coarse half of `query` into the recording's range (§5.3); returns its mean magnitude, and the factor by
    /// which the match is divided.
    fn map_dynamic_range(&mut self, controls: &TextureControls, dictionary: &Dictionary) -> (f64, f64) {
        let (_, coarse) = self.matcher.query.halves();
        let mean = coarse.iter().map(|x| x.abs()).sum::<f64>() / coarse.len() as f64;
        let share = match controls.scaling_auto {
            true if dictionary.is_impulsive() => 0.0,
            true => self.buzz_guard.buzz.share(),
            false => 1.0,
        };
        let factor = self.drive.range.factor(mean, controls.scaling_alpha * share, controls.dynamic_range, dictionary);
        coarse.iter_mut().for_each(|x| *x *= factor);
        (mean, factor)
    }
}

/// Destination of a matched window.
struct Target {
    /// First sample of the recording's window; may lie outside its array.
    from: i64,
    /// First destination sample; may lie outside the array.
    to: i64,
    /// First sample that may be written, and one past the last.
    floor: i64,
    end: i64,
}

impl Target {
    fn add(&self, factors: &[f64], recording: Excerpt<'_>, ring: &mut Ring) {
        let from = self.from - recording.first as i64;
        let first = (self.floor - self.to).max(-from).max(0);
        let end = self.end.saturating_sub(self.to).min(recording.samples.len() as i64 - from).min(factors.len() as i64);
        if first < end {
            let samples = &recording.samples[(from + first) as usize..];
            ring.add_products(self.to + first, &factors[first as usize..end as usize], samples);
        }
    }
}

/// Rounding up when an index goes down levels.
trait DivCeilShift {
    fn div_ceil_shift(self, levels: usize) -> i64;
}

impl DivCeilShift for i64 {
    fn div_ceil_shift(self, levels: usize) -> i64 {
        (self + (1 << levels) - 1) >> levels
    }
}
