//! Drive and engines, from one starting point on the host's timeline.

use std::sync::Arc;

use super::blocks::with_blocks;
use super::bus::{CHUNK, Channels};
use super::companded::Companded;
use super::layers::VoiceLayers;
use super::recordings::Recordings;
use super::telemetry::Telemetry;
use super::vortex_layer::VortexLayer;
use crate::companding::{DriveBlock, DriveEnvelope, Profile};
use crate::controls::{DriveMode, Fuel, RecordingControls};
use crate::drive::Drive;
use crate::dsp::Delay;
use crate::extend::Extend;
use crate::fuel;
use crate::recording::RecordingDictionary;
use crate::structure::MatchingMode;
use crate::texture::{Distribution, PyramidConfig, Texture};
use crate::{Controls, EngineConfig, Error};

/// Drive and engines, their outputs aligned to the largest latency.
pub struct Voice {
    drive: Drive,
    extend: Extend,
    texture: Texture,
    recordings: Recordings,
    companded: Option<Companded>,
    vortex: VortexLayer,
    drive_block: Vec<f64>,
    envelope_block: Vec<f64>,
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
        let companded = (structure.dynamics == MatchingMode::Companded)
            .then(|| Companded::new(sample_rate_hz, outputs, wait, latency));
        let texture_wait = if companded.is_some() { 0 } else { wait };
        Ok(Self {
            companded,
            vortex: VortexLayer::new(sample_rate_hz, outputs, latency)?,
            drive: Drive::new(sample_rate_hz)?,
            extend,
            texture,
            recordings: Recordings::default(),
            drive_block: vec![0.0; CHUNK],
            envelope_block: vec![0.0; CHUNK],
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
            companded.reset(position);
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
            companded.forget_slot(slot);
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
        let is_substituted =
            self.is_texture_substituted(&controls.texture.recordings) && controls.crackle.fuel == Fuel::Off;
        let target_lufs = controls.mix.loudness_lufs;
        let [texture_gain, crackle_gain] = [self.gain_to(target_lufs), self.crackle_gain_to(target_lufs)];
        let drive = &mut self.drive_block[..samples];
        let values = &mut self.envelope_block[..samples];
        let delay_s = self.drive.process_with_envelope(main, sidechain, &controls.drive, drive, values);
        let envelope = delay_s.map(|delay_s| DriveEnvelope { values, delay_s });

        let mut extend = controls.extend;
        if controls.mix.extension == 0.0 && !(is_substituted && controls.mix.texture != 0.0) {
            // A layer that is off need not be computed.
            extend.noise_amount = 0.0;
        }
        let is_low_wanted = controls.mix.low != 0.0 || (is_substituted && controls.mix.texture != 0.0);
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
                    companded.process(
                        DriveBlock { samples: drive, envelope },
                        &texture,
                        &mut self.texture,
                        &self.recordings,
                        target_lufs,
                        outputs,
                    );
                });
                self.top_magnitudes.extend_from_slice(companded.companding.measured_loudnesses());
                let layer = &mut self.layers.crackle;
                companded.crackle(controls, &self.recordings, crackle_gain, layer, samples);
                companded.fuel_noise(controls, [&mut self.layers.hiss, &mut self.layers.body], samples);
            }
        }

        with_blocks(&mut self.layers.vortex, samples, |outputs| self.vortex.process(drive, controls, outputs));

        self.align(samples);
        if let Some(companded) = &mut self.companded {
            companded.substitute_extension(is_substituted, texture_gain, &mut self.layers, samples);
        }
    }

    /// Delays the layers that are early, so that all have the effect's latency.
    fn align(&mut self, samples: usize) {
        self.low_delay.process(&mut self.layers.low[..samples]);
        for (delay, channel) in self.extension_delays.iter_mut().zip(&mut self.layers.extension) {
            delay.process(&mut channel[..samples]);
        }
        for (delay, channel) in self.texture_delays.iter_mut().zip(&mut self.layers.texture) {
            delay.process(&mut channel[..samples]);
        }
    }

    /// True if spectral extension replaces texture for lack of a recording.
    fn is_texture_substituted(&self, recordings: &RecordingControls) -> bool {
        self.companded.is_some() && !self.has_recording(recordings.first())
    }
}
