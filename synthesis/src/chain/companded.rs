//! What surrounds texture in the companded mode: companding, crackle, a fuel's noise, and extension as a substitute.

use std::sync::Arc;

use super::blocks::{MAX_CHANNELS, with_blocks};
use super::bus::CHUNK;
use super::layers::VoiceLayers;
use super::recordings::Recordings;
use crate::Controls;
use crate::companding::{Companding, DriveBlock, Recorded};
use crate::controls::{CrackleControls, Fuel, SLOTS, TextureControls};
use crate::crackle::{Crackle, Crackles, Sources};
use crate::dsp::Smoothed;
use crate::fuel::{self, FuelNoise, NoiseLevels};
use crate::texture::Texture;

/// Time constant in seconds with which a newly loaded recording takes over.
const SUBSTITUTE_S: f64 = 0.02;
/// Level of extension as a substitute, -12 dB: about as loud as texture matched from a recording, whose loudness is
/// flattened.
const SUBSTITUTE_LEVEL: f64 = 0.25;

/// State around texture in the companded mode.
#[derive(Debug)]
pub(super) struct Companded {
    pub companding: Companding,
    crackle: Crackle,
    /// Crackle of the second recording, and its output for one chunk by channel.
    second_crackle: Crackle,
    second: Vec<Vec<f64>>,
    /// Texture output for one chunk, by slot and channel.
    textures: Vec<Vec<Vec<f64>>>,
    /// Crackles of the fuels that burn.
    fuels: Arc<[Crackles]>,
    fuel_noise: FuelNoise,
    flat: Vec<f64>,
    loudness: Vec<f64>,
    /// Share of spectral extension in the texture layer: 1 as long as there is no recording.
    substitute_share: Smoothed,
    is_fresh: bool,
}

impl Companded {
    /// State for `outputs` channels; texture follows the drive after `wait`, and its output after `latency` samples.
    pub fn new(sample_rate_hz: f64, outputs: usize, wait: usize, latency: usize) -> Self {
        Self {
            companding: Companding::new(sample_rate_hz, outputs, wait, latency, CHUNK),
            crackle: Crackle::new(sample_rate_hz, outputs, latency, CHUNK),
            second_crackle: Crackle::new(sample_rate_hz, outputs, latency, CHUNK),
            second: vec![vec![0.0; CHUNK]; outputs],
            textures: vec![vec![vec![0.0; CHUNK]; outputs]; SLOTS],
            fuels: fuel::bank(sample_rate_hz),
            fuel_noise: FuelNoise::new(sample_rate_hz, outputs, latency),
            flat: vec![0.0; CHUNK],
            loudness: vec![0.0; CHUNK],
            substitute_share: Smoothed::new(SUBSTITUTE_S, sample_rate_hz),
            is_fresh: true,
        }
    }

    /// Restarts at `position` of the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.companding.reset(position);
        self.crackle.reset(position);
        self.second_crackle.reset(position);
        self.fuel_noise.reset(position);
        self.is_fresh = true;
    }

    /// Ends the crackles of a slot's recording.
    pub fn forget_slot(&mut self, slot: usize) {
        self.crackle.forget_slot(slot);
        self.second_crackle.forget_slot(slot);
    }

    /// Renders one chunk of crackle, after the same chunk of texture. `gain` is the factor that the whole layer receives.
    pub fn crackle(
        &mut self,
        controls: &Controls,
        recordings: &Recordings,
        gain: f64,
        layer: &mut [Vec<f64>],
        samples: usize,
    ) {
        let sources = sources(recordings, &self.fuels, controls.mix.loudness_lufs, gain);
        with_blocks(layer, samples, |outputs| {
            let layers = [&mut self.crackle, &mut self.second_crackle];
            let loudness = self.companding.relative_loudness(samples);
            let [first, second] = crackle_controls(controls, recordings);
            crackle(layers, [&first, &second], loudness, &sources, &mut self.second, outputs);
        });
    }

    /// Lets spectral extension replace texture, so that an instance without recording and fuel still burns. `gain` is
    /// the factor that the layer receives for other recordings and that must not apply here.
    pub fn substitute_extension(&mut self, is_substituted: bool, gain: f64, layers: &mut VoiceLayers, samples: usize) {
        let share = f64::from(u8::from(is_substituted));
        if std::mem::take(&mut self.is_fresh) {
            self.substitute_share.value = share;
        }
        if share == 0.0 && self.substitute_share.value == 0.0 {
            return;
        }
        let level = SUBSTITUTE_LEVEL / gain;
        for i in 0..samples {
            let share = self.substitute_share.next(share);
            for (texture, extension) in layers.texture.iter_mut().zip(&layers.extension) {
                texture[i] += share * (level * (layers.low[i] + extension[i]) - texture[i]);
            }
        }
    }

    /// Samples for which it continues after texture has fallen silent.
    pub fn tail_samples(&self) -> usize {
        self.companding.tail_samples() + self.crackle.tail_samples()
    }

    /// Renders one chunk of a fuel's hiss and body, after the same chunk of texture.
    pub fn fuel_noise(&mut self, controls: &Controls, [hiss, body]: [&mut [Vec<f64>]; 2], samples: usize) {
        let levels = NoiseLevels { hiss: controls.mix.hiss, body: controls.mix.body };
        let loudness = self.companding.relative_loudness(samples);
        with_blocks(hiss, samples, |hiss| {
            with_blocks(body, samples, |body| {
                self.fuel_noise.process(loudness, &controls.fuel, levels, hiss, body);
            });
        });
    }

    /// One chunk of texture in a world without slow loudness.
    pub fn process(
        &mut self,
        drive: DriveBlock<'_>,
        controls: &TextureControls,
        texture: &mut Texture,
        recordings: &Recordings,
        target_lufs: Option<f64>,
        outputs: &mut [&mut [f64]],
    ) {
        let samples = drive.samples.len();
        let (flat, loudness) = (&mut self.flat[..samples], &mut self.loudness[..samples]);
        self.companding.compress(drive, controls, recordings.reference_profile(), flat, loudness);
        let channels = outputs.len().min(MAX_CHANNELS);
        let mut blocks: [[&mut [f64]; MAX_CHANNELS]; SLOTS] = Default::default();
        for (blocks, texture) in blocks.iter_mut().zip(&mut self.textures) {
            for (block, channel) in blocks.iter_mut().zip(texture) {
                *block = &mut channel[..samples];
            }
        }
        let mut textures = blocks.each_mut().map(|blocks| &mut blocks[..channels]);
        let mut start = 0;
        while start < samples {
            let (controls, end) = self.companding.controls_from(start, samples);
            texture.advance(&flat[start..end], Some(&loudness[start..end]), &controls, |made, ready, range| {
                for (slot, texture) in textures.iter_mut().enumerate() {
                    made.copy(slot, ready, start + range.start..start + range.end, texture);
                }
            });
            start = end;
        }
        let gain = recordings.reference_profile().map_or(1.0, |profile| profile.gain_to(target_lufs));
        let recorded = std::array::from_fn(|slot| {
            let profile = recordings.profile(slot);
            let own = profile.map_or(gain, |profile| profile.gain_to(target_lufs));
            Recorded { profile, gain: own / gain }
        });
        self.companding.expand(&recorded, &mut textures, outputs);
    }
}

/// All crackle sources, on the scale of `scale`: the factor that the whole layer receives.
fn sources<'a>(recordings: &'a Recordings, fuels: &'a [Crackles], target_lufs: Option<f64>, scale: f64) -> Sources<'a> {
    let gain = |slot: usize| recordings.profile(slot).map_or(1.0, |profile| profile.gain_to(target_lufs) / scale);
    Sources {
        recordings: std::array::from_fn(|slot| recordings.crackles(slot)),
        gains: std::array::from_fn(gain),
        fuel_gain: fuel::gain_to(target_lufs) / scale,
        fuels,
    }
}

/// Controls of the crackles of the recording, or of a fuel, and of those of a second recording, in proportion to its share.
fn crackle_controls(controls: &Controls, recordings: &Recordings) -> [CrackleControls; 2] {
    let choice = &controls.texture.recordings;
    let mut first = CrackleControls { slot: choice.first(), ..controls.crackle };
    // There is no such slot, and nothing in it to crackle.
    let mut second = CrackleControls { slot: SLOTS, fuel: Fuel::Off, ..first };
    let other = choice.other(|slot| recordings.has(slot));
    let has_crackles = |slot: usize| recordings.crackles(slot).is_some();
    if let Some((slot, share)) = other.filter(|(slot, _)| has_crackles(*slot) || has_crackles(first.slot)) {
        second = CrackleControls { slot, density: share * first.density, ..second };
        first.density *= 1.0 - share;
    }
    [first, second]
}

/// Renders one chunk of crackle, after the same chunk of texture, in two layers; `spare` is working memory for the
/// second.
fn crackle(
    [first, second]: [&mut Crackle; 2],
    [controls, second_controls]: [&CrackleControls; 2],
    loudness: &[f64],
    sources: &Sources<'_>,
    spare: &mut [Vec<f64>],
    outputs: &mut [&mut [f64]],
) {
    first.process(loudness, controls, sources, outputs);
    with_blocks(spare, loudness.len(), |spare| {
        if second.process(loudness, second_controls, sources, spare) {
            for (output, spare) in outputs.iter_mut().zip(spare) {
                output.iter_mut().zip(spare.iter()).for_each(|(out, x)| *out += x);
            }
        }
    });
}
