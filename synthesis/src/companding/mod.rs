//! Companded matching: texture in a domain without slow loudness.
//!
//! A drive's loudness varies far more than a recording's. The slow loudness is therefore removed from both, windows are
//! matched in that flattened domain, and the drive's loudness is restored:
//!
//! ```text
//! drive ── wait ── / loudness^0.6 ── texture ── * loudness^g ── equaliser ── low end ── out
//!                                       │                                       │
//!       at load: recording / loudness^0.6                         drive, delayed
//! ```
//!
//! Loudness looks ahead within the latency that the effect has anyway. The paper (Chadwick & James 2011, §5.3) maps
//! amplitudes window by window instead; see [`crate::structure::MatchingMode`].
//!
//! | module | content |
//! |---|---|
//! | [`frames`], `loudness_meter` | loudness in frames, with look-ahead |
//! | [`level`], `drive_level` | the drive's overall level |
//! | [`loudnesses`] | loudnesses learned from a drive beforehand |
//! | [`profile`] | the recording's side |
//! | [`calibrate`] | its level and equaliser, found by a trial run |
//! | [`bands`] | spectra in third octaves |
//! | [`equalizer`] | towards the recording's spectrum |
//! | `image` | towards the recording's stereo image |
//! | `recording_filters` | from the texture of one recording to its audible output |
//! | `recorded` | the recording behind a slot's texture |
//! | `gains`, `output_gain`, `interpolator` | the factors that remove and restore loudness |
//! | [`low_end`] | the drive's own low end |

pub mod bands;
pub mod calibrate;
mod drive_level;
pub mod equalizer;
pub mod frames;
mod gains;
mod image;
mod interpolator;
mod learn;
pub mod level;
mod loudness_meter;
pub mod low_end;
mod output_gain;
pub mod profile;
mod recorded;
mod recording_filters;

use std::ops::Range;

use crate::controls::{CompandingControls, DynamicRange, SLOTS, TextureControls};
use crate::dsp::{Delay, Timeline, White};
use crate::error::within;
use crate::texture::Distribution;
use drive_level::DriveLevel;
use frames::frame_samples;
use gains::{Gains, MATCH_FACTOR};
pub use learn::loudnesses;
use loudness_meter::{FrameLoudness, LoudnessMeter, Use};
use low_end::LowEnd;
pub use profile::{MATCH_EXPONENT, Profile};
pub use recorded::Recorded;
use recording_filters::RecordingFilters;

/// Level of an added noise, relative to the matched signal: -10 dB. When a drive pauses while its loudness still falls,
/// the match is then fire, not the same quiet window over and over.
const MATCH_NOISE: f64 = 0.32;
/// White-noise stream of that noise, which no other stage uses.
const MATCH_NOISE_SEED: u32 = 0x4649_5245;
const MATCH_NOISE_STREAM: u32 = 0x434F_4D50;

/// The envelope that a drive was made from: its loudness, without the chance of the drive's own noise.
#[derive(Debug, Clone, Copy)]
pub struct DriveEnvelope<'a> {
    /// Amplitudes, one for each sample of the drive.
    pub values: &'a [f64],
    /// Time in seconds by which they follow the sound that they envelop; made good as far as the look-ahead allows.
    pub delay_s: f64,
}

/// A block of the drive, and of the envelope that it was made from, if there is one.
#[derive(Debug, Clone, Copy)]
pub struct DriveBlock<'a> {
    /// The drive.
    pub samples: &'a [f64],
    /// Its envelope.
    pub envelope: Option<DriveEnvelope<'a>>,
}

impl<'a> DriveBlock<'a> {
    /// A drive without an envelope.
    pub fn of(samples: &'a [f64]) -> Self {
        Self { samples, envelope: None }
    }
}

/// Processing around texture synthesis in the companded mode.
#[derive(Debug)]
pub struct Companding {
    meter: LoudnessMeter,
    drive_level: DriveLevel,
    gains: Gains,
    /// Loudness of the present output, or of the output within the wait.
    gate_loudness: f64,
    wait: Delay<f64>,
    drive: Delay<f64>,
    drive_block: Vec<f64>,
    timeline: Timeline<TextureControls>,
    /// By slot.
    filters: [RecordingFilters; SLOTS],
    low_end: LowEnd,
    noise: White,
    clock: Clock,
    /// Loudnesses determined in the last call of [`compress`](Self::compress).
    measured: Vec<f64>,
    /// Loudness relative to the drive's level, for the samples of the last call of [`expand`](Self::expand).
    relative_block: Vec<f64>,
}

/// Present sample, and the delays after which it arrives.
#[derive(Debug)]
struct Clock {
    /// Position on the host's timeline at reset.
    position: i64,
    wait_samples: i64,
    latency_samples: i64,
    /// Samples processed since reset.
    now: i64,
}

/// Largest number of loudnesses that one call leaves in `measured`: more than arise in the longest piece that the plug-in
/// passes on, 8192 samples.
const MEASURED_CAPACITY: usize = 8192;

impl Companding {
    /// Companding for texture with a delay of `latency_samples` after the drive, of which `wait_samples` precede
    /// texture. Blocks have up to `block` samples.
    pub fn new(
        sample_rate_hz: f64,
        channels: usize,
        wait_samples: usize,
        latency_samples: usize,
        block: usize,
    ) -> Self {
        let frame_samples = frame_samples(sample_rate_hz);
        let frame_rate_hz = sample_rate_hz / frame_samples as f64;
        Self {
            meter: LoudnessMeter::new(sample_rate_hz, wait_samples, latency_samples),
            drive_level: DriveLevel::new(latency_samples / frame_samples + 8, frame_samples, frame_rate_hz),
            gains: Gains::new(frame_rate_hz),
            gate_loudness: 0.0,
            wait: Delay::new(wait_samples),
            drive: Delay::new(latency_samples),
            drive_block: vec![0.0; block],
            timeline: Timeline::new(latency_samples + 1, TextureControls::default()),
            filters: std::array::from_fn(|slot| RecordingFilters::new(slot, sample_rate_hz, channels, block)),
            low_end: LowEnd::new(sample_rate_hz, channels),
            noise: White::new(MATCH_NOISE_SEED, MATCH_NOISE_STREAM),
            clock: Clock {
                position: 0,
                wait_samples: wait_samples as i64,
                latency_samples: latency_samples as i64,
                now: 0,
            },
            measured: Vec::with_capacity(MEASURED_CAPACITY),
            relative_block: vec![0.0; block],
        }
    }

    /// Resets to silence at `position` of the host's timeline; the learned distribution stays.
    pub fn reset(&mut self, position: i64) {
        self.meter.reset(position);
        self.drive_level.reset();
        self.gains.reset();
        self.wait.reset();
        self.drive.reset();
        self.timeline.reset(TextureControls::default());
        self.filters.iter_mut().for_each(RecordingFilters::reset);
        self.low_end.reset();
        self.clock = Clock { position, now: 0, ..self.clock };
        self.gate_loudness = 0.0;
        self.measured.clear();
    }

    /// Samples for which it continues after texture has fallen silent.
    pub fn tail_samples(&self) -> usize {
        self.meter.tail_samples() + self.filters.iter().map(RecordingFilters::tail_samples).max().unwrap_or(0)
    }

    /// Sets the distribution of the drive's loudness, learned beforehand.
    pub fn set_learned(&mut self, learned: Option<&Distribution>) {
        self.drive_level.learned = learned.and_then(Distribution::loudness);
    }

    /// Loudnesses determined in the last call of [`compress`](Self::compress), for learning.
    pub fn measured_loudnesses(&self) -> &[f64] {
        &self.measured
    }

    /// Processes a block of the drive. Writes the signal that texture should match, and the drive's loudness, both
    /// delayed by the wait. `controls` apply to the whole block. Loudness is measured from the drive, or from the
    /// envelope that it was made from.
    pub fn compress(
        &mut self,
        DriveBlock { samples: drive, envelope }: DriveBlock<'_>,
        controls: &TextureControls,
        profile: Option<&Profile>,
        flat: &mut [f64],
        loudness: &mut [f64],
    ) {
        if self.timeline.end() == 0 {
            self.timeline.reset(*controls);
            self.gains.start(controls);
        }
        self.timeline.push(*controls, drive.len());
        self.measured.clear();
        self.drive_block[..drive.len()].copy_from_slice(drive);
        flat.copy_from_slice(drive);
        self.wait.process(flat);
        let delay_frames = envelope.map_or(0, |envelope| self.meter.frames(envelope.delay_s));
        let match_noise = MATCH_NOISE * MATCH_FACTOR * profile.map_or(0.0, |profile| profile.matched_rms);
        let mut positions = self.meter.positions(self.clock.now - self.clock.wait_samples, Use::Match);
        for (i, sample) in drive.iter().enumerate() {
            let own = envelope.map(|envelope| envelope.values[i]);
            self.measure(*sample, own, delay_frames, controls);
            let drive = (&self.meter, &self.drive_level);
            let gain = self.gains.flat_at(positions.step(), drive, &self.timeline, profile);
            let position = self.clock.position.wrapping_add(self.clock.now);
            flat[i] = flat[i] * gain + match_noise * self.noise.sample_at(position);
            loudness[i] = self.gate_loudness;
            self.clock.now += 1;
        }
    }

    /// The controls for texture from sample `start` of the last block on, and the sample up to which they apply.
    pub fn controls_from(&self, start: usize, samples: usize) -> (TextureControls, usize) {
        let (controls, end) = self.run(start, samples, self.clock.wait_samples);
        // Loudness is matched already; the remaining range is mapped with the running estimate.
        let dynamic_range = match controls.dynamic_range {
            DynamicRange::Off => DynamicRange::Off,
            DynamicRange::Learned | DynamicRange::Running => DynamicRange::Running,
        };
        (TextureControls { dynamic_range, ..controls }, end)
    }

    /// Loudness of the drive, relative to its overall level, at the samples of the last call of
    /// [`expand`](Self::expand); 0 below the gate.
    pub fn relative_loudness(&self, samples: usize) -> &[f64] {
        &self.relative_block[..samples]
    }

    /// Restores the drive's loudness in the texture of the last block: `textures` by slot and channel, made from
    /// `recordings`. Writes their sum, with the drive's low end, to `channels`.
    pub fn expand(
        &mut self,
        recordings: &[Recorded<'_>; SLOTS],
        textures: &mut [&mut [&mut [f64]]],
        channels: &mut [&mut [f64]],
    ) {
        let samples = channels.first().map_or(0, |channel| channel.len());
        let mut drive = std::mem::take(&mut self.drive_block);
        self.drive.process(&mut drive[..samples]);
        let mut start = 0;
        while start < samples {
            let (controls, end) = self.run(start, samples, self.clock.latency_samples);
            let first = self.clock.now - (samples - start) as i64 - self.clock.latency_samples;
            let mut positions = self.meter.positions(first, Use::Output);
            for (i, drive) in drive.iter_mut().enumerate().take(end).skip(start) {
                let position = positions.step();
                let measured = (&self.meter, &self.drive_level);
                self.gains.follow_output(position, measured, &controls);
                for ((texture, recorded), filters) in textures.iter_mut().zip(recordings).zip(&mut self.filters) {
                    if filters.is_on(recorded) {
                        let gain = self.gains.output.gain_at(position.1, filters.level(recorded));
                        texture.iter_mut().for_each(|channel| channel[i] *= gain);
                        if recorded.has_floor() {
                            filters.set_floor_gain(i, self.gains.output.gain_at(position.1, 1.0));
                        }
                    }
                }
                self.relative_block[i] = self.gains.relative_at(position, measured, &controls);
                *drive *= self.gains.low_end_at(position, &self.drive_level, &controls, recordings);
            }
            let position = self.clock.position.wrapping_add(self.clock.now - samples as i64);
            self.filter(&controls.companding, recordings, textures, start..end, position);
            start = end;
        }
        self.sum(recordings, textures, channels);
        let mut start = 0;
        while start < samples {
            let (controls, end) = self.run(start, samples, self.clock.latency_samples);
            self.low_end.aim(controls.companding.low_end_hz);
            self.low_end.process(&drive, channels, start..end);
            start = end;
        }
        self.drive_block = drive;
    }

    /// Adds up the audible recordings by channel, each with its factor.
    fn sum(&self, recordings: &[Recorded<'_>; SLOTS], textures: &[&mut [&mut [f64]]], channels: &mut [&mut [f64]]) {
        for (index, channel) in channels.iter_mut().enumerate() {
            let mut is_first = true;
            for ((texture, of), filters) in textures.iter().zip(recordings).zip(&self.filters) {
                let Some(texture) = texture.get(index).filter(|_| filters.is_on(of)) else { continue };
                let parts = channel.iter_mut().zip(texture.iter());
                match std::mem::take(&mut is_first) {
                    true => parts.for_each(|(sum, x)| *sum = x * of.gain),
                    false => parts.for_each(|(sum, x)| *sum += x * of.gain),
                }
            }
            if is_first {
                channel.fill(0.0);
            }
        }
    }

    /// The same for one recording, in place; allocates.
    pub(super) fn expand_one(&mut self, profile: Option<&Profile>, channels: &mut [&mut [f64]]) {
        let mut texture: Vec<Vec<f64>> = channels.iter().map(|channel| channel.to_vec()).collect();
        let mut blocks: Vec<&mut [f64]> = texture.iter_mut().map(Vec::as_mut_slice).collect();
        let mut recordings = [Recorded::default(); SLOTS];
        recordings[0].profile = profile;
        self.expand(&recordings, &mut [&mut blocks], channels);
    }

    /// Applies each recording's filters to its texture in a range of the block, whose first sample is at `position`.
    fn filter(
        &mut self,
        controls: &CompandingControls,
        recordings: &[Recorded<'_>; SLOTS],
        textures: &mut [&mut [&mut [f64]]],
        range: Range<usize>,
        position: i64,
    ) {
        let spectrum_match = within(controls.spectrum_match, 0.0, 1.0);
        for ((texture, recorded), filters) in textures.iter_mut().zip(recordings).zip(&mut self.filters) {
            filters.process(recorded, spectrum_match, texture, range.clone(), position);
        }
    }

    /// Controls in force `delay` samples before sample `start` of the last block of `samples`, and the sample of the
    /// block up to which they apply.
    fn run(&self, start: usize, samples: usize, delay: i64) -> (TextureControls, usize) {
        let first = self.clock.now - samples as i64 - delay;
        let (controls, end) = self.timeline.run_at((first + start as i64).max(0) as u64);
        let end = i64::try_from(end).unwrap_or(i64::MAX).saturating_sub(first);
        (controls, end.clamp(start as i64 + 1, samples as i64) as usize)
    }

    /// Measures one sample of the drive, or the same sample of its envelope, which is `delay_frames` late.
    fn measure(&mut self, sample: f64, envelope: Option<f64>, delay_frames: i64, controls: &TextureControls) {
        let measured = self.meter.measure(sample, envelope.map(|value| (value, delay_frames)));
        let Some(FrameLoudness { loudness, coming }) = measured else { return };
        // Its gate must open before the sound that is coming reaches texture.
        self.gate_loudness = loudness.max(coming);
        if self.measured.len() < MEASURED_CAPACITY {
            self.measured.push(loudness);
        }
        self.drive_level.push(loudness, controls);
    }
}

#[cfg(test)]
mod tests;
