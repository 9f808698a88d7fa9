//! The drive's loudness in frames, by two kernels: one for matching, one for the output.

use super::frames::{FrameHistory, FramePositions, Kernel, frame_samples};
use super::profile::MATCHED_HZ;
use crate::dsp::{Svf, section_gain};

/// Time constant of the loudness's power, in seconds: 8 Hz. 20 Hz was better on one flame and worse on another
/// (docs/sound.md).
const PAST_S: f64 = 0.02;
/// Look-ahead time constant of matching.
pub(super) const MATCH_FUTURE_S: f64 = 0.02;
/// Look-ahead time constant of the output; slower, since flames swell and do not begin at full loudness.
const OUTPUT_FUTURE_S: f64 = 0.06;

/// Use of a loudness.
#[derive(Debug, Clone, Copy)]
pub(super) enum Use {
    /// For the signal that is matched.
    Match,
    /// For the output.
    Output,
}

/// Loudness of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct FrameLoudness {
    /// Its loudness for matching.
    pub loudness: f64,
    /// Root of the largest power within the wait: of sound that has yet to reach texture.
    pub coming: f64,
}

/// Measures the drive's power below [`MATCHED_HZ`], frame by frame.
#[derive(Debug)]
pub(super) struct LoudnessMeter {
    sample_rate_hz: f64,
    frame_samples: usize,
    low: Svf,
    low_gain: f64,
    power: f64,
    /// Samples in the present frame.
    filled: usize,
    /// Powers of the last frames, each stored twice so that they are always contiguous, oldest first.
    powers: Vec<f64>,
    newest: usize,
    /// Frames of the wait.
    coming: usize,
    kernels: [Kernel; 2],
    loudness: [FrameHistory; 2],
    /// Offset of the first sample into a frame of the host's timeline: frames are aligned with multiples of their
    /// length, so that two starts in one silence agree.
    origin: i64,
}

impl LoudnessMeter {
    /// A meter whose loudness for matching looks ahead by `wait_samples`, and that for the output by `latency_samples`.
    pub fn new(sample_rate_hz: f64, wait_samples: usize, latency_samples: usize) -> Self {
        let frame_samples = frame_samples(sample_rate_hz);
        let frame_rate_hz = sample_rate_hz / frame_samples as f64;
        // A loudness must be known before the first sample beyond its frame's centre.
        let look_ahead = |samples: usize| (samples / frame_samples) as i64 - 2;
        let kernels = [
            Kernel::new(frame_rate_hz, look_ahead(wait_samples), MATCH_FUTURE_S, PAST_S),
            Kernel::new(frame_rate_hz, look_ahead(latency_samples), OUTPUT_FUTURE_S, PAST_S),
        ];
        let longest = kernels.iter().map(Kernel::span).max().unwrap_or(1);
        let history = || FrameHistory::new(latency_samples / frame_samples + 8, frame_samples, 0.0);
        Self {
            sample_rate_hz,
            frame_samples,
            low: Svf::default(),
            low_gain: section_gain(MATCHED_HZ, sample_rate_hz),
            power: 0.0,
            filled: 0,
            powers: vec![0.0; 2 * longest],
            newest: 0,
            coming: wait_samples.div_ceil(frame_samples).clamp(1, longest),
            kernels,
            loudness: [history(), history()],
            origin: 0,
        }
    }

    /// Resets to silence at `position` of the host's timeline.
    pub fn reset(&mut self, position: i64) {
        self.origin = position.rem_euclid(self.frame_samples as i64);
        self.low.reset();
        self.power = 0.0;
        self.filled = self.origin as usize;
        self.powers.fill(0.0);
        self.newest = 0;
        self.loudness.iter_mut().for_each(FrameHistory::reset);
    }

    /// Number of frames in a time.
    pub fn frames(&self, time_s: f64) -> i64 {
        (time_s * self.sample_rate_hz / self.frame_samples as f64).round() as i64
    }

    /// Measures one sample of the drive, or of the envelope that it was made from, which is some frames late; returns the
    /// loudness at the end of a frame.
    #[inline]
    pub fn measure(&mut self, sample: f64, envelope: Option<(f64, i64)>) -> Option<FrameLoudness> {
        let low = self.low.process(self.low_gain, sample).low;
        let amplitude = envelope.map_or(low, |(value, _)| value);
        self.power += amplitude * amplitude;
        self.filled += 1;
        if self.filled < self.frame_samples {
            return None;
        }
        let length = self.powers.len() / 2;
        self.powers[self.newest] = self.power / self.frame_samples as f64;
        self.powers[self.newest + length] = self.powers[self.newest];
        self.newest = (self.newest + 1) % length;
        self.power = 0.0;
        self.filled = 0;
        let last = self.newest + length;
        let peak = self.powers[last - self.coming..last].iter().fold(0.0f64, |most, power| most.max(*power));
        for (kernel, history) in self.kernels.iter().zip(&mut self.loudness) {
            let powers = &self.powers[last - kernel.span()..last];
            history.push(match envelope {
                Some((_, delay_frames)) => kernel.amplitude(powers, delay_frames),
                None => kernel.loudness(powers),
            });
        }
        Some(FrameLoudness { loudness: self.loudness[0].newest(), coming: peak.sqrt() })
    }

    /// The frames whose loudness applies at `sample` since reset and afterwards: those determined after their future
    /// arrived.
    pub fn positions(&self, sample: i64, by: Use) -> FramePositions {
        self.loudness[by as usize].positions(sample + self.origin).later(self.kernels[by as usize].look_ahead())
    }

    /// The loudness of a frame.
    pub fn loudness(&self, frame: i64, by: Use) -> f64 {
        self.loudness[by as usize].frame(frame)
    }

    /// The first sample since reset to which the loudness of a frame for matching applies.
    pub fn matched_sample(&self, frame: i64) -> i64 {
        (frame - self.kernels[Use::Match as usize].look_ahead()) * self.frame_samples as i64 - self.origin
    }

    /// Samples for which loudness for the output outlasts its sound.
    pub fn tail_samples(&self) -> usize {
        self.kernels[Use::Output as usize].span() * self.frame_samples
    }
}
