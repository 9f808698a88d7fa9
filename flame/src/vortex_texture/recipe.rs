//! Settings of a texture: the flow, the box, and the rows to record.

use super::integral::Origin;
use crate::error::{Error, in_range};

/// Part of a voxel that gas at the row's speed crosses in a step: the shortest eddies (two voxels) pass in four steps.
const VOXELS_PER_STEP: f64 = 0.5;

/// Length of the crossfade as a share of the period.
const FADE_SHARE: f64 = 0.25;

/// Inflow through the bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FlowModel {
    /// A uniform flow with random disturbances: the paper's.
    Wind,
    /// The same with hot gas, in wandering patches that rise by themselves.
    Fire,
    /// A narrow, fast flow in the centre.
    Jet,
}

impl FlowModel {
    /// Name in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wind => "wind",
            Self::Fire => "fire",
            Self::Jet => "jet",
        }
    }
}

/// Settings for recording a texture's rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// The flow.
    pub kind: FlowModel,
    /// Voxels along x, y and z (up): 8-128 each.
    pub voxels: [usize; 3],
    /// Edge of a voxel in m, 0.001-0.2.
    pub voxel_size_m: f64,
    /// Steps per second of the rows, 2,000-16,000, an integer.
    pub rate_hz: f64,
    /// Period of the rows in s, 0.25-60.
    pub period_s: f64,
    /// Random part of the inflow, rms, as a share of its speed; 0-1.
    pub perturbation: f64,
    /// Origin of the source integral.
    pub origin: Origin,
    /// Seed of all randomness.
    pub seed: u64,
}

impl Recipe {
    /// A fire in 16×16×24 voxels of 2 cm, with disturbances of a tenth, for 4 s at 4 kHz.
    pub const STANDARD: Self = Self {
        kind: FlowModel::Fire,
        voxels: [16, 16, 24],
        voxel_size_m: 0.02,
        rate_hz: 4_000.0,
        period_s: 4.0,
        perturbation: 0.1,
        origin: Origin::Centre,
        seed: 1,
    };
}

impl Default for Recipe {
    /// The default, [`STANDARD`](Self::STANDARD).
    fn default() -> Self {
        Self::STANDARD
    }
}

impl Recipe {
    /// Checks all values.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the first value outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        for size in self.voxels {
            in_range("number of voxels along an axis", size as f64, 8.0, 128.0)?;
        }
        in_range("voxel size in m", self.voxel_size_m, 1e-3, 0.2)?;
        in_range("rate in Hz", self.rate_hz, 2_000.0, 16_000.0)?;
        if self.rate_hz.fract() != 0.0 {
            return Err(Error::NotWhole { what: "rate in Hz", found: self.rate_hz });
        }
        in_range("period in s", self.period_s, 0.25, 60.0)?;
        in_range("perturbation", self.perturbation, 0.0, 1.0)
    }

    /// Samples of a row's period.
    pub fn period_samples(&self) -> usize {
        (self.period_s * self.rate_hz).round() as usize
    }

    /// Solver steps in a row's period: one per half voxel crossed, but at most one per sample.
    pub fn period_steps(&self, speed_m_s: f64) -> usize {
        let steps = self.exact_period_s() * speed_m_s / (VOXELS_PER_STEP * self.voxel_size_m);
        (steps.ceil() as usize).clamp(16, self.period_samples())
    }

    /// Solver steps recorded for a row.
    pub fn recorded_steps(&self, speed_m_s: f64) -> usize {
        self.period_steps(speed_m_s) + self.fade_steps(speed_m_s)
    }

    /// The period as represented by its samples.
    pub(super) fn exact_period_s(&self) -> f64 {
        self.period_samples() as f64 / self.rate_hz
    }

    fn fade_steps(&self, speed_m_s: f64) -> usize {
        (FADE_SHARE * self.period_steps(speed_m_s) as f64).round() as usize
    }
}
