//! Crackles of a recording or of a fuel, ready to play.

use bitcode::{Decode, Encode};

use super::detect::Found;
use crate::bulk::bulk_fields;

/// Height above the bed in dB, and rate per second, from which crackles count as audible: softer or rarer ones are made
/// by texture itself.
const LOUD_DB: f64 = 20.0;
const LEAST_LOUD_PER_S: f64 = 1.0;
const LEAST: usize = 4;
/// Heights above the bed in dB between which crackles are left out if too many are loud: those just below become loud over
/// an even bed. The loudest carry the recording's contrast, and the softer ones its rate.
const BORDERLINE_DB: [f64; 2] = [17.0, 26.0];
/// Average number of crackles in a run, within which order and gaps are preserved; and the limits of a run's length in
/// seconds.
const RUN_CRACKLES: f64 = 6.0;
const RUN_S: [f64; 2] = [0.1, 1.0];
/// Most by which a soft crackle from a quiet passage is raised, in dB. Its own bed was softer than the usual one, which
/// covers it: played as it was recorded, it would leave a gap.
const MOST_RAISED_DB: f64 = 6.0;
/// Fade at the ends of a wave, in seconds.
const FADE_S: f64 = 0.0005;
/// Fall of the level at which a crackle has decayed: 10 dB, as an amplitude.
const DECAYED: f64 = 0.316;

/// One crackle.
#[derive(Debug, Clone, Copy, PartialEq, Encode, Decode)]
pub struct Event {
    /// Its first sample in the recording.
    pub onset: usize,
    /// Its length in samples.
    pub len: usize,
    /// Its largest magnitude in any channel.
    pub peak: f64,
    /// Height above the bed at 2 kHz and more, in dB.
    pub over_bed_db: f64,
    /// Centroid frequency of its energy, in Hz.
    pub centroid_hz: f64,
    /// Time in seconds in which it falls by 10 dB.
    pub decay_s: f64,
    /// Index of its first channel's coefficients.
    first: usize,
}

/// Overall character of a recording's crackles.
#[derive(Debug, Clone, Copy, PartialEq, Encode, Decode)]
pub struct Summary {
    /// Crackles a second.
    pub per_second: f64,
    /// Median height above the bed at 2 kHz and more, in dB.
    pub over_bed_db: f64,
    /// Coefficient of variation of the gaps between them: 1 for random times, more for bursts.
    pub gap_variation: f64,
    /// Median centroid in Hz.
    pub centroid_hz: f64,
    /// Median decay in seconds.
    pub decay_s: f64,
}

/// Greatest deviation of a crackle each time that it is played, to both sides.
#[derive(Debug, Clone, Copy, PartialEq, Encode, Decode)]
pub(crate) struct Variation {
    /// Level in dB.
    pub level_db: f64,
    /// Playback rate, as a share of 1.
    pub rate: f64,
    /// Spectral tilt in dB.
    pub tilt_db: f64,
    /// Balance of two channels in dB.
    pub balance_db: f64,
}

impl Variation {
    /// Variation of recorded crackles: enough that none is recognised as a repeat, too little to change their
    /// character.
    pub const RECORDED: Self = Self { level_db: 1.5, rate: MOST_RATE, tilt_db: 1.0, balance_db: 1.5 };
}

/// Largest variation of the rate of a recorded crackle; a shorter one may vary further.
pub(super) const MOST_RATE: f64 = 0.03;

/// A synthetic crackle.
#[derive(Debug, Clone)]
pub(crate) struct Made {
    /// First sample on the common time axis.
    pub onset: usize,
    /// Height over the softest in dB.
    pub over_softest_db: f64,
    /// Its wave, in one channel; not silent.
    pub wave: Vec<f64>,
}

/// All crackles of a recording in order, and the runs into which its time is divided.
#[derive(Debug, Clone, Encode, Decode)]
pub struct Crackles {
    events: Vec<Event>,
    /// Cubic B-spline coefficients, event by event, channel by channel, [`PADDING`] more on both sides.
    #[bitcode(skip)]
    waves: Vec<f32>,
    channels: usize,
    run_samples: usize,
    /// The first event of every run, and the number of events.
    runs: Vec<u32>,
    /// Median of the peaks.
    median_peak: f64,
    /// Loud crackles a second in the recording.
    loud_per_s: f64,
    /// Share of the borderline crackles that is played at density 1.
    share: f64,
    variation: Variation,
    summary: Summary,
}

bulk_fields!(Crackles: waves);

/// Coefficients on both sides of a wave, in which its spline ends.
pub(super) const PADDING: usize = 4;

impl Crackles {
    /// True if the crackles found in a recording are audible as such.
    pub(super) fn are_audible(found: &[Found], samples: usize, sample_rate_hz: f64) -> bool {
        let seconds = samples as f64 / sample_rate_hz;
        let loud = loud(found);
        loud >= LEAST && loud as f64 > LEAST_LOUD_PER_S * seconds
    }

    /// Cuts the crackles `found` out of `waves`, the parts that exceed the bed by channel.
    pub(super) fn new(found: &[Found], waves: &[Vec<f64>], sample_rate_hz: f64) -> Self {
        let samples = waves.first().map_or(0, Vec::len);
        let mut all = Self::empty(waves.len(), Variation::RECORDED);
        all.loud_per_s = loud(found) as f64 * sample_rate_hz / samples.max(1) as f64;
        for crackle in found {
            all.cut(crackle, waves, sample_rate_hz);
        }
        all.finish(samples, sample_rate_hz);
        all
    }

    /// Collects synthetic crackles, in order of their onsets, which are below `samples`.
    pub(crate) fn made(made: Vec<Made>, samples: usize, variation: Variation, sample_rate_hz: f64) -> Self {
        let mut all = Self::empty(1, variation);
        for Made { onset, over_softest_db, wave } in made {
            all.push(onset, over_softest_db, &[wave], sample_rate_hz);
        }
        all.finish(samples, sample_rate_hz);
        all
    }

    fn empty(channels: usize, variation: Variation) -> Self {
        Self {
            events: Vec::new(),
            waves: Vec::new(),
            channels,
            run_samples: 1,
            runs: Vec::new(),
            median_peak: 0.0,
            loud_per_s: 0.0,
            share: 1.0,
            variation,
            summary: Summary { per_second: 0.0, over_bed_db: 0.0, gap_variation: 0.0, centroid_hz: 0.0, decay_s: 0.0 },
        }
    }

    fn finish(&mut self, samples: usize, sample_rate_hz: f64) {
        self.arrange(samples, sample_rate_hz);
        self.summary = self.summarise(samples as f64 / sample_rate_hz, sample_rate_hz);
        self.median_peak = median(self.events.iter().map(|event| event.peak));
    }

    /// Crackles per second that are far above the bed.
    pub(super) fn loud_per_s(&self) -> f64 {
        self.loud_per_s
    }

    /// Sets the share of the borderline crackles, 0-1, that is played at density 1.
    pub(super) fn set_share(&mut self, share: f64) {
        self.share = share;
    }

    /// Share of the crackles of this event's height that is played at density 1.
    pub(super) fn share(&self, event: &Event) -> f64 {
        let [least, most] = BORDERLINE_DB;
        if (least..most).contains(&event.over_bed_db) { self.share } else { 1.0 }
    }

    /// Greatest deviation of a crackle each time that it is played.
    pub(super) fn variation(&self) -> Variation {
        self.variation
    }

    fn cut(&mut self, crackle: &Found, waves: &[Vec<f64>], sample_rate_hz: f64) {
        let fade = (FADE_S * sample_rate_hz).max(1.0);
        let len = crackle.end - crackle.start;
        let raised = maths::pow(10.0, raised_db(crackle) / 20.0);
        let weight = |i: usize| raised * ((i as f64 + 0.5) / fade).min((len as f64 - i as f64 - 0.5) / fade).min(1.0);
        let parts: Vec<Vec<f64>> = waves
            .iter()
            .map(|wave| wave[crackle.start..crackle.end].iter().enumerate().map(|(i, x)| weight(i) * x).collect())
            .collect();
        self.push(crackle.start, crackle.over_bed_db, &parts, sample_rate_hz);
    }

    /// Adds a crackle whose wave is `parts`, by channel, unless it is silent.
    fn push(&mut self, onset: usize, over_bed_db: f64, parts: &[Vec<f64>], sample_rate_hz: f64) {
        let peak = parts.iter().flatten().fold(0.0f64, |most, x| most.max(x.abs()));
        if peak <= 0.0 {
            return;
        }
        let first = self.waves.len();
        for part in parts {
            self.waves.extend(coefficients(part).iter().map(|x| *x as f32));
        }
        self.events.push(Event {
            onset,
            len: parts.first().map_or(0, Vec::len),
            peak,
            over_bed_db,
            centroid_hz: centroid_hz(parts, sample_rate_hz),
            decay_s: decay_s(parts, sample_rate_hz),
            first,
        });
    }

    /// Cuts the recording's time into runs of equal length.
    fn arrange(&mut self, samples: usize, sample_rate_hz: f64) {
        let seconds = samples as f64 / sample_rate_hz;
        let run_s = (RUN_CRACKLES * seconds / self.events.len().max(1) as f64).clamp(RUN_S[0], RUN_S[1]);
        let count = (seconds / run_s).floor().max(1.0) as usize;
        self.run_samples = samples.div_ceil(count).max(1);
        let first = |run: usize| self.events.partition_point(|event| event.onset < run * self.run_samples) as u32;
        self.runs = (0..=count).map(first).collect();
    }

    fn summarise(&self, seconds: f64, sample_rate_hz: f64) -> Summary {
        let gaps: Vec<f64> =
            self.events.windows(2).map(|pair| (pair[1].onset - pair[0].onset) as f64 / sample_rate_hz).collect();
        let count = gaps.len().max(1) as f64;
        let mean = gaps.iter().sum::<f64>() / count;
        let variance = gaps.iter().map(|gap| maths::square(gap - mean)).sum::<f64>() / count;
        Summary {
            per_second: self.events.len() as f64 / seconds.max(1e-9),
            over_bed_db: median(self.events.iter().map(|event| event.over_bed_db)),
            gap_variation: if mean > 0.0 { variance.sqrt() / mean } else { 0.0 },
            centroid_hz: median(self.events.iter().map(|event| event.centroid_hz)),
            decay_s: median(self.events.iter().map(|event| event.decay_s)),
        }
    }

    /// The crackles, in order.
    pub fn events(&self) -> &[Event] {
        &self.events
    }

    /// Character of the crackles.
    pub fn summary(&self) -> Summary {
        self.summary
    }

    /// Channels of their waves.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Runs that the recording's time is cut into, 1 or more, and the length of each in samples.
    pub(super) fn runs(&self) -> (usize, usize) {
        (self.runs.len() - 1, self.run_samples)
    }

    /// The events of a run.
    pub(super) fn run(&self, run: usize) -> std::ops::Range<usize> {
        self.runs[run] as usize..self.runs[run + 1] as usize
    }

    /// The median of all peaks.
    pub(super) fn median_peak(&self) -> f64 {
        self.median_peak
    }

    /// Coefficients of one channel of an event, the first [`PADDING`] before its first sample.
    pub(super) fn wave(&self, event: &Event, channel: usize) -> &[f32] {
        let stride = event.len + 2 * PADDING;
        &self.waves[event.first + channel * stride..][..stride]
    }

    /// Approximate number of bytes held.
    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&*self.waves) + size_of_val(&*self.events) + size_of_val(&*self.runs)
    }
}

/// Gain in dB with which a crackle is as far above the usual bed as it was above its own, unless that made it loud.
fn raised_db(crackle: &Found) -> f64 {
    (-crackle.bed_db).min(LOUD_DB - crackle.over_bed_db).clamp(0.0, MOST_RAISED_DB)
}

/// Number of loud crackles.
pub(super) fn loud(found: &[Found]) -> usize {
    found.iter().filter(|crackle| crackle.over_bed_db > LOUD_DB).count()
}

/// Coefficients of the cubic B-spline through `samples`, which are surrounded by silence (Unser, Aldroubi & Eden 1993:
/// one causal and one anti-causal recursion with the pole sqrt(3) - 2).
fn coefficients(samples: &[f64]) -> Vec<f64> {
    let pole = 3f64.sqrt() - 2.0;
    let mut values = vec![0.0; samples.len() + 2 * PADDING];
    values[PADDING..PADDING + samples.len()].copy_from_slice(samples);
    let mut state = 0.0;
    for value in &mut values {
        state = 6.0 * *value + pole * state;
        *value = state;
    }
    // Beyond the end, the causal recursion decays by the pole in every step.
    state *= -pole * pole / (1.0 - pole * pole);
    for value in values.iter_mut().rev() {
        state = pole * (state - *value);
        *value = state;
    }
    values
}

/// The root of the mean squared frequency, each weighted by its power: that of the differences over that of the samples.
fn centroid_hz(parts: &[Vec<f64>], sample_rate_hz: f64) -> f64 {
    let energy: f64 = parts.iter().flatten().map(|x| x * x).sum();
    let steps: f64 = parts.iter().flat_map(|part| part.windows(2)).map(|pair| maths::square(pair[1] - pair[0])).sum();
    let sine = (0.5 * (steps / energy.max(f64::MIN_POSITIVE)).sqrt()).min(1.0);
    maths::asin(sine) * sample_rate_hz / std::f64::consts::PI
}

/// Time from the peak until the envelope stays 10 dB below it.
fn decay_s(parts: &[Vec<f64>], sample_rate_hz: f64) -> f64 {
    let len = parts.first().map_or(0, Vec::len);
    let magnitude = |i: usize| parts.iter().fold(0.0f64, |most, part| most.max(part[i].abs()));
    let peak = (0..len).max_by(|a, b| magnitude(*a).total_cmp(&magnitude(*b))).unwrap_or(0);
    let last = (peak..len).rev().find(|i| magnitude(*i) > DECAYED * magnitude(peak)).unwrap_or(peak);
    (last + 1 - peak) as f64 / sample_rate_hz
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut sorted: Vec<f64> = values.collect();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}
