//! Drive and engines, from one starting point on the host's timeline.

use std::sync::Arc;

use super::bus::{CHUNK, Channels};
use super::recordings::Recordings;
use super::telemetry::Telemetry;
use super::vortex_layer::VortexLayer;
use crate::companding::{Companding, Profile, Recorded};
use crate::controls::{CrackleControls, DriveMode, Fuel, RecordingControls, SLOTS, TextureControls};
use crate::crackle::{Crackle, Crackles, Sources};
use crate::drive::Drive;
use crate::dsp::{Delay, Smoothed};
use crate::extend::Extend;
use crate::fuel::{self, FuelNoise, NoiseLevels};
use crate::recording::RecordingDictionary;
use crate::structure::MatchingMode;
use crate::texture::{Distribution, PyramidConfig, Texture};
use crate::{Controls, EngineConfig, Error};

/// The layers that a voice makes of one chunk.
#[derive(Debug)]
pub struct VoiceLayers {
    /// The drive's low part.
    pub low: Vec<f64>,
    /// Extension noise by channel.
    pub extension: Vec<Vec<f64>>,
    /// Texture by channel.
    pub texture: Vec<Vec<f64>>,
    /// Vortex sound by channel.
    pub vortex: Vec<Vec<f64>>,
    /// Crackle by channel.
    pub crackle: Vec<Vec<f64>>,
    /// A fuel's hiss by channel.
    pub hiss: Vec<Vec<f64>>,
    /// A fuel's body by channel.
    pub body: Vec<Vec<f64>>,
}

impl VoiceLayers {
    fn new(channels: usize) -> Self {
        let channel = || vec![0.0; CHUNK];
        let all = || (0..channels).map(|_| channel()).collect();
        Self {
            low: channel(),
            extension: all(),
            texture: all(),
            vortex: all(),
            crackle: all(),
            hiss: all(),
            body: all(),
        }
    }

    /// Crossfades these layers to `other`, by the share that `ramp` gives for every sample, 0-1.
    pub fn fade_to(&mut self, other: &Self, samples: usize, ramp: impl Fn(usize) -> f64) {
        let channels = self.extension.iter_mut().chain(&mut self.texture).chain(&mut self.vortex);
        let channels = channels.chain(&mut self.crackle).chain(&mut self.hiss).chain(&mut self.body);
        let channels = channels.chain([&mut self.low]);
        let others = other.extension.iter().chain(&other.texture).chain(&other.vortex);
        let others = others.chain(&other.crackle).chain(&other.hiss).chain(&other.body).chain([&other.low]);
        for (mine, theirs) in channels.zip(others) {
            for i in 0..samples {
                let part = ramp(i);
                // At the ends exactly one of the two, whatever the other contains.
                if part >= 1.0 {
                    mine[i] = theirs[i];
                } else if part > 0.0 {
                    mine[i] += part * (theirs[i] - mine[i]);
                }
            }
        }
    }
}

/// Time constant in seconds with which a newly loaded recording takes over.
const STAND_IN_S: f64 = 0.02;
/// Level of extension as a substitute, -12 dB: about as loud as texture matched from a recording, whose loudness is
/// flattened.
const STAND_IN_LEVEL: f64 = 0.25;

/// State around texture in the companded mode.
#[derive(Debug)]
struct Companded {
    companding: Companding,
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
    stand_in: Smoothed,
    is_fresh: bool,
}

/// Drive and engines, their outputs aligned to the largest latency.
pub struct Voice {
    drive: Drive,
    extend: Extend,
    texture: Texture,
    recordings: Recordings,
    companded: Option<Companded>,
    vortex: VortexLayer,
    drive_block: Vec<f64>,
    /// Output for the last chunk.
    pub layers: VoiceLayers,
    low_delay: Delay<f64>,
    extension_delays: Vec<Delay<f64>>,
    texture_delays: Vec<Delay<f64>>,
    latency_samples: usize,
    top_magnitudes: Vec<f64>,
}

impl Voice {
    /// Builds drive and engines; allocates all they will need.
    pub fn new(sample_rate_hz: f64, channels: Channels, structure: &EngineConfig) -> Result<Self, Error> {
        let outputs = channels.output;
        let extend = Extend::new(structure, outputs, sample_rate_hz)?;
        let texture = Texture::new(&PyramidConfig::at_rate(structure, sample_rate_hz), outputs, sample_rate_hz)?;
        let latency = extend.latency_samples().max(texture.latency_samples());
        let extend_wait = latency - extend.latency_samples();
        let wait = latency - texture.latency_samples();
        // In the companded mode texture is delayed beforehand, so that loudness can look ahead.
        let companded = (structure.dynamics == MatchingMode::Companded).then(|| Companded {
            companding: Companding::new(sample_rate_hz, outputs, wait, latency, CHUNK),
            crackle: Crackle::new(sample_rate_hz, outputs, latency, CHUNK),
            second_crackle: Crackle::new(sample_rate_hz, outputs, latency, CHUNK),
            second: vec![vec![0.0; CHUNK]; outputs],
            textures: vec![vec![vec![0.0; CHUNK]; outputs]; SLOTS],
            fuels: fuel::bank(sample_rate_hz),
            fuel_noise: FuelNoise::new(sample_rate_hz, outputs, latency),
            flat: vec![0.0; CHUNK],
            loudness: vec![0.0; CHUNK],
            stand_in: Smoothed::new(STAND_IN_S, sample_rate_hz),
            is_fresh: true,
        });
        let texture_wait = if companded.is_some() { 0 } else { wait };
        Ok(Self {
            companded,
            vortex: VortexLayer::new(sample_rate_hz, outputs, latency)?,
            drive: Drive::new(sample_rate_hz)?,
            extend,
            texture,
            recordings: Recordings::default(),
            drive_block: vec![0.0; CHUNK],
            layers: VoiceLayers::new(outputs),
            low_delay: Delay::new(extend_wait),
            extension_delays: vec![Delay::new(extend_wait); outputs],
            texture_delays: vec![Delay::new(texture_wait); outputs],
            latency_samples: latency,
            top_magnitudes: Vec::with_capacity(CHUNK),
        })
    }

    /// Delay of all layers in samples.
    pub fn latency_samples(&self) -> usize {
        self.latency_samples
    }

    /// Samples that may sound after the input has fallen silent, including latency.
    pub fn tail_samples(&self, controls: &Controls) -> usize {
        let drive = self.drive.tail_samples(&controls.drive);
        let companding = self.companded.as_ref().map_or(0, Companded::tail_samples);
        let fire = (self.texture.tail_samples() + companding).max(self.extend.tail_samples());
        self.latency_samples + drive + fire.max(self.vortex.tail_samples(controls).unwrap_or(0))
    }

    /// True if it sounds without any input.
    pub fn is_self_driven(&self, controls: &Controls) -> bool {
        controls.drive.mode == DriveMode::Flame || self.vortex.is_self_driven(controls)
    }

    /// True if its end cannot be predicted.
    pub fn is_endless(&self, controls: &Controls) -> bool {
        self.is_self_driven(controls) || self.vortex.tail_samples(controls).is_none()
    }

    /// Vortex sound.
    pub fn vortex_layer(&mut self) -> &mut VortexLayer {
        &mut self.vortex
    }

    /// Restarts at `position` of the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.drive.reset(position);
        self.extend.reset(position);
        self.texture.reset(position.wrapping_sub(self.texture_starts_late()));
        if let Some(companded) = &mut self.companded {
            companded.companding.reset(position);
            companded.crackle.reset(position);
            companded.second_crackle.reset(position);
            companded.fuel_noise.reset(position);
            companded.is_fresh = true;
        }
        self.vortex.reset(position);
        self.low_delay.reset();
        self.extension_delays.iter_mut().chain(&mut self.texture_delays).for_each(Delay::reset);
    }

    /// Samples by which texture receives the drive late: its grid of windows is aligned with the drive's own positions.
    fn texture_starts_late(&self) -> i64 {
        if self.companded.is_some() { (self.latency_samples - self.texture.latency_samples()) as i64 } else { 0 }
    }

    /// Exchanges the recording of a slot, which must exist; a new one must have the texture's shape.
    pub fn swap_slot(
        &mut self,
        slot: usize,
        dictionary: Option<Arc<RecordingDictionary>>,
    ) -> Option<Arc<RecordingDictionary>> {
        if let Some(companded) = &mut self.companded {
            companded.crackle.forget_slot(slot);
            companded.second_crackle.forget_slot(slot);
        }
        let windows = dictionary.as_ref().map(|dictionary| Arc::clone(dictionary.windows()));
        let profile = dictionary.as_ref().and_then(|dictionary| dictionary.profile());
        let matched_rms = profile.map_or(0.0, Profile::matched_rms);
        // The old recording, which is returned, refers to the old windows as well, so this reference frees nothing.
        drop(self.texture.swap_slot(slot, windows, matched_rms));
        self.recordings.swap(slot, dictionary, self.texture.slots().reference())
    }

    /// True if there is a recording in a slot.
    pub fn has_recording(&self, slot: usize) -> bool {
        self.recordings.has(slot)
    }

    /// Exchanges the learned distribution.
    pub fn swap_distribution(&mut self, learned: Option<Arc<Distribution>>) -> Option<Arc<Distribution>> {
        if let Some(companded) = &mut self.companded {
            companded.companding.set_learned(learned.as_deref());
        }
        self.texture.swap_distribution(learned)
    }

    /// The factor that brings texture to a loudness in LUFS; recordings other than the reference have another factor on
    /// top.
    pub fn gain_to(&self, target_lufs: Option<f64>) -> f64 {
        self.recordings.reference_profile().map_or(1.0, |profile| profile.gain_to(target_lufs))
    }

    /// The same for crackle: the reference's factor if it has crackles, otherwise a fuel's.
    pub fn crackle_gain_to(&self, target_lufs: Option<f64>) -> f64 {
        if self.recordings.reference_crackles().is_some() {
            self.gain_to(target_lufs)
        } else {
            fuel::gain_to(target_lufs)
        }
    }

    /// The drive's samples of the last chunk.
    pub fn drive_block(&self, samples: usize) -> &[f64] {
        &self.drive_block[..samples]
    }

    /// Magnitudes of the drive's top level that arose in the last chunk.
    pub fn top_magnitudes(&self) -> &[f64] {
        &self.top_magnitudes
    }

    /// Returns the telemetry of the engines since the last call.
    pub fn take_traces(&mut self) -> impl Iterator<Item = Telemetry> {
        let betas = self.extend.take_betas().map(Telemetry::Beta);
        let (matches, extents) = self.texture.take_traces();
        let sources = self.vortex.take_view();
        betas.chain(matches.map(Telemetry::Match)).chain(extents.map(Telemetry::Extent)).chain(sources)
    }

    /// True if the input's channels cancel.
    pub fn cancels(&self) -> bool {
        self.drive.cancels()
    }

    /// See [`Texture::scaling_alpha`].
    pub fn scaling_alpha(&self) -> f64 {
        self.texture.scaling_alpha()
    }

    /// Processes one chunk of up to [`CHUNK`] samples into `layers`.
    pub fn process(&mut self, main: &[&[f64]], sidechain: &[&[f64]], controls: &Controls, samples: usize) {
        let stands_in = self.stands_in(&controls.texture.recordings) && controls.crackle.fuel == Fuel::Off;
        let target_lufs = controls.mix.loudness_lufs;
        let [texture_gain, crackle_gain] = [self.gain_to(target_lufs), self.crackle_gain_to(target_lufs)];
        let drive = &mut self.drive_block[..samples];
        self.drive.process(main, sidechain, &controls.drive, drive);

        let mut extend = controls.extend;
        if controls.mix.extension == 0.0 && !(stands_in && controls.mix.texture != 0.0) {
            // A layer that is off need not be computed.
            extend.noise_amount = 0.0;
        }
        let is_low_wanted = controls.mix.low != 0.0 || (stands_in && controls.mix.texture != 0.0);
        let low = &mut self.layers.low[..samples];
        with_blocks(&mut self.layers.extension, samples, |noise| {
            self.extend.process_wanted(drive, &extend, is_low_wanted, low, noise);
        });

        let mut texture = controls.texture;
        if controls.mix.texture == 0.0 {
            // Likewise: nothing exceeds this threshold.
            texture.gate = f64::INFINITY;
        }
        self.top_magnitudes.clear();
        match &mut self.companded {
            None => {
                with_blocks(&mut self.layers.texture, samples, |outputs| {
                    self.texture.process(drive, None, &texture, outputs);
                });
                self.top_magnitudes.extend_from_slice(self.texture.top_magnitudes());
            }
            Some(companded) => {
                with_blocks(&mut self.layers.texture, samples, |outputs| {
                    companded.process(drive, &texture, &mut self.texture, &self.recordings, target_lufs, outputs);
                });
                self.top_magnitudes.extend_from_slice(companded.companding.told());
                let sources = sources(&self.recordings, &companded.fuels, target_lufs, crackle_gain);
                with_blocks(&mut self.layers.crackle, samples, |outputs| {
                    let layers = [&mut companded.crackle, &mut companded.second_crackle];
                    let loudness = companded.companding.heard(samples);
                    let [first, second] = crackle_controls(controls, &self.recordings);
                    crackle(layers, [&first, &second], loudness, &sources, &mut companded.second, outputs);
                });
                companded.fuel_noise(controls, [&mut self.layers.hiss, &mut self.layers.body], samples);
            }
        }

        with_blocks(&mut self.layers.vortex, samples, |outputs| self.vortex.process(drive, controls, outputs));

        self.low_delay.process(low);
        for (delay, channel) in self.extension_delays.iter_mut().zip(&mut self.layers.extension) {
            delay.process(&mut channel[..samples]);
        }
        for (delay, channel) in self.texture_delays.iter_mut().zip(&mut self.layers.texture) {
            delay.process(&mut channel[..samples]);
        }
        if let Some(companded) = &mut self.companded {
            companded.stand_in(stands_in, texture_gain, &mut self.layers, samples);
        }
    }

    /// True if spectral extension replaces texture for lack of a recording.
    fn stands_in(&self, recordings: &RecordingControls) -> bool {
        self.companded.is_some() && !self.has_recording(recordings.first())
    }
}

impl Companded {
    /// Lets spectral extension replace texture, so that an instance without recording and fuel still burns. `gain` is
    /// the factor that the layer receives for other recordings and that must not apply here.
    fn stand_in(&mut self, stands_in: bool, gain: f64, layers: &mut VoiceLayers, samples: usize) {
        let share = f64::from(u8::from(stands_in));
        if std::mem::take(&mut self.is_fresh) {
            self.stand_in.value = share;
        }
        if share == 0.0 && self.stand_in.value == 0.0 {
            return;
        }
        let level = STAND_IN_LEVEL / gain;
        for i in 0..samples {
            let share = self.stand_in.next(share);
            for (texture, extension) in layers.texture.iter_mut().zip(&layers.extension) {
                texture[i] += share * (level * (layers.low[i] + extension[i]) - texture[i]);
            }
        }
    }

    /// Samples for which it continues after texture has fallen silent.
    fn tail_samples(&self) -> usize {
        self.companding.tail_samples() + self.crackle.tail_samples()
    }

    /// Renders one chunk of a fuel's hiss and body, after the same chunk of texture.
    fn fuel_noise(&mut self, controls: &Controls, [hiss, body]: [&mut [Vec<f64>]; 2], samples: usize) {
        let levels = NoiseLevels { hiss: controls.mix.hiss, body: controls.mix.body };
        let loudness = self.companding.heard(samples);
        with_blocks(hiss, samples, |hiss| {
            with_blocks(body, samples, |body| {
                self.fuel_noise.process(loudness, &controls.fuel, levels, hiss, body);
            });
        });
    }

    /// One chunk of texture in a world without slow loudness.
    fn process(
        &mut self,
        drive: &[f64],
        controls: &TextureControls,
        texture: &mut Texture,
        recordings: &Recordings,
        target_lufs: Option<f64>,
        outputs: &mut [&mut [f64]],
    ) {
        let samples = drive.len();
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

/// Largest number of channels of any bus: those of 7.1.2.
pub(super) const MAX_CHANNELS: usize = 10;

/// Calls `process` with the first `samples` of every channel, without allocating.
fn with_blocks(channels: &mut [Vec<f64>], samples: usize, process: impl FnOnce(&mut [&mut [f64]])) {
    let mut blocks: [&mut [f64]; MAX_CHANNELS] = Default::default();
    let count = channels.len().min(MAX_CHANNELS);
    for (block, channel) in blocks.iter_mut().zip(channels) {
        *block = &mut channel[..samples];
    }
    process(&mut blocks[..count]);
}
