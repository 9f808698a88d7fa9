//! Levels of the layers, width, output level, bypass.

pub use layers::{Layers, Peaks};

use layers::{Levels, limited_effect, louder};
use settled::Settled;

use crate::controls::MixControls;
use crate::dsp::{Smoothed, Timeline, ceiling};
use crate::tone::Tone;
use crate::vortex::SpeakerLayout;

mod layers;
mod settled;

/// Time constant in seconds with which levels follow their controls.
const SMOOTHING_S: f64 = 0.005;
/// Largest number of channels of any bus.
const MAX_CHANNELS: usize = 10;

/// Adds the layers. Controls are delayed by the latency, so that they act on the sound that they
/// arrived with, and smoothed.
#[derive(Debug, Clone)]
pub struct Mix {
    latency_samples: u64,
    /// The LFE channel, which is passed through.
    effects: Option<usize>,
    controls: Timeline<MixControls>,
    low: Smoothed,
    extension: Smoothed,
    texture: Smoothed,
    vortex: Smoothed,
    crackle: Smoothed,
    hiss: Smoothed,
    body: Smoothed,
    width: Smoothed,
    tone: Tone,
    output: Smoothed,
    bypass: Smoothed,
    /// Room for the sums of each channel while no level moves.
    wets: Vec<[f64; settled::PART]>,
    /// Samples mixed since reset.
    now: u64,
}

impl Mix {
    /// A mixer whose layers come `latency_samples` late, for the loudspeakers of `layout`.
    pub fn new(latency_samples: usize, sample_rate_hz: f64, layout: SpeakerLayout) -> Self {
        let smoothed = Smoothed::new(SMOOTHING_S, sample_rate_hz);
        Self {
            latency_samples: latency_samples as u64,
            effects: layout.low_frequency_effects(),
            controls: Timeline::new(latency_samples + 1, MixControls::default()),
            low: smoothed,
            extension: smoothed,
            texture: smoothed,
            vortex: smoothed,
            crackle: smoothed,
            hiss: smoothed,
            body: smoothed,
            width: smoothed,
            tone: Tone::new(sample_rate_hz),
            output: smoothed,
            bypass: smoothed,
            wets: vec![[0.0; settled::PART]; layout.channels()],
            now: 0,
        }
    }

    /// Restores the state of a fresh instance; the next controls apply at once.
    pub fn reset(&mut self) {
        self.controls.reset(MixControls::default());
        self.now = 0;
    }

    /// Samples for which it continues after the layers have fallen silent.
    pub fn tail_samples(&self, controls: &MixControls) -> usize {
        self.tone.tail_samples(&controls.tone)
    }

    /// Mixes one block into `outputs`, whose channels are as long as the layers'. `controls` belong to the sound that
    /// enters with this block.
    pub fn process(&mut self, layers: &Layers<'_>, controls: &MixControls, outputs: &mut [&mut [f32]]) -> Peaks {
        let samples = layers.low.len();
        if self.controls.end() == 0 {
            self.controls.reset(*controls);
            self.jump(controls);
        }
        self.controls.push(*controls, samples);
        let mut peaks = Peaks::default();
        let mut start = 0;
        while start < samples {
            let entered = (self.now + start as u64).saturating_sub(self.latency_samples);
            let (controls, end) = self.controls.run_at(entered);
            let end = end.saturating_add(self.latency_samples).saturating_sub(self.now).min(samples as u64) as usize;
            if self.is_settled(&controls) && outputs.len() <= self.wets.len() {
                let levels = &self.next_levels(&controls);
                let (has_ceiling, effects, wets) = (controls.ceiling, self.effects, &mut self.wets[..]);
                let mut settled = Settled { levels, has_ceiling, effects, wets };
                settled.process(layers, start..end, outputs, &mut peaks);
            } else {
                for i in start..end {
                    let levels = self.next_levels(&controls);
                    self.sample(layers, &controls, &levels, i, outputs, &mut peaks);
                }
            }
            start = end;
        }
        self.now += samples as u64;
        peaks
    }

    fn jump(&mut self, controls: &MixControls) {
        self.low.value = controls.low;
        self.extension.value = controls.extension;
        self.texture.value = controls.texture;
        self.vortex.value = controls.vortex;
        self.crackle.value = controls.crackle;
        self.hiss.value = controls.hiss;
        self.body.value = controls.body;
        self.width.value = controls.width;
        self.tone.reset(&controls.tone);
        self.output.value = controls.output;
        self.bypass.value = f64::from(u8::from(controls.bypass));
    }

    /// True if all levels have reached their controls and the tone is neutral: then they stay.
    fn is_settled(&self, controls: &MixControls) -> bool {
        let bypass = f64::from(u8::from(controls.bypass));
        self.low.value == controls.low
            && self.extension.value == controls.extension
            && self.texture.value == controls.texture
            && self.vortex.value == controls.vortex
            && self.crackle.value == controls.crackle
            && self.hiss.value == controls.hiss
            && self.body.value == controls.body
            && self.width.value == controls.width
            && self.output.value == controls.output
            && self.bypass.value == bypass
            && self.tone.is_neutral(&controls.tone)
    }

    /// The levels one sample later.
    #[inline]
    fn next_levels(&mut self, controls: &MixControls) -> Levels {
        self.tone.step(&controls.tone);
        Levels {
            low: self.low.next(controls.low),
            extension: self.extension.next(controls.extension),
            texture: self.texture.next(controls.texture),
            vortex: self.vortex.next(controls.vortex),
            crackle: self.crackle.next(controls.crackle),
            hiss: self.hiss.next(controls.hiss),
            body: self.body.next(controls.body),
            width: self.width.next(controls.width),
            output: self.output.next(controls.output),
            bypass: self.bypass.next(f64::from(u8::from(controls.bypass))),
        }
    }

    #[inline]
    fn sample(
        &mut self,
        layers: &Layers<'_>,
        controls: &MixControls,
        levels: &Levels,
        i: usize,
        outputs: &mut [&mut [f32]],
        peaks: &mut Peaks,
    ) {
        let Levels { width, bypass, .. } = *levels;
        let low = levels.low * layers.low[i];
        peaks.low = peaks.low.max(low.abs());
        // Narrowing is for pairs; at full width the recording's own channels pass untouched.
        let narrowed = outputs.len() == 2 && width != 1.0;
        let narrow = |layer: &[Vec<f64>], channel: usize| {
            let own = layer[channel][i];
            if narrowed {
                let middle = 0.5 * (layer[0][i] + layer[1][i]);
                middle + width * (own - middle)
            } else {
                own
            }
        };
        let mut wets = [0.0f64; MAX_CHANNELS];
        let mut loudest = 0.0f64;
        let channels = outputs.len().min(MAX_CHANNELS);
        for (channel, wet) in wets.iter_mut().enumerate().take(channels) {
            if self.effects == Some(channel) {
                continue;
            }
            let texture = narrow(layers.texture, channel) * levels.texture;
            let crackle = narrow(layers.crackle, channel) * levels.crackle;
            let extension = layers.extension[channel][i] * levels.extension;
            let vortex = layers.vortex[channel][i] * levels.vortex;
            let [hiss, body] = [(layers.hiss, levels.hiss), (layers.body, levels.body)]
                .map(|(layer, level)| if level == 0.0 { 0.0 } else { narrow(layer, channel) * level });
            let sum = low + extension + texture + vortex + crackle + hiss + body;
            *wet = self.tone.process(channel, sum) * levels.output;
            loudest = louder(*wet, loudest);
            peaks.extension = peaks.extension.max(extension.abs());
            peaks.texture = peaks.texture.max(texture.abs());
            peaks.vortex = peaks.vortex.max(vortex.abs());
            peaks.crackle = peaks.crackle.max(crackle.abs());
            peaks.hiss = peaks.hiss.max(hiss.abs());
            peaks.body = peaks.body.max(body.abs());
        }
        // The same for all channels, so that the image stays.
        let held = if controls.ceiling { ceiling::gain(loudest) } else { 1.0 };
        for (channel, output) in outputs.iter_mut().enumerate() {
            let dry = layers.dry[channel][i];
            output[i] = if self.effects == Some(channel) {
                limited_effect(dry, controls.ceiling)
            } else {
                let wet = if held == 0.0 { 0.0 } else { wets[channel] * held };
                match bypass {
                    0.0 => wet as f32,
                    1.0 => dry,
                    part => (wet + part * (f64::from(dry) - wet)) as f32,
                }
            };
            peaks.output = peaks.output.max(f64::from(output[i]).abs());
        }
    }
}

#[cfg(test)]
mod tests;
