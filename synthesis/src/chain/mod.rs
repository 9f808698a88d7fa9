//! The whole effect: drive, engines, mix, with transport and automation.
//!
//! Time is an internal sample counter, anchored to the host's position at reset; it runs free if the host stops or
//! reports no position. A jump, a loop or a start of playback elsewhere starts a second *voice* at the new position,
//! exactly as a fresh instance would start there. Once the first voice has played everything from before the jump, the
//! second takes over in a crossfade of 10 ms. Two passes from one place therefore sound the same, whatever was played
//! before.

mod blocks;
mod bus;
mod companded;
mod input;
mod layers;
mod meters;
mod recordings;
mod silence;
mod telemetry;
mod voice;
mod voices;
mod vortex_layer;

use std::sync::Arc;

use crate::companding::{DriveEnvelope, loudnesses};
use crate::controls::SLOTS;
use crate::error::in_range;
use crate::extend;
use crate::fuel;
use crate::mix::{Layers, Mix};
use crate::recording::RecordingDictionary;
use crate::structure::MatchingMode;
use crate::texture::{Distribution, PyramidConfig, offline};
use crate::vortex::{Simulator, SpeakerLayout, SpeedField};
use crate::{Controls, EngineConfig, Error, drive::Drive};
pub use bus::{Channels, Transport};
pub use meters::Meters;
pub use telemetry::Telemetry;

use blocks::MAX_CHANNELS;
use bus::CHUNK;
use input::{Input, clean};
use silence::Silence;
use voice::Voice;
use voices::Voices;

/// Length in seconds of the crossfade after a jump.
const CROSSFADE_S: f64 = 0.01;
/// Peak of the loudest crackle under a ceiling, -2.5 dBFS: with the bed around it, it stays below the knee, so that no wave is bent.
const HIGHEST_PEAK: f64 = 0.75;
/// The whole effect.
pub struct Chain {
    channels: Channels,
    sample_rate_hz: f64,
    shape: PyramidConfig,
    dynamics: MatchingMode,
    voices: Voices,
    input: Input,
    mix: Mix,
    latency_samples: usize,
    has_dictionary: bool,
    silence: Silence,
    meters: Meters,
    top_magnitudes: Vec<f64>,
    drive: Vec<f32>,
}

/// Most samples of drive and top-level magnitudes that one call hands out: all of a call of up to 8192 samples.
const REPORTED_CAPACITY: usize = 8192;

/// Output delay in samples of a [`Chain`] with this structure at a sample rate in Hz (8-384 kHz), without building one:
/// that of the slower of extension and texture.
///
/// # Errors
/// [`Error::OutOfRange`] if the structure or the rate is out of range.
pub fn latency_samples(sample_rate_hz: f64, structure: &EngineConfig) -> Result<usize, Error> {
    let extension = extend::latency_samples(structure, sample_rate_hz)?;
    Ok(extension.max(PyramidConfig::at_rate(structure, sample_rate_hz).latency_samples()))
}

impl Chain {
    /// Builds the effect for one sample rate (8-384 kHz) and structure; allocates all it will need.
    pub fn new(sample_rate_hz: f64, channels: Channels, structure: &EngineConfig) -> Result<Self, Error> {
        in_range("sample rate in Hz", sample_rate_hz, 8_000.0, 384_000.0)?;
        let most = MAX_CHANNELS as f64;
        in_range("input channels", channels.input as f64, 1.0, most)?;
        in_range("sidechain channels", channels.sidechain as f64, 0.0, most)?;
        in_range("output channels", channels.output as f64, channels.input as f64, most)?;
        structure.validate()?;
        let voice = || Voice::new(sample_rate_hz, channels, structure);
        let voices = [voice()?, voice()?];
        let latency_samples = voices[0].latency_samples();
        let crossfade_samples = (CROSSFADE_S * sample_rate_hz).round() as usize;
        Ok(Self {
            shape: PyramidConfig::at_rate(structure, sample_rate_hz),
            dynamics: structure.dynamics,
            voices: Voices::new(voices, crossfade_samples),
            input: Input::new(channels, latency_samples),
            mix: Mix::new(latency_samples, sample_rate_hz, SpeakerLayout::of_channels(channels.output)?),
            latency_samples,
            has_dictionary: false,
            silence: Silence::default(),
            meters: Meters::default(),
            top_magnitudes: Vec::with_capacity(REPORTED_CAPACITY),
            drive: Vec::with_capacity(REPORTED_CAPACITY),
            channels,
            sample_rate_hz,
        })
    }

    /// Delay of the output in samples: a function of sample rate and structure alone.
    pub fn latency_samples(&self) -> usize {
        self.latency_samples
    }

    /// Samples that may still sound after the input has fallen silent, with the controls of the last call.
    pub fn tail_samples(&self) -> Option<usize> {
        (!self.silence.is_endless).then_some(self.silence.tail_samples)
    }

    /// True if input and output have been silent for longer than the tail, and only an input can change that.
    pub fn is_silent(&self) -> bool {
        self.silence.is_over()
    }

    /// Shape of the dictionaries that it accepts.
    pub fn shape(&self) -> &PyramidConfig {
        &self.shape
    }

    /// Sample rate in Hz.
    pub fn sample_rate_hz(&self) -> f64 {
        self.sample_rate_hz
    }

    /// Restores the state of a fresh instance, but keeps recording and learned distribution.
    pub fn reset(&mut self) {
        self.voices.reset();
        self.input.reset();
        self.mix.reset();
        self.silence = Silence::default();
        self.meters = Meters::default();
        self.top_magnitudes.clear();
        self.drive.clear();
    }

    /// Exchanges the dictionary of the first slot's recording, as [`swap_slot`](Self::swap_slot) does.
    pub fn swap_dictionary(
        &mut self,
        dictionary: Option<Arc<RecordingDictionary>>,
    ) -> Option<Arc<RecordingDictionary>> {
        self.swap_slot(0, dictionary)
    }

    /// Exchanges the dictionary of the recording in a slot; the caller drops the old one outside the audio thread. A
    /// dictionary made for another sample rate or structure, or for a slot that does not exist, is returned unused.
    pub fn swap_slot(
        &mut self,
        slot: usize,
        dictionary: Option<Arc<RecordingDictionary>>,
    ) -> Option<Arc<RecordingDictionary>> {
        let is_companded = self.dynamics == MatchingMode::Companded;
        let fits = |x: &Arc<RecordingDictionary>| {
            *x.windows().shape() == self.shape
                && x.windows().sample_rate_hz() == self.sample_rate_hz
                && x.profile().is_some() == is_companded
        };
        if slot >= SLOTS || dictionary.as_ref().is_some_and(|x| !fits(x)) {
            return dictionary;
        }
        let [first, second] = self.voices.both();
        // Of the two references to the old one, the second survives, so this one frees nothing.
        drop(first.swap_slot(slot, dictionary.clone()));
        let old = second.swap_slot(slot, dictionary);
        self.has_dictionary = (0..SLOTS).any(|slot| second.has_recording(slot));
        old
    }

    /// Exchanges the learned distribution of the drive's amplitudes, in the same way.
    pub fn swap_distribution(&mut self, distribution: Option<Arc<Distribution>>) -> Option<Arc<Distribution>> {
        let [first, second] = self.voices.both();
        drop(first.swap_distribution(distribution.clone()));
        second.swap_distribution(distribution)
    }

    /// Exchanges the user's speed field, in the same way. Without one, vortex sound of the flow `field` follows the
    /// scene that burns as the drive, or else the envelope.
    pub fn swap_field(&mut self, field: Option<Arc<SpeedField>>) -> Option<Arc<SpeedField>> {
        let [first, second] = self.voices.both();
        drop(first.vortex_layer().swap_field(field.clone()));
        second.vortex_layer().swap_field(field)
    }

    /// Installs the gas simulations for vortex sound of the flow `live`, one for the audible voice and one for the
    /// voice after a jump; `places` are the positions of their sources, in m to the right, to the front and up. Without
    /// simulations such vortex sound follows the envelope. Not for the audio thread.
    ///
    /// Fails without positions, and if one is not finite or farther than 100 km.
    pub fn set_simulators(&mut self, simulators: [Box<dyn Simulator>; 2], places: &[[f32; 3]]) -> Result<(), Error> {
        let mut voices = self.voices.both().iter_mut().zip(simulators);
        voices.try_for_each(|(voice, simulator)| voice.vortex_layer().set_simulator(simulator, places))
    }

    /// Seconds that a step of these simulations lasts, about 1/60.
    pub fn live_step_s(&mut self) -> f64 {
        self.voices.both()[0].vortex_layer().live_step_s()
    }

    /// Processes one block of any length in place. `main` has as many channels as the output; the first
    /// `channels.input` of them contain the input. A missing sidechain channel is silent. `controls` apply to the whole
    /// call.
    pub fn process(
        &mut self,
        main: &mut [&mut [f32]],
        sidechain: &[&[f32]],
        controls: &Controls,
        transport: Transport,
    ) {
        self.top_magnitudes.clear();
        self.drive.clear();
        let samples = main.iter().map(|x| x.len()).min().unwrap_or(0);
        if samples == 0 || main.len() < self.channels.output {
            return;
        }
        let voice = self.voices.either();
        let crossfade_samples = self.voices.crossfade_samples();
        self.silence.tail_samples =
            voice.tail_samples(controls) + crossfade_samples + self.mix.tail_samples(&controls.mix);
        self.silence.burns = voice.is_self_driven(controls);
        self.silence.is_endless = voice.is_endless(controls) || (self.has_dictionary && controls.texture.gate <= 0.0);
        let controls = &self.levelled(controls);
        self.voices.follow_transport(transport);
        let mut start = 0;
        while start < samples {
            // A takeover ends at its exact sample, however the host divides its blocks.
            let until_takeover = self.voices.until_takeover().unwrap_or(CHUNK);
            let end = samples.min(start + CHUNK.min(until_takeover));
            self.read_input(main, sidechain, start, end);
            self.process_voices(controls, end - start);
            self.mix_down(main, controls, start, end);
            self.voices.finish_takeover();
            start = end;
        }
    }

    /// `controls` with the levels that bring recording and fuel to the requested loudness, and keep crackles below the
    /// ceiling.
    fn levelled(&self, controls: &Controls) -> Controls {
        let mut levelled = *controls;
        let target_lufs = controls.mix.loudness_lufs;
        let fuel_gain = fuel::gain_to(target_lufs);
        levelled.mix.texture *= self.voices.either().gain_to(target_lufs);
        levelled.mix.crackle *= self.voices.either().crackle_gain_to(target_lufs);
        levelled.mix.hiss *= fuel_gain;
        levelled.mix.body *= fuel_gain;
        if controls.mix.ceiling {
            levelled.crackle.highest_peak = HIGHEST_PEAK / (levelled.mix.crackle * levelled.mix.output).max(1e-9);
        }
        levelled
    }

    fn read_input(&mut self, main: &[&mut [f32]], sidechain: &[&[f32]], start: usize, end: usize) {
        let peak = self.input.read_chunk(main, sidechain, start, end);
        self.meters.input = self.meters.input.max(peak);
        self.silence.add_input(peak);
    }

    fn process_voices(&mut self, controls: &Controls, samples: usize) {
        let mut main: [&[f64]; MAX_CHANNELS] = Default::default();
        let mut sidechain: [&[f64]; MAX_CHANNELS] = Default::default();
        for (block, channel) in main.iter_mut().zip(&self.input.main) {
            *block = &channel[..samples];
        }
        for (block, channel) in sidechain.iter_mut().zip(&self.input.sidechain) {
            *block = &channel[..samples];
        }
        let main = &main[..self.channels.input];
        let sidechain = &sidechain[..self.channels.sidechain];

        let newest = self.voices.process(main, sidechain, controls, samples);
        let drive = newest.drive_block(samples);
        self.meters.drive = drive.iter().fold(self.meters.drive, |peak, x| peak.max(x.abs() as f32));
        self.meters.scaling_alpha = newest.scaling_alpha() as f32;
        self.meters.cancels |= newest.cancels();
        for magnitude in newest.top_magnitudes() {
            if self.top_magnitudes.len() < REPORTED_CAPACITY {
                self.top_magnitudes.push(*magnitude);
            }
        }
        let room = REPORTED_CAPACITY - self.drive.len();
        self.drive.extend(drive.iter().take(room).map(|x| *x as f32));
    }

    fn mix_down(&mut self, main: &mut [&mut [f32]], controls: &Controls, start: usize, end: usize) {
        let samples = end - start;
        let audible = &self.voices.audible().layers;
        let layers = Layers {
            low: &audible.low[..samples],
            extension: &audible.extension,
            texture: &audible.texture,
            vortex: &audible.vortex,
            crackle: &audible.crackle,
            hiss: &audible.hiss,
            body: &audible.body,
            dry: &self.input.dry,
        };
        let mut outputs: [&mut [f32]; MAX_CHANNELS] = Default::default();
        for (output, channel) in outputs.iter_mut().zip(main.iter_mut()) {
            *output = &mut channel[start..end];
        }
        let peaks = self.mix.process(&layers, &controls.mix, &mut outputs[..self.channels.output]);
        self.meters.low = self.meters.low.max(peaks.low as f32);
        self.meters.extension = self.meters.extension.max(peaks.extension as f32);
        self.meters.texture = self.meters.texture.max(peaks.texture as f32);
        self.meters.vortex = self.meters.vortex.max(peaks.vortex as f32);
        self.meters.crackle = self.meters.crackle.max(peaks.crackle as f32);
        self.meters.hiss = self.meters.hiss.max(peaks.hiss as f32);
        self.meters.body = self.meters.body.max(peaks.body as f32);
        self.meters.output = self.meters.output.max(peaks.output as f32);
        self.silence.add_output(peaks.output, samples);
    }

    /// Returns the meters since the last call and clears them.
    pub fn take_meters(&mut self) -> Meters {
        let no_recording = !self.has_dictionary;
        let late_steps = self.voices.both().iter_mut().map(|voice| voice.vortex_layer().take_late_steps()).sum();
        Meters { no_recording, late_steps, ..std::mem::take(&mut self.meters) }
    }

    /// The drive, after its high-pass, in the last call of `process`; it is [`latency_samples`](Self::latency_samples)
    /// ahead of the output. Valid until the next call, and limited to the first 8192 samples of the call.
    pub fn drive(&self) -> &[f32] {
        &self.drive
    }

    /// Passes on the telemetry of the audible engines since the last call; real-time safe.
    pub fn take_traces(&mut self, with: impl FnMut(Telemetry)) {
        let (audible, other) = self.voices.audible_and_other();
        audible.take_traces().for_each(with);
        drop(other.take_traces());
    }

    /// Magnitudes of the drive pyramid's top level from the last call of `process` (in the companded mode, loudnesses
    /// of the drive), for learning a distribution from one pass; valid until the next call.
    pub fn top_level(&self) -> &[f64] {
        &self.top_magnitudes
    }
}

/// Learns the distribution of the drive's amplitudes from a whole file, as texture synthesis of this file would (with
/// reference padding); in the companded mode, of its loudnesses. `sidechain` may be empty. Fails if the file is too
/// short for the levels, or for one loudness.
pub fn learn(
    sample_rate_hz: f64,
    structure: &EngineConfig,
    controls: &Controls,
    input: &[Vec<f32>],
    sidechain: &[Vec<f32>],
) -> Result<Distribution, Error> {
    in_range("input channels", input.len() as f64, 1.0, MAX_CHANNELS as f64)?;
    in_range("sidechain channels", sidechain.len() as f64, 0.0, MAX_CHANNELS as f64)?;
    let samples = input.iter().map(Vec::len).min().unwrap_or(0);
    let wide = |channel: &Vec<f32>| -> Vec<f64> {
        let mut wide: Vec<f64> = channel.iter().map(|x| f64::from(clean(*x))).collect();
        wide.resize(samples, 0.0);
        wide
    };
    let main: Vec<Vec<f64>> = input.iter().map(wide).collect();
    let sidechain: Vec<Vec<f64>> = sidechain.iter().map(wide).collect();
    let mut drive = Drive::new(sample_rate_hz)?;
    drive.reset(0);
    let (mut signal, mut envelope) = (vec![0.0; samples], vec![0.0; samples]);
    let mut delay_s = None;
    for start in (0..samples).step_by(CHUNK) {
        let end = samples.min(start + CHUNK);
        let main: Vec<&[f64]> = main.iter().map(|x| &x[start..end]).collect();
        let sidechain: Vec<&[f64]> = sidechain.iter().map(|x| &x[start..end]).collect();
        let blocks = (&mut signal[start..end], &mut envelope[start..end]);
        delay_s = drive.process_with_envelope(&main, &sidechain, &controls.drive, blocks.0, blocks.1);
    }
    match structure.dynamics {
        MatchingMode::Paper => offline::learn(&signal, &PyramidConfig::at_rate(structure, sample_rate_hz)),
        MatchingMode::Companded => {
            let envelope = delay_s.map(|delay_s| DriveEnvelope { values: &envelope, delay_s });
            Ok(Distribution::from_magnitudes(loudnesses(&signal, envelope, sample_rate_hz)?))
        }
    }
}
