//! The drive's overall level as it is used: learned or estimated, and smoothed.

use super::frames::FrameHistory;
use super::level::{NOMINAL, RunningLevel, SILENCE, SMOOTHING_S};
use crate::controls::{DynamicRange, TextureControls};
use crate::dsp::Smoothed;

/// Share of the drive's level below which it counts as silent.
const SILENT_PART: f64 = 1e-3;

/// The drive's level by frames.
#[derive(Debug)]
pub(super) struct DriveLevel {
    running: RunningLevel,
    /// The level learned beforehand.
    pub learned: Option<f64>,
    /// The level as used, in nepers.
    level: Smoothed,
    is_fresh: bool,
    levels: FrameHistory,
}

impl DriveLevel {
    /// A level whose last `frames` values are kept.
    pub fn new(frames: usize, frame_samples: usize, frame_rate_hz: f64) -> Self {
        Self {
            running: RunningLevel::new(frame_rate_hz),
            learned: None,
            level: Smoothed::new(SMOOTHING_S, frame_rate_hz),
            is_fresh: true,
            levels: FrameHistory::new(frames, frame_samples, NOMINAL),
        }
    }

    /// Forgets the drive, but not what was learned.
    pub fn reset(&mut self) {
        self.running.reset();
        self.is_fresh = true;
        self.levels.reset();
    }

    /// Adds a frame's loudness.
    pub fn push(&mut self, loudness: f64, controls: &TextureControls) {
        let least = if self.running.is_fresh() { SILENCE } else { SILENCE.max(SILENT_PART * self.running.level()) };
        // A layer that is off has an infinite threshold; its level is followed all the same.
        let gate = if controls.gate.is_finite() { controls.gate } else { 0.0 };
        if loudness > least.max(gate) {
            self.running.push(loudness);
        }
        let level = match (controls.dynamic_range, self.learned) {
            (DynamicRange::Off, _) => NOMINAL,
            (DynamicRange::Learned, Some(learned)) => learned,
            (DynamicRange::Learned | DynamicRange::Running, _) => self.running.level(),
        };
        if std::mem::take(&mut self.is_fresh) {
            self.level.value = maths::ln(level);
        }
        self.levels.push(maths::exp(self.level.next(maths::ln(level))));
    }

    /// The level at a frame.
    pub fn at_frame(&self, frame: i64) -> f64 {
        self.levels.frame(frame)
    }
}
