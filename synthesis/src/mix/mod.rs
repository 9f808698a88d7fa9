//! Levels of the layers, width, output level, bypass.

pub use layers::{Layers, Peaks};

use layers::{Levels, held_effect, louder};
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
                held_effect(dry, controls.ceiling)
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

    /// Noise that is now and then zero, loud, or no number.
    fn rough(random: &mut u64) -> f64 {
        *random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = (*random >> 40) as f64 / f64::from(1 << 23) - 1.0;
        match *random >> 33 & 127 {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -0.0,
            3..10 => 0.0,
            10..20 => 40.0 * x,
            _ => 0.1 * x,
        }
    }

    #[test]
    fn settled_levels_give_the_bits_that_moving_ones_give() {
        let mut random = 1;
        let layouts =
            [SpeakerLayout::Mono, SpeakerLayout::Stereo, SpeakerLayout::Surround51, SpeakerLayout::Surround712];
        let mut ceilings = 0;
        for (case, layout) in layouts.into_iter().cycle().take(48).enumerate() {
            let (channels, samples) = (layout.channels(), 1 + case * 7);
            let mut layer = || -> Vec<Vec<f64>> {
                // Negative zero in all layers at once: only what is added to it decides its sign.
                let mut channel = || std::iter::once(-0.0).chain((1..samples).map(|_| rough(&mut random))).collect();
                (0..channels).map(|_| channel()).collect()
            };
            let all: [Vec<Vec<f64>>; 7] = std::array::from_fn(|_| layer());
            let dry: Vec<Vec<f32>> = layer().iter().map(|x| x.iter().map(|x| *x as f32).collect()).collect();
            let layers = Layers {
                low: &all[0][0],
                extension: &all[1],
                texture: &all[2],
                vortex: &all[3],
                crackle: &all[4],
                hiss: &all[5],
                body: &all[6],
                dry: &dry,
            };
            let controls = MixControls {
                hiss: if case % 3 == 0 { 0.0 } else { 0.7 },
                width: if case % 2 == 0 { 1.0 } else { 0.3 },
                ceiling: case % 5 != 0,
                bypass: case % 7 == 0,
                ..MixControls::default()
            };
            let mut mix = Mix::new(0, 48_000.0, layout);
            mix.jump(&controls);
            assert!(mix.is_settled(&controls));
            let levels = mix.next_levels(&controls);
            let mut run = |is_settled: bool| {
                let mut peaks = Peaks::default();
                let mut outputs = vec![vec![0.0f32; samples]; channels];
                let mut outs: Vec<&mut [f32]> = outputs.iter_mut().map(Vec::as_mut_slice).collect();
                if is_settled {
                    let (has_ceiling, effects, wets) = (controls.ceiling, mix.effects, &mut mix.wets[..]);
                    let mut settled = Settled { levels: &levels, has_ceiling, effects, wets };
                    settled.process(&layers, 0..samples, &mut outs, &mut peaks);
                } else {
                    (0..samples).for_each(|i| mix.sample(&layers, &controls, &levels, i, &mut outs, &mut peaks));
                }
                let bits: Vec<Vec<u32>> = outputs.iter().map(|x| x.iter().map(|x| x.to_bits()).collect()).collect();
                (bits, peaks)
            };
            let (settled, moving) = (run(true), run(false));
            assert_eq!(settled.0, moving.0, "case {case}");
            let bits = |peaks: Peaks| {
                let Peaks { low, extension, texture, vortex, crackle, hiss, body, output } = peaks;
                [low, extension, texture, vortex, crackle, hiss, body, output].map(f64::to_bits)
            };
            assert_eq!(bits(settled.1), bits(moving.1), "case {case}");
            ceilings += usize::from(controls.ceiling && settled.1.output > 0.9);
        }
        assert!(ceilings > 9, "the ceiling held in {ceilings} cases only");
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
