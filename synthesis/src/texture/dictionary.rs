//! A recording prepared for searching: its pyramid, the windows of every level, and an index over them (§5.1-5.2).

use std::io::{self, Read, Write};
use std::ops::Range;

use bitcode::{Decode, Encode};

use super::distribution::{Distribution, Histogram};
use super::feature::{Excerpt, Features};
use super::pyramid::{Pyramid, mirrored};
use super::removed_loudness::RemovedLoudness;
use super::search::Index;
use super::shape::{Padding, PyramidConfig};
use crate::Error;
use crate::bulk::{bulk_fields, read_value, write_value};
use crate::dsp::mean_of;

/// Progress callback: receives the finished share, 0-1, and returns whether to continue.
pub type Progress<'a> = &'a (dyn Fn(f32) -> bool + Sync);

/// The needed part of an array.
#[derive(Debug, Encode, Decode)]
struct LevelSlice {
    #[bitcode(skip)]
    samples: Vec<f64>,
    first: usize,
}

bulk_fields!(LevelSlice: samples);
bulk_fields!(Dictionary: levels, channels, indices, removed);

impl LevelSlice {
    fn new(mut samples: Vec<f64>, needed: &Range<usize>) -> Self {
        samples.truncate(needed.end);
        let first = needed.start.min(samples.len());
        samples.drain(..first);
        samples.shrink_to_fit();
        Self { samples, first }
    }

    fn excerpt(&self) -> Excerpt<'_> {
        Excerpt { samples: &self.samples, first: self.first }
    }
}

/// A recording's windows on all levels below the top, and the index that finds the nearest.
#[derive(Debug, Encode, Decode)]
pub struct Dictionary {
    shape: PyramidConfig,
    sample_rate_hz: f64,
    weights: Vec<f64>,
    unweighted: bool,
    seconds: f64,
    /// Index of the recording's first sample in level 0's array.
    first: usize,
    /// Sources of windows and their features, from the pyramid of the channels' mean.
    levels: Vec<LevelSlice>,
    /// Level 0 of every channel; empty for a recording of one channel, whose mean it is.
    channels: Vec<LevelSlice>,
    /// Index of each level below the top; none if the level has no complete window.
    indices: Vec<Option<Index>>,
    distribution: Distribution,
    prior: Histogram,
    /// Slow loudness that was removed from the recording before, if any.
    removed: Option<RemovedLoudness>,
    /// True if it still contains crackles.
    is_impulsive: bool,
}

impl Dictionary {
    /// Analyses a recording: `channels` equally long (1-10), finite samples at `sample_rate_hz`.
    /// Fails if the recording is too short for the levels, or if `progress` cancels it.
    pub fn new(
        channels: &[Vec<f64>],
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        check(channels, sample_rate_hz, shape)?;
        Self::of_channels(channels.to_vec(), sample_rate_hz, shape, progress)
    }

    /// The same of channels that have been checked, each given up as soon as it is no longer needed: of a recording of many
    /// minutes every copy counts.
    pub(crate) fn of_channels(
        mut channels: Vec<Vec<f64>>,
        sample_rate_hz: f64,
        shape: &PyramidConfig,
        progress: Progress<'_>,
    ) -> Result<Self, Error> {
        let go_on = |done: f32| if progress(done) { Ok(()) } else { Err(Error::Cancelled) };
        go_on(0.0)?;
        let mean = if channels.len() == 1 { channels.remove(0) } else { mean_of(&channels).into_owned() };
        let pyramid = Pyramid::of_recording(mean, shape)?;
        go_on(0.1)?;
        let padding = &pyramid.padding;
        let windows: Vec<Range<usize>> = (0..shape.top()).map(|level| windows(level, shape, padding)).collect();
        let needed = needed(&windows, shape, padding);
        let channels =
            channels.into_iter().map(|channel| LevelSlice::new(mirrored(channel, padding), &needed[0])).collect();
        let distribution = Distribution::from_magnitudes(pyramid.top_magnitudes());
        let weights = shape.weights();
        let mut dictionary = Self {
            shape: *shape,
            sample_rate_hz,
            unweighted: weights.iter().all(|x| *x == 1.0),
            weights,
            prior: Histogram::of_distribution(&distribution),
            distribution,
            seconds: (padding.end[0] - padding.start[0]) as f64 / sample_rate_hz,
            levels: pyramid
                .levels
                .into_iter()
                .zip(&needed)
                .map(|(level, needed)| LevelSlice::new(level, needed))
                .collect(),
            channels,
            indices: Vec::new(),
            first: padding.start[0],
            removed: None,
            is_impulsive: false,
        };
        let done = std::sync::Mutex::new(0.1f32);
        // One after the other, each on all processors: what is needed to build one is a multiple of what it holds.
        let indices = (0..shape.top()).map(|level| {
            let windows = windows[level].clone();
            let step = |part: f32| {
                // Level l has half the windows of level l - 1.
                let share = 0.9 * part * maths::powi(0.5f32, level as i32 + 1);
                let mut done = done.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                *done += share;
                go_on(*done)
            };
            if windows.is_empty() {
                Ok(None)
            } else {
                Index::new(&dictionary.features(level), windows, &step).map(Some)
            }
        });
        dictionary.indices = indices.collect::<Result<_, Error>>()?;
        go_on(1.0)?;
        Ok(dictionary)
    }

    /// Writes the dictionary, for [`read_from`](Self::read_from) in the same build on the same machine: it is a copy of
    /// memory, not a file format.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_to(&self, out: &mut dyn Write) -> io::Result<()> {
        write_value(self, out)
    }

    /// Reads the output of [`write_to`](Self::write_to). `len` is the largest number of bytes: no more memory is used.
    /// The caller must verify that the bytes are complete; damaged ones may give a dictionary that sounds wrong.
    ///
    /// # Errors
    /// The errors of `from`, and [`io::ErrorKind::InvalidData`] if it does not contain a dictionary.
    pub fn read_from(from: &mut dyn Read, len: u64) -> io::Result<Self> {
        read_value(from, &mut { len })
    }

    /// Shape of the dictionary.
    pub fn shape(&self) -> &PyramidConfig {
        &self.shape
    }

    /// Sample rate of the dictionary in Hz.
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Channels of the recording.
    pub fn channels(&self) -> usize {
        self.channels.len().max(1)
    }

    /// Length of the recording in seconds.
    pub fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Approximate number of bytes held.
    pub fn bytes(&self) -> usize {
        let samples: usize = self.levels.iter().chain(&self.channels).map(|kept| kept.samples.len()).sum();
        samples * size_of::<f64>()
            + self.indices.iter().flatten().map(Index::bytes).sum::<usize>()
            + self.removed.as_ref().map_or(0, RemovedLoudness::bytes)
    }

    /// The slow loudness that was removed from the recording before; none for the paper's dynamics.
    pub fn removed_loudness(&self) -> Option<&RemovedLoudness> {
        self.removed.as_ref()
    }

    /// True if the recording still contains crackles, for the paper's dynamics: its amplitudes spread so far that
    /// mapping them onto a drive's lets one window repeat.
    pub fn is_impulsive(&self) -> bool {
        self.is_impulsive
    }

    /// Sets the loudness that was removed from the channels that this was made of.
    pub(crate) fn set_removed_loudness(&mut self, mut removed: RemovedLoudness) {
        removed.set_first(self.first);
        self.removed = Some(removed);
    }

    /// Sets whether the recording still contains crackles.
    pub(crate) fn set_impulsive(&mut self, is_impulsive: bool) {
        self.is_impulsive = is_impulsive;
    }

    /// Distribution of the recording's top level (§5.3).
    pub fn distribution(&self) -> &Distribution {
        &self.distribution
    }

    /// The same distribution as a histogram.
    pub fn histogram(&self) -> &Histogram {
        &self.prior
    }

    /// The index of the windows of `level`, if it has any.
    pub fn index(&self, level: usize) -> Option<&Index> {
        self.indices.get(level)?.as_ref()
    }

    /// The mean of the channels on `level`.
    pub fn level(&self, level: usize) -> Excerpt<'_> {
        self.levels[level].excerpt()
    }

    /// Level 0 of the sound for one of `outputs` channels: the same channel if the recording has as many, the mean for
    /// one output, otherwise the recording's channels in turn.
    pub fn channel(&self, channel: usize, outputs: usize) -> Excerpt<'_> {
        if self.channels.is_empty() || outputs == 1 {
            self.level(0)
        } else {
            self.channels[channel % self.channels.len()].excerpt()
        }
    }

    /// Seconds from the recording's start to the centre of a window of `level`.
    pub fn place_s(&self, level: usize, window: usize) -> f64 {
        let centre = ((self.shape.window * window) << level) as f64;
        (centre - self.first as f64) / self.sample_rate_hz
    }

    /// The features of `level`, which must be below the top.
    pub fn features(&self, level: usize) -> Features<'_> {
        Features {
            fine: self.level(level),
            coarse: self.level(level + 1),
            weights: &self.weights,
            unweighted: self.unweighted,
            shape: &self.shape,
        }
    }
}

/// Checks that a dictionary can be made of a recording.
pub(crate) fn check(channels: &[Vec<f64>], sample_rate_hz: f64, shape: &PyramidConfig) -> Result<(), Error> {
    shape.validate()?;
    crate::error::in_range("channels of the recording", channels.len() as f64, 1.0, 10.0)?;
    crate::error::in_range("sample rate of the recording in Hz", sample_rate_hz, 1000.0, 768_000.0)?;
    for (channel, samples) in channels.iter().enumerate() {
        if samples.len() != channels[0].len() {
            let (found, expected) = (samples.len(), channels[0].len());
            return Err(Error::UnequalChannels { what: "recording", channel, found, expected });
        }
        if let Some(at) = samples.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what: "recording", at });
        }
    }
    Ok(())
}

/// The windows of `level` whose causal half lies within the signal and whose coarse taps lie within the array.
fn windows(level: usize, shape: &PyramidConfig, Padding { size, start, end }: &Padding) -> Range<usize> {
    let (w, reach) = (shape.window, shape.reach());
    let whole = |window: &usize| {
        let centre = window * w;
        let causal = centre >= reach + start[level] && centre - w < end[level];
        let coarse = centre / 2 >= reach && centre / 2 + reach + 1 < size[level + 1];
        causal && coarse
    };
    let all = 0..size[level] / w + 1;
    let first = all.clone().find(whole).unwrap_or(0);
    let count = (first..all.end).take_while(whole).count();
    first..first + count
}

/// The parts of each level's array that the `windows` of all levels and their features read.
fn needed(windows: &[Range<usize>], shape: &PyramidConfig, padding: &Padding) -> Vec<Range<usize>> {
    let (w, reach) = (shape.window, shape.reach());
    let nothing = Range { start: usize::MAX, end: 0 };
    let mut needed = vec![nothing; windows.len() + 1];
    let mut include = |level: usize, part: Range<usize>| {
        let range: &mut Range<usize> = &mut needed[level];
        *range = range.start.min(part.start)..range.end.max(part.end.min(padding.size[level]));
    };
    for (level, windows) in windows.iter().enumerate().filter(|(_, windows)| !windows.is_empty()) {
        let (first, last) = (windows.start * w, (windows.end - 1) * w);
        include(level, first - reach..last + w + 1);
        include(level + 1, first / 2 - reach..last / 2 + reach + 2);
    }
    needed
}
