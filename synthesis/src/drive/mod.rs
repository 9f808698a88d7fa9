//! The drive: the signal that drives the engines.
//!
//! Main input as pressure or flux, an envelope on a rumble, or a built-in flame; then the high-pass (Chadwick & James
//! 2011, §6: 30 Hz, before either engine). No latency.

mod flame;
mod high_pass;
mod rumble;
mod swell;

pub use flame::SCENES;

use flame::Flame;
use high_pass::HighPass;
use rumble::Rumble;
use swell::Swell;

use crate::controls::{DriveControls, DriveMode};
use crate::dsp::{Average, Envelope, Follow};
use crate::error::{Error, in_range, within};

/// Frequency in Hz at which differentiating flux leaves the level unchanged.
const FLUX_UNITY_HZ: f64 = 100.0;

/// Time in seconds over which channels are compared.
const CANCEL_S: f64 = 0.1;

/// Channels cancel if their mean has less than this share of their mean power: -30 dB.
const CANCEL_RATIO: f64 = 1e-3;

/// Mean power below which cancelling is not worth a warning: -80 dBFS.
const CANCEL_FLOOR: f64 = 1e-8;

/// Decay of a full-scale input, in nepers, after which the drive counts as silent: -120 dB, the lowest threshold of
/// texture's gate.
const SILENCE_NEPERS: f64 = 13.8;

/// The drive's signal path.
#[derive(Debug)]
pub struct Drive {
    sample_rate_hz: f64,
    flux_gain: f64,
    /// The previous mean input; none right after reset, when a flux has no past.
    previous: Option<f64>,
    average: Average,
    envelope: Envelope,
    rumble: Rumble,
    flame: Flame,
    swell: Swell,
    high_pass: HighPass,
    /// Smoothed power of the channels' mean, and mean power of the channels.
    powers: [f64; 2],
    power_step: f64,
    position: i64,
}

impl Drive {
    /// A drive at position 0; `sample_rate_hz` is 8,000-384,000. The first one reads the factory's flames.
    pub fn new(sample_rate_hz: f64) -> Result<Self, Error> {
        in_range("sample rate in Hz", sample_rate_hz, 8000.0, 384_000.0)?;
        Ok(Self {
            sample_rate_hz,
            flux_gain: 0.5 / maths::sin(std::f64::consts::PI * FLUX_UNITY_HZ / sample_rate_hz),
            previous: None,
            average: Average::new(sample_rate_hz),
            envelope: Envelope::new(sample_rate_hz),
            rumble: Rumble::new(sample_rate_hz),
            flame: Flame::new(sample_rate_hz)?,
            swell: Swell::new(sample_rate_hz),
            high_pass: HighPass::new(sample_rate_hz),
            powers: [0.0; 2],
            power_step: 1.0 - maths::exp(-1.0 / (CANCEL_S * sample_rate_hz)),
            position: 0,
        })
    }

    /// The drive is not delayed.
    pub fn latency_samples(&self) -> usize {
        0
    }

    /// Samples for which the drive continues after a full-scale input has ended: the envelope's fall to its
    /// threshold, and the high-pass, which rings as exp(-2 pi f t / sqrt 2). A built-in flame needs no input and never
    /// ends: see [`DriveMode::Flame`].
    pub fn tail_samples(&self, controls: &DriveControls) -> usize {
        let envelope_s = match controls.mode {
            DriveMode::Envelope | DriveMode::InputEnvelope => {
                // Two stages of averaging fall as fast as one of twice its time.
                let fall_s = if controls.averaging_s > 0.0 { 2.0 * controls.averaging_s } else { controls.release_s };
                fall_s * (-maths::ln(controls.threshold)).clamp(0.0, SILENCE_NEPERS)
            }
            DriveMode::Pressure | DriveMode::Flux | DriveMode::Flame => 0.0,
        };
        let corner = std::f64::consts::SQRT_2 * std::f64::consts::PI * controls.high_pass_hz;
        let ringing_s = if corner > 0.0 { SILENCE_NEPERS / corner } else { 0.0 };
        ((envelope_s + ringing_s) * self.sample_rate_hz).ceil() as usize
    }

    /// Resets to silence; the next sample is at `position` on the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.previous = None;
        self.average.reset();
        self.envelope.reset();
        self.flame.reset();
        self.swell.reset();
        self.high_pass.reset();
        self.powers = [0.0; 2];
        self.position = position;
    }

    /// True if the channels that feed the drive cancel in their mean.
    pub fn cancels(&self) -> bool {
        self.powers[1] > CANCEL_FLOOR && self.powers[0] < CANCEL_RATIO * self.powers[1]
    }

    /// Computes the drive of one block of any length. `controls` apply to the whole block. Every channel of `main` and
    /// `sidechain` is as long as `drive`; if `sidechain` is empty, the envelope is that of the main input.
    pub fn process(&mut self, main: &[&[f64]], sidechain: &[&[f64]], controls: &DriveControls, drive: &mut [f64]) {
        self.run(main, sidechain, controls, drive, None);
    }

    /// The same; if the drive is made from an averaged envelope, also writes that to `envelope`, which is as long, and
    /// returns its delay in seconds after the sound that it follows.
    pub fn process_with_envelope(
        &mut self,
        main: &[&[f64]],
        sidechain: &[&[f64]],
        controls: &DriveControls,
        drive: &mut [f64],
        envelope: &mut [f64],
    ) -> Option<f64> {
        self.run(main, sidechain, controls, drive, Some(envelope));
        is_averaged(controls).then(|| Average::delay_s(controls.averaging_s))
    }

    fn run(
        &mut self,
        main: &[&[f64]],
        sidechain: &[&[f64]],
        controls: &DriveControls,
        drive: &mut [f64],
        envelope: Option<&mut [f64]>,
    ) {
        let source = match controls.mode {
            DriveMode::Flame => &[],
            DriveMode::Envelope if !sidechain.is_empty() => sidechain,
            _ => main,
        };
        self.mean(source, drive);
        let is_averaged = is_averaged(controls);
        match controls.mode {
            DriveMode::Pressure => self.previous = drive.last().copied().or(self.previous),
            DriveMode::Flux => {
                for sample in drive.iter_mut() {
                    let before = self.previous.replace(*sample).unwrap_or(*sample);
                    *sample = (*sample - before) * self.flux_gain;
                }
            }
            DriveMode::Envelope | DriveMode::InputEnvelope => {
                self.previous = None;
                self.follow(controls, drive);
                if !is_averaged {
                    self.rumble.modulate(controls.seed, self.position, drive);
                }
            }
            DriveMode::Flame => {
                self.previous = None;
                self.flame.process(&controls.flame, self.position, drive);
            }
        }
        if controls.gain != 1.0 {
            let gain = within(controls.gain, 0.0, f64::MAX);
            drive.iter_mut().for_each(|sample| *sample *= gain);
        }
        self.swell.process(controls.swell, drive);
        if is_averaged {
            if let Some(envelope) = envelope {
                envelope.copy_from_slice(drive);
            }
            self.rumble.modulate(controls.seed, self.position, drive);
        }
        self.high_pass.process(controls.high_pass_hz, drive);
        self.position = self.position.wrapping_add(drive.len() as i64);
    }

    /// Replaces the signal by its envelope. The follower that is not in use rests at silence.
    fn follow(&mut self, controls: &DriveControls, signal: &mut [f64]) {
        let DriveControls { averaging_s, attack_s, release_s, threshold, .. } = *controls;
        if is_averaged(controls) {
            self.envelope.reset();
            self.average.process(averaging_s, threshold, signal);
        } else {
            self.average.reset();
            self.envelope.process(&Follow { attack_s, release_s, threshold }, signal);
        }
    }

    /// Writes the mean of the channels to `out`, and checks whether they cancel.
    fn mean(&mut self, channels: &[&[f64]], out: &mut [f64]) {
        let Some((first, others)) = channels.split_first() else {
            out.fill(0.0);
            return;
        };
        if others.is_empty() {
            // One channel is its own mean, bit for bit.
            let count = out.len().min(first.len());
            out[..count].copy_from_slice(&first[..count]);
            out[count..].fill(0.0);
            self.powers = [0.0; 2];
            return;
        }
        let share = 1.0 / channels.len() as f64;
        for (at, mean) in out.iter_mut().enumerate() {
            let (mut sum, mut power) = (0.0, 0.0);
            for channel in channels {
                let sample = channel.get(at).copied().unwrap_or(0.0);
                sum += sample;
                power += sample * sample;
            }
            *mean = sum * share;
            for (state, now) in self.powers.iter_mut().zip([*mean * *mean, power * share]) {
                *state += self.power_step * (now - *state);
                if *state < 1e-30 {
                    *state = 0.0;
                }
            }
        }
    }
}
/// True if the drive is made from an averaged envelope.
fn is_averaged(controls: &DriveControls) -> bool {
    matches!(controls.mode, DriveMode::Envelope | DriveMode::InputEnvelope) && controls.averaging_s > 0.0
}
