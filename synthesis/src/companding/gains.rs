//! The factors that remove and restore loudness, by frames.

use super::drive_level::DriveLevel;
use super::interpolator::Interpolator;
use super::level::{SILENCE, SMOOTHING_S};
use super::loudness_meter::{LoudnessMeter, Use};
use super::low_end::{HIGHEST_HZ, LOWEST_HZ};
use super::output_gain::OutputGain;
use super::profile::{MATCH_EXPONENT, Profile};
use super::recorded::Recorded;
use crate::controls::{RecordingControls, SLOTS, TextureControls};
use crate::dsp::{Smoothed, Timeline};
use crate::error::within;

/// Factor by which the drive is matched louder than the recording's mean: quiet windows are many, but fire is made of
/// loud ones.
pub(super) const MATCH_FACTOR: f64 = 2.83;
/// Loudness relative to the drive's level below which matching no longer follows it: -40 dB.
const FLOOR: f64 = 0.01;
/// Range of the factor applied before matching.
const LEAST_MATCH: f64 = 0.01;
const MOST_MATCH: f64 = 100.0;

/// All gains of companding.
#[derive(Debug)]
pub(super) struct Gains {
    dynamics: Smoothed,
    drive_match: Smoothed,
    /// Shares of the recordings in the level of the low end.
    shares: [Smoothed; SLOTS],
    flat: Interpolator,
    low_end: Interpolator,
    relative: Interpolator,
    /// The factor on texture.
    pub output: OutputGain,
}

impl Gains {
    /// Gains whose controls are smoothed over frames.
    pub fn new(frame_rate_hz: f64) -> Self {
        let by_frame = Smoothed::new(SMOOTHING_S, frame_rate_hz);
        Self {
            dynamics: by_frame,
            drive_match: by_frame,
            shares: [by_frame; SLOTS],
            flat: Interpolator::default(),
            low_end: Interpolator::default(),
            relative: Interpolator::default(),
            output: OutputGain::default(),
        }
    }

    /// Forgets all frames.
    pub fn reset(&mut self) {
        for gain in [&mut self.flat, &mut self.low_end, &mut self.relative] {
            *gain = Interpolator::default();
        }
        self.output = OutputGain::default();
    }

    /// Applies the first block's controls at once.
    pub fn start(&mut self, controls: &TextureControls) {
        self.dynamics.value = within(controls.companding.dynamics, 0.0, 1.0);
        self.drive_match.value = within(controls.companding.drive_match, LEAST_MATCH, MOST_MATCH);
        for (share, wanted) in self.shares.iter_mut().zip(shares(&controls.recordings)) {
            share.value = wanted;
        }
    }

    /// The factor that makes the drive flat.
    pub fn flat_at(
        &mut self,
        position: (i64, f64),
        (meter, drive_level): (&LoudnessMeter, &DriveLevel),
        timeline: &Timeline<TextureControls>,
        profile: Option<&Profile>,
    ) -> f64 {
        let drive_match = &mut self.drive_match;
        self.flat.value_at(position, |frame| {
            let controls = timeline.value_at(meter.matched_sample(frame).max(0) as u64);
            let (loudness, level) = (meter.loudness(frame, Use::Match), drive_level.at_frame(frame));
            let matched = drive_match.next(within(controls.companding.drive_match, LEAST_MATCH, MOST_MATCH));
            let target = MATCH_FACTOR * profile.map_or(0.0, |profile| profile.matched_rms) / level;
            matched
                * target
                * maths::pow((loudness / level).max(FLOOR), -MATCH_EXPONENT)
                * audible(loudness, controls.gate)
        })
    }

    /// The drive's loudness relative to its level.
    pub fn relative_at(
        &mut self,
        position: (i64, f64),
        (meter, drive_level): (&LoudnessMeter, &DriveLevel),
        controls: &TextureControls,
    ) -> f64 {
        // Audibility of texture does not matter here; silence is silence even without a gate.
        let gate = if controls.gate.is_finite() { controls.gate.max(SILENCE) } else { SILENCE };
        self.relative.value_at(position, |frame| {
            let loudness = meter.loudness(frame, Use::Output);
            loudness / drive_level.at_frame(frame) * audible(loudness, gate)
        })
    }

    /// Moves to the frames at `position`, whose loudness texture should have.
    pub fn follow_output(
        &mut self,
        position: (i64, f64),
        (meter, drive_level): (&LoudnessMeter, &DriveLevel),
        controls: &TextureControls,
    ) {
        let dynamics = &mut self.dynamics;
        self.output.go_to(position.0, |frame| {
            let (loudness, level) = (meter.loudness(frame, Use::Output), drive_level.at_frame(frame));
            let exponent = dynamics.next(within(controls.companding.dynamics, 0.0, 1.0));
            [maths::pow(loudness / level, exponent), audible(loudness, controls.gate)]
        });
    }

    /// Factor for the drive's low end, which brings it to the level of the recordings' own.
    pub fn low_end_at(
        &mut self,
        position: (i64, f64),
        drive_level: &DriveLevel,
        controls: &TextureControls,
        recordings: &[Recorded<'_>; SLOTS],
    ) -> f64 {
        let own_shares = &mut self.shares;
        self.low_end.value_at(position, |frame| {
            let crossover_hz = within(controls.companding.low_end_hz, LOWEST_HZ, HIGHEST_HZ);
            let wanted = shares(&controls.recordings);
            let mut below = 0.0;
            for ((share, wanted), recorded) in own_shares.iter_mut().zip(wanted).zip(recordings) {
                let share = share.next(wanted);
                let own = recorded.profile.map_or(0.0, |profile| profile.rms_below(crossover_hz));
                below += share * recorded.gain * own;
            }
            below / drive_level.at_frame(frame)
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
