//! Crackle: the recording's own, played again as the drive burns.
//!
//! Texture makes a stationary sound from a recording. Sudden sounds are separated when the recording is loaded
//! ([`split()`]) and played alongside the texture:
//!
//! ```text
//! recording ── split ── bed ── companded texture ── + ── out
//!                └── crackles ── runs, again ── varied ┘
//! drive's loudness ──────────────── rate, level
//! ```
//!
//! The recording's density is 1. The drive's loudness, relative to its mean so far, raises or lowers it, so that a
//! steady drive of any level gives the recording's density at once. That mean also makes crackles louder or softer by
//! the same amount as texture:
//!
//! ```text
//! density = density control * (loudness / mean)^a                 a = 1.0 * follow
//! level   = mean^c * (loudness / mean)^b           b = 0.5 * follow, c = 0.77 * follow
//! ```
//!
//! | module | content |
//! |---|---|
//! | `detect` | finds crackles |
//! | `background`, `stft` | the spectrum between crackles |
//! | `split` | takes a recording apart |
//! | `event` | crackles ready to be played, and their figures |
//! | `source` | the source of crackles: one of the recordings, or a fuel ([`crate::fuel`]) if it has none |
//! | `schedule` | the times of crackles |
//! | `grain` | a playing crackle |

mod background;
mod detect;
mod event;
mod grain;
mod schedule;
mod share;
mod source;
mod split;
mod stft;

pub use event::{Crackles, Event, Summary};
pub(crate) use event::{Made, Variation};
pub use source::Sources;
pub(crate) use split::is_impulsive;
pub use split::{Split, split};

use crate::controls::CrackleControls;
use crate::dsp::Timeline;
use crate::error::within;
use grain::{Grain, MOST_CHANNELS, Play, tilt_step, value_of};
use schedule::{Due, STREAMS, Schedule};
use source::CrackleSource;

/// Exponents of the drive's loudness in the density and in the level of crackles, if they follow it fully. Twice as much
/// left dB sync unchanged and took the texture farther from the recording (docs/sound.md).
const DENSITY_EXPONENT: f64 = 1.0;
const LEVEL_EXPONENT: f64 = 0.5;
/// The same for that loudness's mean: texture's default, so that the two remain in proportion.
const MEAN_EXPONENT: f64 = 0.77;
/// Largest number of simultaneous crackles; at 100 per second, there are 3.
const GRAINS: usize = 64;
/// Tilt in dB of sharpness 1, and the share of a crackle's decay in which it then falls by 1/e.
const SHARP_DB: f64 = 6.0;
const SHARP_DECAY: f64 = 1.0;
/// Seconds after which the drive's loudness counts 1/e in its mean, and the weight in seconds of a prior mean of 1.
const MEMORY_S: f64 = 30.0;
const PRIOR_S: f64 = 0.5;
/// The loudest relative loudness, and the softest mean: after near silence any sound is relatively loud.
const LOUDEST: f64 = 30.0;
const LEAST_MEAN: f64 = 1e-3;

/// Longest duration of a crackle in seconds, at the slowest rate.
pub(crate) const LONGEST_S: f64 = detect::LONGEST_S * (1.0 + event::MOST_RATE) / (1.0 - event::MOST_RATE);

/// The crackle layer.
#[derive(Debug)]
pub struct Crackle {
    sample_rate_hz: f64,
    tilt_step: f64,
    latency_samples: i64,
    timeline: Timeline<CrackleControls>,
    schedule: Option<Schedule>,
    /// Seed and source of the schedule.
    playing: (u32, CrackleSource),
    grains: Vec<Grain>,
    sums: Vec<Vec<i64>>,
    /// Sum of the drive's loudness so far, and of its weights in samples; both decay by the factor `keep`.
    past_loudness: [f64; 2],
    keep: f64,
    /// Position of the next audible sample of the drive, and samples since reset.
    position: i64,
    now: u64,
}

impl Crackle {
    /// A layer for `channels` of output that come `latency_samples` after the drive. Blocks have up to `block` samples.
    pub fn new(sample_rate_hz: f64, channels: usize, latency_samples: usize, block: usize) -> Self {
        Self {
            sample_rate_hz,
            tilt_step: tilt_step(sample_rate_hz),
            latency_samples: latency_samples as i64,
            timeline: Timeline::new(latency_samples + 1, CrackleControls::default()),
            schedule: None,
            playing: Default::default(),
            grains: vec![Grain::default(); GRAINS],
            sums: vec![vec![0; block]; channels.min(MOST_CHANNELS)],
            past_loudness: [PRIOR_S * sample_rate_hz; 2],
            keep: maths::exp(-1.0 / (MEMORY_S * sample_rate_hz)),
            position: 0,
            now: 0,
        }
    }

    /// Delay of the layer after the drive, in samples.
    pub fn latency_samples(&self) -> usize {
        self.latency_samples as usize
    }

    /// Samples for which it may sound after the drive has fallen silent.
    pub fn tail_samples(&self) -> usize {
        (LONGEST_S * self.sample_rate_hz).ceil() as usize
    }

    /// Resets to silence; the next sample of the drive is at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.timeline.reset(CrackleControls::default());
        self.position = position.wrapping_sub(self.latency_samples);
        self.now = 0;
        self.past_loudness = [PRIOR_S * self.sample_rate_hz; 2];
        self.forget();
    }

    /// Ends the sound of a slot's recording, which no longer exists.
    pub fn forget_slot(&mut self, slot: usize) {
        let is_its = |source: CrackleSource| source == CrackleSource::Recording(slot);
        if is_its(self.playing.1) {
            self.schedule = None;
        }
        self.grains.iter_mut().filter(|grain| is_its(grain.source())).for_each(|grain| *grain = Grain::default());
    }

    /// Ends all sound.
    fn forget(&mut self) {
        self.schedule = None;
        self.grains.fill(Grain::default());
    }

    /// Renders one block of the layer. `loudness` is that of the drive, relative to its overall level, at the audible
    /// samples, which are [`latency_samples`](Self::latency_samples) old; `controls` belong to the samples that enter.
    /// Returns whether anything can sound in it.
    pub fn process(
        &mut self,
        loudness: &[f64],
        controls: &CrackleControls,
        sources: &Sources<'_>,
        outputs: &mut [&mut [f64]],
    ) -> bool {
        let samples = loudness.len();
        if self.timeline.end() == 0 {
            self.timeline.reset(*controls);
        }
        self.timeline.push(*controls, samples);
        outputs.iter_mut().for_each(|output| output.fill(0.0));
        self.sums.iter_mut().for_each(|sums| sums[..samples].fill(0));
        let sounds = self.play(loudness, sources);
        if sounds {
            for (output, sums) in outputs.iter_mut().zip(&self.sums) {
                output.iter_mut().zip(sums).for_each(|(out, sum)| *out = value_of(*sum));
            }
        }
        self.position = self.position.wrapping_add(samples as i64);
        self.now += samples as u64;
        sounds
    }

    /// Plays one block; returns whether anything can sound in it.
    fn play(&mut self, loudness: &[f64], sources: &Sources<'_>) -> bool {
        let mut start = 0;
        let mut sounds = false;
        while start < loudness.len() {
            let entered = (self.now + start as u64).saturating_sub(self.latency_samples as u64);
            let (controls, end) = self.timeline.run_at(entered);
            let until = (end.saturating_sub(entered)).min((loudness.len() - start) as u64) as usize;
            let end = start + until.max(1);
            if let Some((source, crackles)) = sources.choose(&controls) {
                self.update_schedule(start, &controls, source, crackles);
                self.play_run(start, end, &controls, loudness, (source, crackles), sources);
                sounds = true;
            } else if self.grains.iter().any(Grain::is_on) {
                // If a fuel was turned off, crackles that have begun still end by themselves.
                self.add_grains(start, end, sources);
                sounds = true;
            }
            start = end;
        }
        sounds
    }

    /// Restarts the schedule at sample `start` of a block if the seed or the source has changed.
    fn update_schedule(
        &mut self,
        start: usize,
        controls: &CrackleControls,
        source: CrackleSource,
        crackles: &Crackles,
    ) {
        let playing = (controls.seed, source);
        if self.schedule.is_none() || self.playing != playing {
            let position = self.position.wrapping_add(start as i64);
            self.schedule = Some(Schedule::new(controls.seed, crackles, position));
            self.playing = playing;
        }
    }

    /// Plays the samples of a block to which `controls` apply.
    fn play_run(
        &mut self,
        start: usize,
        end: usize,
        controls: &CrackleControls,
        loudness: &[f64],
        playing: (CrackleSource, &Crackles),
        sources: &Sources<'_>,
    ) {
        let mut at = start;
        loop {
            let position = self.position.wrapping_add(at as i64);
            let Some(schedule) = &mut self.schedule else { return };
            let wait = schedule.wait(position).clamp(0, (end - at) as i64) as usize;
            if wait == 0 && at < end {
                if let Some(due) = schedule.next_due(position, playing.1) {
                    self.begin(&due, controls, loudness[at], playing, sources.gain(playing.0));
                }
                continue;
            }
            self.add_grains(at, at + wait, sources);
            self.add_to_mean(&loudness[at..at + wait]);
            at += wait;
            if at >= end {
                return;
            }
        }
    }

    /// Adds the drive's loudness to its mean; silence does not count.
    fn add_to_mean(&mut self, loudness: &[f64]) {
        for loudness in loudness.iter().filter(|loudness| **loudness > 0.0) {
            let [sum, count] = self.past_loudness;
            self.past_loudness = [sum * self.keep + within(*loudness, 0.0, LOUDEST), count * self.keep + 1.0];
        }
    }

    fn add_grains(&mut self, start: usize, end: usize, sources: &Sources<'_>) {
        for grain in self.grains.iter_mut().filter(|grain| grain.is_on()) {
            let mut sums: [&mut [i64]; MOST_CHANNELS] = Default::default();
            let channels = self.sums.len();
            for (part, sums) in sums.iter_mut().zip(&mut self.sums) {
                *part = &mut sums[start..end];
            }
            grain.add(sources, self.tilt_step, &mut sums[..channels]);
        }
    }

    /// Begins a crackle, if the drive is loud enough for it.
    fn begin(
        &mut self,
        due: &Due,
        controls: &CrackleControls,
        loudness: f64,
        (source, crackles): (CrackleSource, &Crackles),
        source_gain: f64,
    ) {
        let [sum, count] = self.past_loudness;
        let mean = (sum / count).max(LEAST_MEAN);
        let loudness = within(loudness, 0.0, LOUDEST) / mean;
        let follow = within(controls.follow, 0.0, 2.0);
        let density = crackles.share(&crackles.events()[due.event])
            * within(controls.density, 0.0, STREAMS as f64)
            * maths::pow(loudness, DENSITY_EXPONENT * follow);
        if loudness <= 0.0 || due.threshold >= density {
            return;
        }
        let Some(grain) = self.grains.iter_mut().find(|grain| !grain.is_on()) else { return };
        let (event, variation) = (&crackles.events()[due.event], crackles.variation());
        let [late, rate, level, tilt, balance, ..] = due.draws;
        let sharpness = within(controls.sharpness, -1.0, 1.0);
        let spread = maths::pow(event.peak / crackles.median_peak(), within(controls.spread, 0.0, 2.0) - 1.0);
        let followed = maths::pow(mean, MEAN_EXPONENT * follow) * maths::pow(loudness, LEVEL_EXPONENT * follow);
        let gain = spread * followed * factor(variation.level_db * level) * source_gain;
        let tilt = factor(variation.tilt_db * tilt + SHARP_DB * sharpness);
        let sides = [factor(variation.balance_db * balance), factor(-variation.balance_db * balance)];
        // The loudest that tilt and balance make of it.
        let loudest = event.peak * tilt.max(1.0 / tilt) * sides[0].max(sides[1]);
        let gain = gain.min(within(controls.highest_peak, 0.0, f64::MAX) / loudest);
        let shortened = sharpness.max(0.0) / (SHARP_DECAY * event.decay_s * self.sample_rate_hz).max(1.0);
        *grain = Grain::start(Play {
            source,
            event: due.event,
            late: 0.5 + 0.5 * late,
            rate: 1.0 + variation.rate * rate,
            low: gain / tilt,
            high: gain * tilt,
            decay: maths::exp(-shortened),
            sides,
        });
    }
}

fn factor(db: f64) -> f64 {
    maths::pow(10.0, db / 20.0)
}
