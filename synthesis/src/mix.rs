//! Levels of the layers, width, output level, bypass.

use crate::ceiling;
use crate::controls::MixControls;
use crate::smoothed::Smoothed;
use crate::timeline::Timeline;
use crate::tone::Tone;
use crate::vortex::SpeakerLayout;

/// Time constant in seconds with which levels follow their controls.
const SMOOTHING_S: f64 = 0.005;
/// Largest number of channels of any bus.
const MAX_CHANNELS: usize = 10;

/// The layers of one block, all delayed by the effect's latency.
#[derive(Debug, Clone, Copy)]
pub struct Layers<'a> {
    /// The drive's low part, the same in every channel.
    pub low: &'a [f64],
    /// Extension noise, by channel.
    pub extension: &'a [Vec<f64>],
    /// Texture, by channel.
    pub texture: &'a [Vec<f64>],
    /// Vortex sound, by channel.
    pub vortex: &'a [Vec<f64>],
    /// Crackle, by channel.
    pub crackle: &'a [Vec<f64>],
    /// A fuel's hiss, by channel.
    pub hiss: &'a [Vec<f64>],
    /// A fuel's body, by channel.
    pub body: &'a [Vec<f64>],
    /// The input, by output channel, with the same delay; silent if there is none.
    pub dry: &'a [Vec<f32>],
}

/// Largest magnitudes of the layers after their levels, and of the output.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Peaks {
    /// Low layer.
    pub low: f64,
    /// Extension layer.
    pub extension: f64,
    /// Texture layer.
    pub texture: f64,
    /// Vortex layer.
    pub vortex: f64,
    /// Crackle layer.
    pub crackle: f64,
    /// Hiss layer.
    pub hiss: f64,
    /// Body layer.
    pub body: f64,
    /// Output.
    pub output: f64,
}

/// Levels of one sample.
#[derive(Debug, Clone, Copy)]
struct Levels {
    low: f64,
    extension: f64,
    texture: f64,
    vortex: f64,
    crackle: f64,
    hiss: f64,
    body: f64,
    width: f64,
    output: f64,
    bypass: f64,
}

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
            let settled = self.is_settled(&controls).then(|| self.next_levels(&controls));
            for i in start..end {
                let levels = settled.unwrap_or_else(|| self.next_levels(&controls));
                self.sample(layers, &controls, &levels, i, outputs, &mut peaks);
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
            // A comparison with NaN would leave it out.
            loudest = if wet.is_nan() { f64::NAN } else { wet.abs().max(loudest) };
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
                if controls.ceiling { (f64::from(dry) * ceiling::gain(f64::from(dry).abs())) as f32 } else { dry }
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
mod tests {
    use super::*;

    fn layers_of_ones(samples: usize) -> (Vec<f64>, Vec<Vec<f64>>, Vec<Vec<f32>>) {
        (vec![1.0; samples], vec![vec![0.0; samples]; 2], vec![vec![0.25; samples]; 2])
    }

    #[test]
    fn a_step_acts_on_the_sound_it_arrived_with() {
        let (low, silent, dry) = layers_of_ones(6000);
        let run = |cut: usize| {
            let mut mix = Mix::new(1000, 48_000.0, SpeakerLayout::Stereo);
            let mut outputs = [vec![0.0f32; 6000], vec![0.0f32; 6000]];
            let mut start = 0;
            for (end, gain) in [(500, 1.0), (6000, 0.5)] {
                while start < end {
                    let stop = end.min(start + cut);
                    let part = |x: &Vec<f64>| x[start..stop].to_vec();
                    let silent: Vec<Vec<f64>> = silent.iter().map(part).collect();
                    let dry: Vec<_> = dry.iter().map(|x| x[start..stop].to_vec()).collect();
                    let layers = Layers {
                        low: &low[start..stop],
                        extension: &silent,
                        texture: &silent,
                        vortex: &silent,
                        crackle: &silent,
                        hiss: &silent,
                        body: &silent,
                        dry: &dry,
                    };
                    let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(|x| &mut x[start..stop]).collect();
                    mix.process(&layers, &MixControls { low: gain, ..MixControls::default() }, &mut outs);
                    start = stop;
                }
            }
            outputs[0].clone()
        };
        let whole = run(6000);
        assert!(whole[..1500].iter().all(|x| *x == 1.0));
        assert!(whole[1500] < 1.0);
        assert_eq!(*whole.last().unwrap(), 0.5);
        for cut in [1, 17, 480] {
            assert_eq!(run(cut), whole, "cut into {cut}");
        }
    }

    #[test]
    fn bypass_is_the_dry_sound_exactly() {
        let (low, silent, dry) = layers_of_ones(100);
        let mut mix = Mix::new(10, 48_000.0, SpeakerLayout::Stereo);
        let mut outputs = [vec![0.0f32; 100], vec![0.0f32; 100]];
        let layers = Layers {
            low: &low,
            extension: &silent,
            texture: &silent,
            vortex: &silent,
            crackle: &silent,
            hiss: &silent,
            body: &silent,
            dry: &dry,
        };
        let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
        mix.process(&layers, &MixControls { bypass: true, ..MixControls::default() }, &mut outs);
        assert_eq!(outputs[0], dry[0]);
    }
}
