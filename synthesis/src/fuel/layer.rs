//! One layer of noise.

use super::octave::Octave;
use super::recipe::NoiseKind;
use crate::controls::FuelControls;
use crate::dsp::{Smoothed, Timeline};
use crate::error::within;

/// Largest number of channels of any bus: those of 7.1.2.
const MOST_CHANNELS: usize = 10;
/// Seconds, in addition to the latency, after which a layer that was turned off has fallen silent.
const HOLD_S: f64 = 0.25;
/// Time constant in seconds with which the tone follows its controls.
const TONE_S: f64 = 0.02;
/// Loudness, relative to the drive's level, below which a layer fades out however little it follows: -34 dB.
const FAINT: f64 = 0.02;
/// The loudest relative loudness: after near silence any sound is relatively loud, and must not be boosted without limit.
const LOUDEST: f64 = 30.0;
/// Streams of white noise for each octave, and the first of those for unevenness.
const STREAMS: u32 = 16;
const FLUTTER_STREAM: u32 = 256;

/// Inputs of a block.
pub(super) struct Run<'a> {
    pub timeline: &'a Timeline<FuelControls>,
    /// The latency in samples, and the samples since reset.
    pub late: u64,
    pub now: u64,
    pub loudness: &'a [f64],
}

impl Run<'_> {
    /// Controls that apply from sample `start` of the block on, and the sample up to which they apply.
    fn controls(&self, start: usize) -> (FuelControls, usize) {
        let entered = (self.now + start as u64).saturating_sub(self.late);
        let (controls, end) = self.timeline.run_at(entered);
        let samples = end.saturating_sub(entered).clamp(1, (self.loudness.len() - start) as u64);
        (controls, start + samples as usize)
    }
}

/// One of the layers.
#[derive(Debug)]
pub(super) struct Layer {
    kind: NoiseKind,
    octaves: Vec<Octave>,
    /// Middles of the octaves in Hz.
    middles_hz: Vec<f64>,
    weights: Vec<Smoothed>,
    targets: Vec<f64>,
    flutters: [Octave; 2],
    /// Samples for which it continues after it was turned off, and the number left.
    hold_samples: usize,
    left_samples: usize,
}

impl Layer {
    /// A layer that is off, for `channels` of output that come `latency_samples` after the controls.
    pub fn new(kind: NoiseKind, channels: usize, latency_samples: usize, sample_rate_hz: f64) -> Self {
        let (recipe, channels) = (kind.recipe(), channels.min(MOST_CHANNELS));
        // Octaves too high for the sample rate are left out, except for the lowest.
        let holds = |hz: &&f64| **hz <= 0.24 * sample_rate_hz || **hz == recipe.octaves_hz[0];
        let middles_hz: Vec<f64> = recipe.octaves_hz.iter().filter(holds).copied().collect();
        let octave = |(number, hz): (usize, &f64)| {
            Octave::new(*hz, recipe.common, channels, recipe.stream + STREAMS * number as u32, sample_rate_hz)
        };
        let flutter = |number: usize| {
            let stream = recipe.stream + FLUTTER_STREAM + STREAMS * number as u32;
            Octave::smooth(recipe.flutter_hz[number], stream, sample_rate_hz)
        };
        Self {
            kind,
            octaves: middles_hz.iter().enumerate().map(octave).collect(),
            weights: vec![Smoothed::new(TONE_S, sample_rate_hz); middles_hz.len()],
            targets: vec![0.0; middles_hz.len()],
            middles_hz,
            flutters: [flutter(0), flutter(1)],
            hold_samples: latency_samples + (HOLD_S * sample_rate_hz) as usize,
            left_samples: 0,
        }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.left_samples = 0;
    }

    /// Renders one block, whose first sample is heard at `position`. A layer that has been off for long is skipped.
    pub fn process(&mut self, run: &Run<'_>, position: i64, is_on: bool, outputs: &mut [&mut [f64]]) {
        let samples = run.loudness.len();
        let is_fresh = self.left_samples == 0;
        if is_on {
            self.left_samples = samples + self.hold_samples;
        }
        let made = samples.min(self.left_samples);
        self.left_samples -= made;
        outputs.iter_mut().for_each(|output| output[made..].fill(0.0));
        let mut start = 0;
        while start < made {
            let (controls, end) = run.controls(start);
            self.aim(&controls, is_fresh && start == 0);
            let end = end.min(made);
            self.make(&controls, start..end, run.loudness, position, outputs);
            start = end;
        }
    }

    /// Starts moving towards the spectrum of `controls`; a fresh layer has it at once.
    fn aim(&mut self, controls: &FuelControls, is_fresh: bool) {
        let (hump_hz, rms) = self.kind.hump(controls);
        let [rise, fall] = self.kind.recipe().slopes;
        for (target, middle_hz) in self.targets.iter_mut().zip(&self.middles_hz) {
            let ratio = middle_hz / hump_hz;
            *target = maths::pow(ratio, if ratio < 1.0 { rise } else { fall });
        }
        // Octaves are independent, so that powers add.
        let power: f64 = self.targets.iter().map(|target| target * target).sum();
        let scale = rms / power.sqrt().max(f64::MIN_POSITIVE);
        for (target, weight) in self.targets.iter_mut().zip(&mut self.weights) {
            *target *= scale;
            if is_fresh {
                weight.value = *target;
            }
        }
    }

    fn make(
        &mut self,
        controls: &FuelControls,
        range: std::ops::Range<usize>,
        loudness: &[f64],
        position: i64,
        outputs: &mut [&mut [f64]],
    ) {
        let depth = self.kind.flutter_nepers(controls);
        let exponent = self.kind.recipe().exponent * within(controls.follow, 0.0, 2.0);
        let channels = outputs.len().min(MOST_CHANNELS);
        for i in range {
            let mut sums = [0.0; MOST_CHANNELS];
            let level = level_of(loudness[i], exponent);
            let at = position.wrapping_add(i as i64);
            let uneven = if level > 0.0 && depth > 0.0 { self.uneven(controls.seed, at, depth) } else { 1.0 };
            for ((octave, weight), target) in self.octaves.iter_mut().zip(&mut self.weights).zip(&self.targets) {
                let weight = weight.next(*target);
                if level > 0.0 {
                    octave.add(controls.seed, at, weight, &mut sums[..channels]);
                }
            }
            for (output, sum) in outputs.iter_mut().zip(sums) {
                output[i] = sum * level * uneven;
            }
        }
    }

    /// A factor whose mean square is 1.
    fn uneven(&mut self, seed: u32, position: i64, depth: f64) -> f64 {
        let [slow, fast] = &mut self.flutters;
        let nepers =
            depth * std::f64::consts::FRAC_1_SQRT_2 * (slow.value_at(seed, position) + fast.value_at(seed, position));
        maths::exp(nepers - depth * depth)
    }
}

/// The level at a loudness relative to the drive's level.
fn level_of(loudness: f64, exponent: f64) -> f64 {
    let loudness = within(loudness, 0.0, LOUDEST);
    (loudness / FAINT).min(1.0) * maths::pow(loudness, exponent)
}
