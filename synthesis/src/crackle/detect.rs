//! Detection of the crackles of a recording: sudden, short and broadband sounds.
//!
//! The level above 2 kHz in frames of half a millisecond is compared with its running median. A crackle exceeds it,
//! rises within a few milliseconds, falls again within ten, and covers several octaves. A bird's note or a whistle
//! covers only one; a gust of wind rises slowly, and the median follows it.

use crate::dsp::{Svf, section_gain};

/// Length of a frame in seconds; levels are means over two of them, as long as a crackle takes to rise.
const FRAME_S: f64 = 0.0005;
/// Lowest corner in Hz, and the corners that bound the octaves.
const LOWEST_HZ: f64 = 1000.0;
const CORNERS_HZ: [f64; 3] = [8000.0, 4000.0, 2000.0];
/// Span of the running median in seconds: long compared with a crackle, short compared with a gust.
const MEDIAN_S: f64 = 0.1;
/// Height of a crackle above the median, as a ratio of powers: 11 dB. The largest level of stationary noise in an hour
/// is 6 dB above it.
const THRESHOLD: f64 = 12.6;
/// Height of its octaves, and the smallest number of them: 6 dB in two.
const BAND_THRESHOLD: f64 = 4.0;
const LEAST_BANDS: usize = 2;
/// Ratio by which it rises and falls again, 6 dB; within this many seconds.
const SWING: f64 = 0.25;
const RISE_S: f64 = 0.004;
const FALL_S: f64 = 0.010;
/// Distance in seconds below which two peaks are one crackle: a second one cannot be distinguished from an echo.
const APART_S: f64 = 0.006;
/// Height above the median at which a crackle begins and ends: 4 dB, or 30 dB below its peak.
const EDGE: f64 = 2.5;
const DECAY: f64 = 1e-3;
/// Seconds before its onset that belong to it, and its greatest length.
const LEAD_S: f64 = 0.002;
pub(super) const LONGEST_S: f64 = 0.060;
/// Median, relative to the mean power, below which levels are not compared: -60 dB. Digital silence is not a bed.
const SILENCE: f64 = 1e-6;

/// Position of a crackle in its recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// Its first sample, and the first one after its end.
    pub start: usize,
    pub end: usize,
    /// Height of its peak above the bed at 2 kHz and more, in dB.
    pub over_bed_db: f64,
    /// Level of the bed around it, relative to the recording's usual one, in dB.
    pub bed_db: f64,
}

/// All crackles of `channels`, equally long, in order; none overlap.
pub(super) fn crackles(channels: &[Vec<f64>], sample_rate_hz: f64) -> Vec<Found> {
    let frames = Frames::of_channels(channels, sample_rate_hz);
    let mut peaks = frames.peaks();
    peaks.sort_unstable();
    frames.bounds(&peaks, channels.first().map_or(0, Vec::len))
}

/// Powers of a recording by frames.
struct Frames {
    frame_samples: usize,
    /// Levels by octave, and of all octaves, relative to the running medians.
    bands: Vec<Vec<f64>>,
    ratio: Vec<f64>,
    /// The running medians of all octaves together, and the median of these.
    beds: Vec<f64>,
    usual_bed: f64,
}

impl Frames {
    fn of_channels(channels: &[Vec<f64>], sample_rate_hz: f64) -> Self {
        let frame_samples = ((FRAME_S * sample_rate_hz).round() as usize).max(1);
        let mut bands = band_powers(channels, frame_samples, sample_rate_hz);
        let count = bands.first().map_or(0, Vec::len);
        let mut ratio: Vec<f64> = (0..count).map(|i| bands.iter().map(|band| band[i]).sum()).collect();
        let span = (MEDIAN_S / FRAME_S) as usize / 2;
        bands.iter_mut().for_each(|powers| drop(divide_by_median(powers, span)));
        let beds = divide_by_median(&mut ratio, span);
        let mut sorted = beds.clone();
        sorted.sort_unstable_by(f64::total_cmp);
        let usual_bed = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        Self { frame_samples, bands, ratio, beds, usual_bed }
    }

    fn frames(&self, time_s: f64) -> usize {
        (time_s / FRAME_S).round() as usize
    }

    /// Frames of the crackles' peaks, the highest first.
    fn peaks(&self) -> Vec<usize> {
        let mut candidates: Vec<usize> = (0..self.ratio.len()).filter(|at| self.is_crackle(*at)).collect();
        // The highest first, so that a crackle claims its echoes and not the other way round.
        candidates.sort_by(|a, b| self.ratio[*b].total_cmp(&self.ratio[*a]).then(a.cmp(b)));
        let apart = self.frames(APART_S);
        let mut taken = vec![false; self.ratio.len()];
        let mut peaks = Vec::new();
        for at in candidates {
            if !taken[at] {
                peaks.push(at);
                let end = taken.len().min(at + apart);
                taken[at.saturating_sub(apart - 1)..end].fill(true);
            }
        }
        peaks
    }

    fn is_crackle(&self, at: usize) -> bool {
        let here = self.ratio[at];
        let least = |part: &[f64]| part.iter().fold(f64::INFINITY, |least, x| least.min(*x));
        here > THRESHOLD
            && self.bands.iter().filter(|band| band[at] > BAND_THRESHOLD).count() >= LEAST_BANDS
            && least(&self.ratio[at.saturating_sub(self.frames(RISE_S))..at]) < SWING * here
            && least(&self.ratio[at..self.ratio.len().min(at + self.frames(FALL_S))]) < SWING * here
    }

    /// Start and end of the crackles with these peaks, in order.
    fn bounds(&self, peaks: &[usize], samples: usize) -> Vec<Found> {
        let (lead, longest, quiet) = (self.frames(LEAD_S), self.frames(LONGEST_S), self.frames(RISE_S));
        let onset = |peak: usize| {
            let earliest = peak.saturating_sub(2 * quiet);
            let before = (earliest..peak).rev().take_while(|at| self.ratio[*at] > EDGE).count();
            (peak - before).saturating_sub(lead)
        };
        let mut found = Vec::with_capacity(peaks.len());
        let mut free = 0;
        for (number, peak) in peaks.iter().enumerate() {
            let start = onset(*peak).max(free).min(*peak);
            let next = peaks.get(number + 1).map_or(usize::MAX, |next| onset(*next).max(peak + 1));
            let last = self.ratio.len().min(peak + longest).min(next);
            let least = EDGE.max(DECAY * self.ratio[*peak]);
            let (mut end, mut below) = (peak + 1, 0);
            while end < last && below < quiet {
                below = if self.ratio[end] < least { below + 1 } else { 0 };
                end += 1;
            }
            free = end;
            found.push(Found {
                start: start * self.frame_samples,
                end: (end * self.frame_samples).min(samples),
                over_bed_db: 10.0 * maths::log10(self.ratio[*peak]),
                bed_db: 10.0 * maths::log10(self.beds[*peak] / self.usual_bed),
            });
        }
        found
    }
}

/// Powers of the octaves above 2 kHz, means of the channels over two frames.
fn band_powers(channels: &[Vec<f64>], frame_samples: usize, sample_rate_hz: f64) -> Vec<Vec<f64>> {
    let gain = |hz: f64| section_gain(hz.min(0.45 * sample_rate_hz), sample_rate_hz);
    let lowest = gain(LOWEST_HZ);
    let corners = CORNERS_HZ.map(gain);
    let count = channels.first().map_or(0, Vec::len) / frame_samples;
    let mut powers = vec![vec![0.0; count]; CORNERS_HZ.len()];
    for channel in channels {
        let mut high_pass = [Svf::default(); 2];
        let mut splits = [Svf::default(); CORNERS_HZ.len()];
        for (frame, samples) in channel.chunks_exact(frame_samples).enumerate() {
            for sample in samples {
                let [first, second] = &mut high_pass;
                let mut rest = second.process(lowest, first.process(lowest, *sample).high).high;
                for ((split, gain), powers) in splits.iter_mut().zip(corners).zip(&mut powers) {
                    let bands = split.process(gain, rest);
                    powers[frame] += bands.high * bands.high;
                    rest = bands.low;
                }
            }
        }
    }
    for powers in &mut powers {
        let mut before = 0.0;
        for power in powers.iter_mut() {
            (*power, before) = (0.5 * (*power + before), *power);
        }
    }
    powers
}

/// Divides every power by the median of those around it, `span` to each side; returns these medians, which are positive.
fn divide_by_median(powers: &mut [f64], span: usize) -> Vec<f64> {
    let mean = powers.iter().sum::<f64>() / powers.len().max(1) as f64;
    let floor = (SILENCE * mean).max(f64::MIN_POSITIVE);
    let mut sorted: Vec<f64> = Vec::with_capacity(2 * span + 1);
    let rank = |sorted: &[f64], value: f64| sorted.partition_point(|x| *x < value);
    let original = powers.to_vec();
    let mut medians = Vec::with_capacity(powers.len());
    for value in original.iter().take(span) {
        let at = rank(&sorted, *value);
        sorted.insert(at, *value);
    }
    for (i, power) in powers.iter_mut().enumerate() {
        if let Some(entering) = original.get(i + span) {
            let at = rank(&sorted, *entering);
            sorted.insert(at, *entering);
        }
        if let Some(leaving) = i.checked_sub(span + 1).and_then(|at| original.get(at)) {
            let at = rank(&sorted, *leaving);
            sorted.remove(at);
        }
        let median = sorted[sorted.len() / 2].max(floor);
        *power /= median;
        medians.push(median);
    }
    medians
}
