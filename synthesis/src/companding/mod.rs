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
//! | [`frames`] | loudness in frames, with look-ahead |
//! | [`level`] | the drive's overall level |
//! | [`loudnesses`] | loudnesses learned from a drive beforehand |
//! | [`profile`] | the recording's side |
//! | [`calibrate`] | its level and equaliser, found by a trial run |
//! | [`bands`] | spectra in third octaves |
//! | [`equalizer`] | towards the recording's spectrum |
//! | `image` | towards the recording's stereo image |
//! | `deck` | from the texture of one recording to its audible output |
//! | `recorded` | the recording behind a slot's texture |
//! | `gain` | the factor on texture |
//! | [`low_end`] | the drive's own low end |

pub mod bands;
pub mod calibrate;
mod deck;
pub mod equalizer;
pub mod frames;
mod gain;
mod image;
mod learn;
pub mod level;
pub mod low_end;
pub mod profile;
mod ramp;
mod recorded;

use std::ops::Range;

use crate::controls::{CompandingControls, DynamicRange, RecordingControls, SLOTS, TextureControls};
use crate::dsp::{Delay, Smoothed, Svf, Timeline, White, section_gain};
use crate::error::within;
use crate::texture::Distribution;
use deck::Deck;
use frames::{FrameHistory, Kernel, Places, frame_samples};
use gain::OutputGain;
pub use learn::loudnesses;
use level::{NOMINAL, RunningLevel};
use low_end::LowEnd;
use profile::MATCHED_HZ;
pub use profile::{MATCH_EXPONENT, Profile};
use ramp::Interpolator;
pub use recorded::Recorded;

/// Factor by which the drive is matched louder than the recording's mean: quiet windows are many, but fire is made of
/// loud ones.
const MATCH_FACTOR: f64 = 2.83;
/// Time constant of the loudness's power, in seconds: 8 Hz. 20 Hz was better on one flame and worse on another
/// (docs/sound.md).
const PAST_S: f64 = 0.02;
/// Look-ahead time constant of matching.
const MATCH_FUTURE_S: f64 = 0.02;
/// Look-ahead time constant of the output; slower, since flames swell and do not begin at full loudness.
const OUTPUT_FUTURE_S: f64 = 0.06;
/// Loudness relative to the drive's level below which matching no longer follows it: -40 dB.
const FLOOR: f64 = 0.01;
/// Level of an added noise, relative to the matched signal: -10 dB. When a drive pauses while its loudness still falls,
/// the match is then fire, not the same quiet window over and over.
const UNDERTONE: f64 = 0.32;
/// White-noise stream of that noise, which no other stage uses.
const UNDERTONE_SEED: u32 = 0x4649_5245;
const UNDERTONE_STREAM: u32 = 0x434F_4D50;
/// Loudness that counts as silence regardless of the drive, and the share of its level that does.
const SILENCE: f64 = 1e-6;
const SILENT_PART: f64 = 1e-3;
/// Range of the factor applied before matching.
const LEAST_MATCH: f64 = 0.01;
const MOST_MATCH: f64 = 100.0;
/// Time constant in seconds of all levels.
const SMOOTHING_S: f64 = 0.02;

/// Processing around texture synthesis in the companded mode.
#[derive(Debug)]
pub struct Companding {
    frame_samples: usize,
    low: Svf,
    low_gain: f64,
    power: f64,
    /// Samples in the present frame.
    filled: usize,
    /// Powers of the last frames, each stored twice so that they are always contiguous, oldest first.
    powers: Vec<f64>,
    newest: usize,
    kernels: [Kernel; 2],
    loudness: [FrameHistory; 2],
    running: RunningLevel,
    learned: Option<f64>,
    /// The drive's level as used, in nepers.
    level: Smoothed,
    is_level_fresh: bool,
    /// The drive's levels, given together with the loudnesses.
    levels: FrameHistory,
    dynamics: Smoothed,
    drive_match: Smoothed,
    flat_gain: Interpolator,
    /// Loudness of the present output, or of the output within the wait.
    heard: f64,
    output_gain: OutputGain,
    /// Shares of the recordings in the level of the low end.
    shares: [Smoothed; SLOTS],
    low_gain_ramp: Interpolator,
    wait: Delay<f64>,
    drive: Delay<f64>,
    drive_block: Vec<f64>,
    timeline: Timeline<TextureControls>,
    /// By slot.
    decks: [Deck; SLOTS],
    low_end: LowEnd,
    noise: White,
    /// Position on the host's timeline at reset, and offset into a frame of that timeline: frames are aligned with
    /// multiples of their length, so that two starts in one silence agree.
    position: i64,
    origin: i64,
    wait_samples: i64,
    latency_samples: i64,
    /// Samples processed since reset.
    now: i64,
    /// Loudnesses determined in the last call of [`compress`](Self::compress).
    told: Vec<f64>,
    relative: Interpolator,
    /// Loudness relative to the drive's level, for the samples of the last call of [`expand`](Self::expand).
    relative_block: Vec<f64>,
}

/// Largest number of loudnesses that one call leaves in `told`: more than arise in the longest piece that the plug-in
/// passes on, 8192 samples.
const TOLD_CAPACITY: usize = 8192;

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
        // A loudness must be known before the first sample beyond its frame's centre.
        let look_ahead = |samples: usize| (samples / frame_samples) as i64 - 2;
        let kernels = [
            Kernel::new(frame_rate_hz, look_ahead(wait_samples), MATCH_FUTURE_S, PAST_S),
            Kernel::new(frame_rate_hz, look_ahead(latency_samples), OUTPUT_FUTURE_S, PAST_S),
        ];
        let longest = kernels.iter().map(Kernel::span).max().unwrap_or(1);
        let track = || FrameHistory::new(latency_samples / frame_samples + 8, frame_samples, 0.0);
        let by_frame = Smoothed::new(SMOOTHING_S, frame_rate_hz);
        Self {
            frame_samples,
            low: Svf::default(),
            low_gain: section_gain(MATCHED_HZ, sample_rate_hz),
            power: 0.0,
            filled: 0,
            powers: vec![0.0; 2 * longest],
            newest: 0,
            loudness: [track(), track()],
            kernels,
            running: RunningLevel::new(frame_rate_hz),
            learned: None,
            level: by_frame,
            is_level_fresh: true,
            levels: FrameHistory::new(latency_samples / frame_samples + 8, frame_samples, NOMINAL),
            dynamics: by_frame,
            drive_match: by_frame,
            flat_gain: Interpolator::default(),
            heard: 0.0,
            output_gain: OutputGain::default(),
            shares: [by_frame; SLOTS],
            low_gain_ramp: Interpolator::default(),
            wait: Delay::new(wait_samples),
            drive: Delay::new(latency_samples),
            drive_block: vec![0.0; block],
            timeline: Timeline::new(latency_samples + 1, TextureControls::default()),
            decks: std::array::from_fn(|slot| Deck::new(slot, sample_rate_hz, channels, block)),
            low_end: LowEnd::new(sample_rate_hz, channels),
            noise: White::new(UNDERTONE_SEED, UNDERTONE_STREAM),
            position: 0,
            origin: 0,
            wait_samples: wait_samples as i64,
            latency_samples: latency_samples as i64,
            now: 0,
            told: Vec::with_capacity(TOLD_CAPACITY),
            relative: Interpolator::default(),
            relative_block: vec![0.0; block],
        }
    }

    /// Resets to silence at `position` of the host's timeline; the learned distribution stays.
    pub fn reset(&mut self, position: i64) {
        self.position = position;
        self.origin = position.rem_euclid(self.frame_samples as i64);
        self.low.reset();
        self.power = 0.0;
        self.filled = self.origin as usize;
        self.powers.fill(0.0);
        self.newest = 0;
        self.loudness.iter_mut().for_each(FrameHistory::reset);
        self.running.reset();
        self.is_level_fresh = true;
        self.levels.reset();
        for ramp in [&mut self.flat_gain, &mut self.low_gain_ramp, &mut self.relative] {
            *ramp = Interpolator::default();
        }
        self.output_gain = OutputGain::default();
        self.wait.reset();
        self.drive.reset();
        self.timeline.reset(TextureControls::default());
        self.decks.iter_mut().for_each(Deck::reset);
        self.low_end.reset();
        self.now = 0;
        self.heard = 0.0;
        self.told.clear();
    }

    /// Samples for which it continues after texture has fallen silent.
    pub fn tail_samples(&self) -> usize {
        self.kernels[1].span() * self.frame_samples + self.decks.iter().map(Deck::tail_samples).max().unwrap_or(0)
    }

    /// Sets the distribution of the drive's loudness, learned beforehand.
    pub fn set_learned(&mut self, learned: Option<&Distribution>) {
        self.learned = learned.and_then(Distribution::loudness);
    }

    /// Loudnesses determined in the last call of [`compress`](Self::compress), for learning.
    pub fn told(&self) -> &[f64] {
        &self.told
    }

    /// Processes a block of the drive. Writes the signal that texture should match, and the drive's loudness, both
    /// delayed by the wait. `controls` apply to the whole block.
    pub fn compress(
        &mut self,
        drive: &[f64],
        controls: &TextureControls,
        profile: Option<&Profile>,
        flat: &mut [f64],
        loudness: &mut [f64],
    ) {
        if self.timeline.end() == 0 {
            self.timeline.reset(*controls);
            self.start(controls);
        }
        self.timeline.push(*controls, drive.len());
        self.told.clear();
        self.drive_block[..drive.len()].copy_from_slice(drive);
        flat.copy_from_slice(drive);
        self.wait.process(flat);
        let undertone = UNDERTONE * MATCH_FACTOR * profile.map_or(0.0, |profile| profile.matched_rms);
        let mut places = self.places(self.now - self.wait_samples, 0);
        for (i, sample) in drive.iter().enumerate() {
            self.measure(*sample, controls);
            let gain = self.flat_gain_at(places.step(), profile);
            flat[i] = flat[i] * gain + undertone * self.noise.at(self.position.wrapping_add(self.now));
            loudness[i] = self.heard;
            self.now += 1;
        }
    }

    /// The controls for texture from sample `start` of the last block on, and the sample up to which they apply.
    pub fn controls_from(&self, start: usize, samples: usize) -> (TextureControls, usize) {
        let (controls, end) = self.run(start, samples, self.wait_samples);
        // Loudness is matched already; the remaining range is mapped with the running estimate.
        let dynamic_range = match controls.dynamic_range {
            DynamicRange::Off => DynamicRange::Off,
            DynamicRange::Learned | DynamicRange::Running => DynamicRange::Running,
        };
        (TextureControls { dynamic_range, ..controls }, end)
    }

    /// Loudness of the drive, relative to its overall level, at the samples of the last call of
    /// [`expand`](Self::expand); 0 below the gate.
    pub fn heard(&self, samples: usize) -> &[f64] {
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
            let (controls, end) = self.run(start, samples, self.latency_samples);
            let mut places = self.places(self.now - (samples - start) as i64 - self.latency_samples, 1);
            for (i, drive) in drive.iter_mut().enumerate().take(end).skip(start) {
                let place = places.step();
                self.follow_output(place, &controls);
                for ((texture, recorded), deck) in textures.iter_mut().zip(recordings).zip(&mut self.decks) {
                    if deck.is_on(recorded) {
                        let gain = self.output_gain.at(place.1, deck.level(recorded));
                        texture.iter_mut().for_each(|channel| channel[i] *= gain);
                        if recorded.has_floor() {
                            deck.set_floor_gain(i, self.output_gain.at(place.1, 1.0));
                        }
                    }
                }
                self.relative_block[i] = self.relative_at(place, &controls);
                *drive *= self.low_gain_at(place, &controls, recordings);
            }
            let position = self.position.wrapping_add(self.now - samples as i64);
            self.play_decks(&controls.companding, recordings, textures, start..end, position);
            start = end;
        }
        self.sum(recordings, textures, channels);
        let mut start = 0;
        while start < samples {
            let (controls, end) = self.run(start, samples, self.latency_samples);
            self.low_end.aim(controls.companding.low_end_hz);
            for (i, drive) in drive.iter().enumerate().take(end).skip(start) {
                self.low_end.process(*drive, channels, i);
            }
            start = end;
        }
        self.drive_block = drive;
    }

    /// Adds up the audible recordings by channel, each with its factor.
    fn sum(&self, recordings: &[Recorded<'_>; SLOTS], textures: &[&mut [&mut [f64]]], channels: &mut [&mut [f64]]) {
        for (index, channel) in channels.iter_mut().enumerate() {
            let mut is_first = true;
            for ((texture, of), deck) in textures.iter().zip(recordings).zip(&self.decks) {
                let Some(texture) = texture.get(index).filter(|_| deck.is_on(of)) else { continue };
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
    fn play_decks(
        &mut self,
        controls: &CompandingControls,
        recordings: &[Recorded<'_>; SLOTS],
        textures: &mut [&mut [&mut [f64]]],
        range: Range<usize>,
        position: i64,
    ) {
        let spectrum_match = within(controls.spectrum_match, 0.0, 1.0);
        for ((texture, recorded), deck) in textures.iter_mut().zip(recordings).zip(&mut self.decks) {
            deck.process(recorded, spectrum_match, texture, range.clone(), position);
        }
    }

    /// Applies the first block's controls at once.
    fn start(&mut self, controls: &TextureControls) {
        self.dynamics.value = within(controls.companding.dynamics, 0.0, 1.0);
        self.drive_match.value = within(controls.companding.drive_match, LEAST_MATCH, MOST_MATCH);
        for (share, wanted) in self.shares.iter_mut().zip(shares(&controls.recordings)) {
            share.value = wanted;
        }
    }

    /// Controls in force `delay` samples before sample `start` of the last block of `samples`, and the sample of the
    /// block up to which they apply.
    fn run(&self, start: usize, samples: usize, delay: i64) -> (TextureControls, usize) {
        let first = self.now - samples as i64 - delay;
        let (controls, end) = self.timeline.run_at((first + start as i64).max(0) as u64);
        let end = i64::try_from(end).unwrap_or(i64::MAX).saturating_sub(first);
        (controls, end.clamp(start as i64 + 1, samples as i64) as usize)
    }

    /// The frames whose loudness applies at `sample` since reset and afterwards: those determined after their future
    /// arrived.
    fn places(&self, sample: i64, kernel: usize) -> Places {
        self.loudness[kernel].places(sample + self.origin).later(self.kernels[kernel].look_ahead())
    }

    /// Measures one sample of the drive.
    fn measure(&mut self, sample: f64, controls: &TextureControls) {
        let low = self.low.process(self.low_gain, sample).low;
        self.power += low * low;
        self.filled += 1;
        if self.filled < self.frame_samples {
            return;
        }
        let length = self.powers.len() / 2;
        self.powers[self.newest] = self.power / self.frame_samples as f64;
        self.powers[self.newest + length] = self.powers[self.newest];
        self.newest = (self.newest + 1) % length;
        self.power = 0.0;
        self.filled = 0;
        let last = self.newest + length;
        let coming = (self.wait_samples as usize).div_ceil(self.frame_samples).clamp(1, length);
        let peak = self.powers[last - coming..last].iter().fold(0.0f64, |most, power| most.max(*power)).sqrt();
        for (kernel, track) in self.kernels.iter().zip(&mut self.loudness) {
            track.push(kernel.loudness(&self.powers[last - kernel.span()..last]));
        }
        let told = self.loudness[0].newest();
        // Powers within the wait belong to sound that has yet to reach texture: its gate must open before they do.
        self.heard = told.max(peak);
        if self.told.len() < TOLD_CAPACITY {
            self.told.push(told);
        }
        let least = if self.running.is_fresh() { SILENCE } else { SILENCE.max(SILENT_PART * self.running.level()) };
        // A layer that is off has an infinite threshold; its level is followed all the same.
        let gate = if controls.gate.is_finite() { controls.gate } else { 0.0 };
        if told > least.max(gate) {
            self.running.push(told);
        }
        self.follow_level(controls);
    }

    fn follow_level(&mut self, controls: &TextureControls) {
        let level = match (controls.dynamic_range, self.learned) {
            (DynamicRange::Off, _) => NOMINAL,
            (DynamicRange::Learned, Some(learned)) => learned,
            (DynamicRange::Learned | DynamicRange::Running, _) => self.running.level(),
        };
        if std::mem::take(&mut self.is_level_fresh) {
            self.level.value = maths::ln(level);
        }
        self.levels.push(maths::exp(self.level.next(maths::ln(level))));
    }

    fn flat_gain_at(&mut self, place: (i64, f64), profile: Option<&Profile>) -> f64 {
        let Self { flat_gain, loudness, levels, drive_match, timeline, frame_samples, kernels, origin, .. } = self;
        flat_gain.at(place, |frame| {
            let sample = (frame - kernels[0].look_ahead()) * *frame_samples as i64 - *origin;
            let controls = timeline.at(sample.max(0) as u64);
            let (loudness, level) = (loudness[0].frame(frame), levels.frame(frame));
            let matched = drive_match.next(within(controls.companding.drive_match, LEAST_MATCH, MOST_MATCH));
            let target = MATCH_FACTOR * profile.map_or(0.0, |profile| profile.matched_rms) / level;
            matched
                * target
                * maths::pow((loudness / level).max(FLOOR), -MATCH_EXPONENT)
                * audible(loudness, controls.gate)
        })
    }

    /// The drive's loudness relative to its level.
    fn relative_at(&mut self, place: (i64, f64), controls: &TextureControls) -> f64 {
        let Self { relative, loudness, levels, .. } = self;
        // Audibility of texture does not matter here; silence is silence even without a gate.
        let gate = if controls.gate.is_finite() { controls.gate.max(SILENCE) } else { SILENCE };
        relative.at(place, |frame| {
            let loudness = loudness[1].frame(frame);
            loudness / levels.frame(frame) * audible(loudness, gate)
        })
    }

    /// Moves to the frames at `place`, whose loudness texture should have.
    fn follow_output(&mut self, place: (i64, f64), controls: &TextureControls) {
        let Self { output_gain, loudness, levels, dynamics, .. } = self;
        output_gain.go_to(place.0, |frame| {
            let (loudness, level) = (loudness[1].frame(frame), levels.frame(frame));
            let exponent = dynamics.next(within(controls.companding.dynamics, 0.0, 1.0));
            [maths::pow(loudness / level, exponent), audible(loudness, controls.gate)]
        });
    }

    /// Factor for the drive's low end, which brings it to the level of the recordings' own.
    fn low_gain_at(
        &mut self,
        place: (i64, f64),
        controls: &TextureControls,
        recordings: &[Recorded<'_>; SLOTS],
    ) -> f64 {
        let Self { low_gain_ramp, levels, shares, .. } = self;
        let crossover_hz = within(controls.companding.low_end_hz, low_end::LOWEST_HZ, low_end::HIGHEST_HZ);
        let wanted = self::shares(&controls.recordings);
        low_gain_ramp.at(place, |frame| {
            let mut below = 0.0;
            for ((share, wanted), recorded) in shares.iter_mut().zip(wanted).zip(recordings) {
                let share = share.next(wanted);
                let own = recorded.profile.map_or(0.0, |profile| profile.rms_below(crossover_hz));
                below += share * recorded.gain * own;
            }
            below / levels.frame(frame)
        })
    }
}

/// Shares of the slots' recordings.
fn shares(recordings: &RecordingControls) -> [f64; SLOTS] {
    let mut shares = [0.0; SLOTS];
    shares[recordings.first()] = 1.0;
    if let Some((slot, share)) = recordings.other(|_| true) {
        shares[recordings.first()] -= share;
        shares[slot] = share;
    }
    shares
}

/// Fades a loudness out towards the gate's threshold: 1 far above, 0 below.
fn audible(loudness: f64, threshold: f64) -> f64 {
    if loudness <= threshold || loudness <= 0.0 {
        return 0.0;
    }
    (1.0 - maths::square(threshold / loudness)).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: f64 = 44_100.0;
    const BLOCK: usize = 500;

    /// The matched signal, and the factor on texture, while the controls go back and forth.
    fn run(calm: &TextureControls, moved: &TextureControls) -> [Vec<f64>; 2] {
        let mut noise = vec![0.0; 30_000];
        White::new(1, 2).fill(0, &mut noise);
        let (_, profile) = Profile::compress(&mut [noise], RATE_HZ);
        let mut companding = Companding::new(RATE_HZ, 1, 900, 2048, BLOCK);
        let (mut flats, mut gains) = (vec![], vec![]);
        for block in 0..200 {
            let drive: Vec<f64> = (0..BLOCK)
                .map(|i| 0.5 * (2.0 * std::f64::consts::PI * 50.0 * (block * BLOCK + i) as f64 / RATE_HZ).sin())
                .collect();
            let (mut flat, mut loudness, mut gain) = (vec![0.0; BLOCK], vec![0.0; BLOCK], vec![1.0; BLOCK]);
            let controls = if block / 20 % 2 == 0 { calm } else { moved };
            companding.compress(&drive, controls, Some(&profile), &mut flat, &mut loudness);
            companding.expand_one(Some(&profile), &mut [&mut gain]);
            flats.extend(flat);
            gains.extend(gain);
        }
        [flats, gains]
    }

    #[test]
    fn no_control_makes_a_step() {
        let calm = TextureControls {
            companding: CompandingControls { low_end_hz: 0.0, ..CompandingControls::default() },
            ..TextureControls::default()
        };
        let with = |change: &dyn Fn(&mut TextureControls)| {
            let mut moved = calm;
            change(&mut moved);
            run(&calm, &moved)
        };
        let step = |signal: &[f64]| signal[20_000..].windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0, f64::max);
        let largest = |signal: &[f64]| signal[20_000..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
        let still = run(&calm, &calm);
        let changes: [&dyn Fn(&mut TextureControls); 3] = [
            &|controls| controls.companding.dynamics = 0.0,
            &|controls| controls.companding.drive_match = 4.0,
            &|controls| controls.dynamic_range = DynamicRange::Off,
        ];
        for (number, change) in changes.iter().enumerate() {
            let moving = with(change);
            assert_ne!(moving, still, "change {number} does something");
            // 20 ms: a thousandth of the way, about, in every sample.
            let gain = &moving[1];
            assert!(step(gain) < 3e-3 * largest(gain), "change {number}: {} of {}", step(gain), largest(gain));
            let (flat, calm) = (step(&moving[0]) / largest(&moving[0]), step(&still[0]) / largest(&still[0]));
            assert!(flat < 1.1 * calm, "change {number}: {flat} against {calm}");
        }
    }
}
