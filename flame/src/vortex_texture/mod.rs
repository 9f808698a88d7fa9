//! Vortex-sound textures: what a small turbulent region radiates, recorded from the solver (Dobashi, Yamamoto & Nishita
//! 2004, §5).
//!
//! ```text
//! flow: inflow, confinement, open top ─ settle ─ vorticity ─ integral T(t) ─ series: loop, d³/dt³, low-pass ─ row
//! ```
//!
//! One speed gives one row; rows know nothing of each other. What does not depend on buoyancy is made to scale: a step
//! lets the inflow cross the same part of a voxel at any speed, and all rates follow speed over voxel. So a slow row
//! costs few steps, and its sound is not drowned by the noise of many.

mod flow;
mod integral;
mod series;
mod settle;
mod shipped;
mod vorticity;

pub use integral::{Integral, Origin};
pub use series::{Band, COMPONENTS, Series};
pub use shipped::Shipped;
pub use vorticity::Vorticity;

use pyrophone_synthesis::vortex::texture::Row;

use crate::error::{Error, in_range};
use flow::Flow;

/// Density of air in kg/m³.
const DENSITY_KG_M3: f64 = 1.2;
/// Speed of sound in air in m/s.
const SOUND_M_S: f64 = 343.0;

/// Parts of a voxel that gas at the row's speed crosses in a step: the shortest eddies (two voxels) pass in four steps.
const VOXELS_PER_STEP: f64 = 0.5;

/// Steps of the crossfade, as a part of the period's.
const FADE_SHARE: f64 = 0.25;

/// What comes in through the bottom.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// An even flow, disturbed at random: the paper's.
    Wind,
    /// The same with hot gas in it, in wandering patches that rise on their own.
    Fire,
    /// A narrow fast flow in the middle.
    Jet,
}

impl Kind {
    /// Its name in commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wind => "wind",
            Self::Fire => "fire",
            Self::Jet => "jet",
        }
    }
}

/// How a texture's rows are recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Recipe {
    /// What flows.
    pub kind: Kind,
    /// Voxels along x, y, z (up): 8-128 each.
    pub voxels: [usize; 3],
    /// Edge of a voxel in m, 0.001-0.2.
    pub voxel_size_m: f64,
    /// Steps per second of the rows, 2,000-16,000, whole.
    pub rate_hz: f64,
    /// Period of the rows in s, 0.25-60.
    pub period_s: f64,
    /// Random part of the inflow, rms, as a part of its speed; 0-1.
    pub perturbation: f64,
    /// Origin of the source integral.
    pub origin: Origin,
    /// Number of all that is random.
    pub seed: u64,
}

impl Recipe {
    /// A fire in 16×16×24 voxels of 2 cm, disturbed by a tenth, for 4 s at 4 kHz.
    pub const STANDARD: Self = Self {
        kind: Kind::Fire,
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
    /// The [`STANDARD`](Self::STANDARD).
    fn default() -> Self {
        Self::STANDARD
    }
}

/// How far the recording of a row is: settling (its length is not known before), or the share that is recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// The flow settles.
    Settling,
    /// This share (0-1) of the steps is recorded.
    Recording(f64),
}

impl Recipe {
    /// Fails where a number is out of range.
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

    /// Solver steps of a row's period: as many as half a voxel a step takes, at most one a sample.
    pub fn period_steps(&self, speed_m_s: f64) -> usize {
        let steps = self.exact_period_s() * speed_m_s / (VOXELS_PER_STEP * self.voxel_size_m);
        (steps.ceil() as usize).clamp(16, self.period_samples())
    }

    /// Solver steps that are recorded for a row.
    pub fn recorded_steps(&self, speed_m_s: f64) -> usize {
        self.period_steps(speed_m_s) + self.fade_steps(speed_m_s)
    }

    /// Simulates gas of `speed_m_s` (0.1-100 m/s) until it is settled, then records it and makes a row of it.
    ///
    /// The row depends on nothing but the recipe and the speed. `progress` is called at every step; recording ends
    /// where it answers false.
    ///
    /// Fails where a number is out of range, where the flow does not settle, and where `progress` says so.
    pub fn record(&self, speed_m_s: f64, mut progress: impl FnMut(Progress) -> bool) -> Result<Row, Error> {
        self.validate()?;
        in_range("speed in m/s", speed_m_s, 0.1, 100.0)?;
        let (period, recorded) = (self.period_steps(speed_m_s), self.recorded_steps(speed_m_s));
        let step_s = self.exact_period_s() / period as f64;
        let mut flow = Flow::new(self, speed_m_s, step_s)?;
        let mut go_on = |at| if progress(at) { Ok(()) } else { Err(Error::Cancelled) };
        settle::settle(&mut flow, || go_on(Progress::Settling))?;
        let integral = Integral::new(self.voxels, self.voxel_size_m, self.origin);
        let mut values = Vec::with_capacity(recorded);
        for step in 0..recorded {
            go_on(Progress::Recording(step as f64 / recorded as f64))?;
            flow.step();
            values.push(integral.components(&Vorticity::of(flow.solver())));
        }
        if !flow.solver().is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let band = Band::of_flow(speed_m_s / self.voxel_size_m, 1.0 / step_s, self.rate_hz);
        let sound = Series::looped(&values, period, step_s).sound(self.period_samples(), band);
        Ok(sound.row(speed_m_s, DENSITY_KG_M3 / (12.0 * std::f64::consts::PI * SOUND_M_S.powi(2))))
    }

    /// The period as its samples have it.
    fn exact_period_s(&self) -> f64 {
        self.period_samples() as f64 / self.rate_hz
    }

    fn fade_steps(&self, speed_m_s: f64) -> usize {
        (FADE_SHARE * self.period_steps(speed_m_s) as f64).round() as usize
    }
}

/// `count` speeds from `low_m_s` to `high_m_s`, each the same factor above the one before, as a file keeps them.
///
/// Fails where they lie outside 0.1-100 m/s, do not rise, or are not 1-256 in number.
pub fn speeds(low_m_s: f64, high_m_s: f64, count: usize) -> Result<Vec<f64>, Error> {
    in_range("lowest speed in m/s", low_m_s, 0.1, 100.0)?;
    in_range("highest speed in m/s", high_m_s, low_m_s, 100.0)?;
    in_range("number of speeds", count as f64, 1.0, 256.0)?;
    if count > 1 && high_m_s / low_m_s < 1.0 + 1e-3 * (count - 1) as f64 {
        let least = low_m_s * (1.0 + 1e-3 * (count - 1) as f64);
        return Err(Error::OutOfRange { what: "highest speed in m/s", found: high_m_s, low: least, high: 100.0 });
    }
    let step = (high_m_s / low_m_s).powf(1.0 / (count.max(2) - 1) as f64);
    Ok((0..count).map(|index| f64::from((low_m_s * step.powi(index as i32)) as f32)).collect())
}
