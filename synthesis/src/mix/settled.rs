//! Mixing while no level moves: layer by layer instead of sample by sample, so that the compiler can use vectors.
//!
//! Every sum is built in the same order as in [`super::Mix::sample`], so both give the same bits.

use std::ops::Range;

use super::layers::{Layers, Levels, Peaks, limited_effect, louder};
use crate::dsp::ceiling;

/// Samples mixed at a time: the sums of ten channels stay in the first-level cache.
pub(super) const PART: usize = 64;

/// Values that are constant over a stretch of samples.
#[derive(Debug)]
pub(super) struct Settled<'a> {
    /// Levels of the stretch; its bypass is exactly 0 or 1.
    pub levels: &'a Levels,
    /// True if the output ceiling is on.
    pub has_ceiling: bool,
    /// The channel of low-frequency effects, which passes as it came.
    pub effects: Option<usize>,
    /// Room for the sums of each channel.
    pub wets: &'a mut [[f64; PART]],
}

impl Settled<'_> {
    /// Mixes the samples `range` of `layers` into `outputs`.
    pub fn process(&mut self, layers: &Layers<'_>, range: Range<usize>, outputs: &mut [&mut [f32]], peaks: &mut Peaks) {
        let end = range.end;
        for start in range.step_by(PART) {
            self.part(layers, start..end.min(start + PART), outputs, peaks);
        }
    }

    fn part(&mut self, layers: &Layers<'_>, at: Range<usize>, outputs: &mut [&mut [f32]], peaks: &mut Peaks) {
        let samples = at.len();
        let levels = self.levels;
        let mut low = [0.0; PART];
        let low = &mut low[..samples];
        low.iter_mut().zip(&layers.low[at.clone()]).for_each(|(low, x)| *low = levels.low * x);
        peaks.low = peaks.low.max(peak(low));

        let mut loudest = [0.0; PART];
        let is_narrowed = outputs.len() == 2 && levels.width != 1.0;
        for (channel, wet) in self.wets.iter_mut().enumerate().take(outputs.len()) {
            if self.effects == Some(channel) {
                continue;
            }
            let wet = &mut wet[..samples];
            wet.copy_from_slice(low);
            let own = |layer: &[Vec<f64>]| part_of(&layer[channel], &at);
            let narrowed = |layer: &[Vec<f64>]| {
                let mut own = part_of(&layer[channel], &at);
                if is_narrowed {
                    narrow(&mut own[..samples], &layer[0][at.clone()], &layer[1][at.clone()], levels.width);
                }
                own
            };
            add(wet, &own(layers.extension), levels.extension, &mut peaks.extension);
            add(wet, &narrowed(layers.texture), levels.texture, &mut peaks.texture);
            add(wet, &own(layers.vortex), levels.vortex, &mut peaks.vortex);
            add(wet, &narrowed(layers.crackle), levels.crackle, &mut peaks.crackle);
            add_unless_off(wet, || narrowed(layers.hiss), levels.hiss, &mut peaks.hiss);
            add_unless_off(wet, || narrowed(layers.body), levels.body, &mut peaks.body);
            for (wet, loudest) in wet.iter_mut().zip(&mut loudest) {
                *wet *= levels.output;
                *loudest = louder(*wet, *loudest);
            }
        }
        self.hold(&loudest[..samples]);

        for (channel, output) in outputs.iter_mut().enumerate() {
            let (output, dry) = (&mut output[at.clone()], &layers.dry[channel][at.clone()]);
            if self.effects == Some(channel) {
                output.iter_mut().zip(dry).for_each(|(out, dry)| *out = limited_effect(*dry, self.has_ceiling));
            } else if levels.bypass == 1.0 {
                output.copy_from_slice(dry);
            } else {
                output.iter_mut().zip(&self.wets[channel]).for_each(|(out, wet)| *out = *wet as f32);
            }
            let loudest = output.iter().fold(0.0f32, |most, x| if x.abs() > most { x.abs() } else { most });
            peaks.output = peaks.output.max(f64::from(loudest));
        }
    }

    /// Keeps all channels below full scale, by one factor for each sample.
    fn hold(&mut self, loudest: &[f64]) {
        // Up to the knee the factor is 1; NaN fails the comparison.
        if !self.has_ceiling || loudest.iter().all(|magnitude| *magnitude <= ceiling::KNEE) {
            return;
        }
        for (i, magnitude) in loudest.iter().enumerate() {
            let held = ceiling::gain(*magnitude);
            for wet in self.wets.iter_mut() {
                wet[i] = if held == 0.0 { 0.0 } else { wet[i] * held };
            }
        }
    }
}

fn part_of(channel: &[f64], at: &Range<usize>) -> [f64; PART] {
    let mut part = [0.0; PART];
    part[..at.len()].copy_from_slice(&channel[at.clone()]);
    part
}

fn narrow(own: &mut [f64], left: &[f64], right: &[f64], width: f64) {
    for ((own, left), right) in own.iter_mut().zip(left).zip(right) {
        let middle = 0.5 * (left + right);
        *own = middle + width * (*own - middle);
    }
}

/// Adds a layer at its level, and follows its peak.
fn add(wet: &mut [f64], layer: &[f64; PART], level: f64, most: &mut f64) {
    let mut scaled = *layer;
    scaled.iter_mut().for_each(|x| *x *= level);
    wet.iter_mut().zip(&scaled).for_each(|(wet, x)| *wet += x);
    *most = most.max(peak(&scaled[..wet.len()]));
}

/// The same for a layer that is not computed while its level is 0, and then counts as silence.
fn add_unless_off(wet: &mut [f64], layer: impl FnOnce() -> [f64; PART], level: f64, most: &mut f64) {
    if level == 0.0 {
        // This turns a negative zero into a positive one, as adding the silent layer would.
        wet.iter_mut().for_each(|wet| *wet += 0.0);
    } else {
        add(wet, &layer(), level, most);
    }
}

/// Largest magnitude; NaN does not count.
fn peak(samples: &[f64]) -> f64 {
    // Four maxima side by side, so that comparisons need not wait for each other.
    let mut most = [0.0f64; 4];
    let mut chunks = samples.chunks_exact(4);
    for chunk in &mut chunks {
        for (most, x) in most.iter_mut().zip(chunk) {
            *most = if x.abs() > *most { x.abs() } else { *most };
        }
    }
    chunks.remainder().iter().chain(&most).fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
