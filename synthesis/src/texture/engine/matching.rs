//! The match of a window: gate, feature, search, and addition to what has been synthesized.

use super::Texture;
use super::target::{DivCeilShift, Target};
use crate::controls::{Quality, TextureControls};
use crate::dsp::White;
use crate::error::within;
use crate::texture::dictionary::Dictionary;
use crate::texture::feature::WindowPosition;
use crate::texture::search::{Budget, Index};
use crate::texture::slots;
use crate::texture::traces::Match;

/// Limit of continuity: where loudness was removed from a recording, the window that follows the last one in the
/// recording is used if its squared distance is at most this many times the smallest: 1.3 squared. Fewer joins bring
/// texture closer to the recording (docs/sound.md).
const CONTINUITY: f64 = 1.69;

/// Noise streams that no other stage uses, one for each level, and the share of noise in the coarse half of a feature,
/// which describes the drive and must be followed more closely.
const VARIETY_STREAM: u32 = 0x5641_5200;
const COARSE_VARIETY: f64 = 0.5;

impl Texture {
    /// Matches the next window of level `l`, if it is to sound, and adds the match.
    pub(super) fn match_window(&mut self, l: usize) {
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
        let period = self.clock.base.wrapping_add(centre).div_euclid(coarsest.max(1));
        let controls = self.controls_at(centre);
        let late = self.recordings.crossfade_samples * slots::lateness(controls.seed, period);
        let recordings = self.controls_at(centre - late as i64).recordings;
        self.recordings.slots.choose(&recordings, controls.seed, period)
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

    /// Adds the best match for a window from the recording in a slot (§5.2).
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
        let chosen = self.choose(l, slot, dictionary, index, controls.quality);
        if is_mapped && slot == self.recordings.slot {
            let place_s = dictionary.place_s(l, chosen) as f32;
            self.traces.add_match(Match { place_s, magnitude: magnitude as f32, factor: factor as f32 });
        }
        let scale = 1.0 / (factor * own_scale);
        for (factor, hat) in self.matcher.window.iter_mut().zip(&self.matcher.hat) {
            *factor = hat * scale;
        }
        let level = &mut self.levels[l];
        let target = Target {
            from: w * (chosen as i64 - 1),
            to: w * (window - 1),
            floor: level.floor.max(self.clock.origin).div_ceil_shift(l),
            end: level.size,
        };
        target.add(&self.matcher.window, dictionary.level(l), &mut level.samples);
        if l == 0 {
            self.add_to_outputs(slot, dictionary, &target, own_scale, controls.companding.dynamics);
        }
    }

    /// The recording's window for the query: the nearest one, or the one that continues the last match where loudness
    /// was removed from the recording and it is near enough.
    fn choose(&mut self, l: usize, slot: usize, dictionary: &Dictionary, index: &Index, quality: Quality) -> usize {
        let budget = match quality {
            Quality::Exact => Budget::Exact { eps: self.matcher.eps },
            Quality::Bounded { candidates } => Budget::Bounded { candidates },
        };
        let features = dictionary.features(l);
        let level = &mut self.levels[l];
        let next = level.last_match.filter(|(of, _)| *of == slot).map(|(_, window)| window + 1);
        let found = self.matcher.searcher.nearest(index, &features, &self.matcher.query.values, next, budget);
        self.matcher.compared += u64::from(found.compared);
        let may_continue = dictionary.removed_loudness().is_some() && level.run < self.matcher.longest_run[l];
        let distance = |window| features.distance(window, &self.matcher.query.values);
        let is_near = |next: &usize| distance(*next) <= CONTINUITY * distance(found.window);
        let continued = next.filter(|next| may_continue && index.windows().contains(next)).filter(is_near);
        let chosen = continued.unwrap_or(found.window);
        level.run = if next == Some(chosen) { level.run + 1 } else { 0 };
        level.last_match = Some((slot, chosen));
        chosen
    }

    /// Adds a match on the finest level to the output of its recording, at the recording's own scale and with a share
    /// of its own dynamics.
    fn add_to_outputs(&mut self, slot: usize, dictionary: &Dictionary, target: &Target, own_scale: f64, dynamics: f64) {
        if own_scale != 1.0 {
            self.matcher.window.iter_mut().for_each(|factor| *factor *= own_scale);
        }
        if let Some(removed) = dictionary.removed_loudness() {
            let exponent = self.dynamics.next(within(dynamics, 0.0, 1.0));
            let own = removed.gain_at(target.from + self.shape.window as i64, exponent);
            self.matcher.window.iter_mut().for_each(|factor| *factor *= own);
        }
        let channels = self.outputs.channels();
        let end = target.to + self.matcher.window.len() as i64;
        for (channel, output) in self.outputs.channels_mut(slot, end).iter_mut().enumerate() {
            target.add(&self.matcher.window, dictionary.channel(channel, channels), output);
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
        let position = WindowPosition::of_window(window, &self.shape);
        self.matcher.query.gather(&position, (&level.samples, floor.div_ceil_shift(l)), coarser);
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
            true => self.buzz_guard.share(),
            false => 1.0,
        };
        let factor = self.drive.range.factor(mean, controls.scaling_alpha * share, controls.dynamic_range, dictionary);
        coarse.iter_mut().for_each(|x| *x *= factor);
        (mean, factor)
    }
}
