//! Vortex-sound textures: the sound of a small turbulent region, recorded from the solver (Dobashi, Yamamoto & Nishita
//! 2004, §5).
//!
//! ```text
//! flow: inflow, confinement, open top ─ settle ─ vorticity ─ integral T(t) ─ series: loop, d³/dt³, low-pass ─ row
//! ```
//!
//! One speed gives one row; rows are independent. Apart from buoyancy, everything is to scale: in one step the inflow
//! crosses the same part of a voxel at any speed, and all rates follow speed over voxel size. A slow row therefore
//! costs few steps, and its sound is not drowned by the noise of many.

mod factory;
mod flow;
mod integral;
mod recipe;
mod series;
mod settle;
mod vorticity;

pub use factory::Shipped;
pub use integral::{Integral, Origin};
pub use recipe::{FlowModel, Recipe};
pub use series::{Band, COMPONENTS, Series};
pub use vorticity::Vorticity;

use pyrophone_synthesis::vortex::texture::Row;

use crate::error::{Error, in_range};
use flow::Flow;

/// Density of air in kg/m³.
const DENSITY_KG_M3: f64 = 1.2;
/// Speed of sound in air in m/s.
const SOUND_M_S: f64 = 343.0;

/// Progress of a row's recording: settling (of unknown length), or the recorded share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Progress {
    /// The flow is settling.
    Settling,
    /// This share (0-1) of the steps has been recorded.
    Recording(f64),
}

impl Recipe {
    /// Simulates gas at `speed_m_s` (0.1-100 m/s) until it has settled, then records it and makes a row from it.
    ///
    /// The row depends only on the recipe and the speed. `progress` is called at every step; recording stops if it
    /// returns false.
    ///
    /// # Errors
    /// If a number is out of range, if the flow does not settle, or if `progress` stops it.
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
            values.push(integral.components(&Vorticity::of_solver(flow.solver())));
        }
        if !flow.solver().is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let band = Band::of_flow(speed_m_s / self.voxel_size_m, 1.0 / step_s, self.rate_hz);
        let sound = Series::looped(&values, period, step_s).sound(self.period_samples(), band);
        Ok(sound.row(speed_m_s, DENSITY_KG_M3 / (12.0 * std::f64::consts::PI * maths::square(SOUND_M_S))))
    }
}

/// A geometric series of `count` speeds from `low_m_s` to `high_m_s`, rounded as in a file.
///
/// # Errors
/// If they lie outside 0.1-100 m/s, do not rise, or are not 1-256 in number.
pub fn speeds(low_m_s: f64, high_m_s: f64, count: usize) -> Result<Vec<f64>, Error> {
    in_range("lowest speed in m/s", low_m_s, 0.1, 100.0)?;
    in_range("highest speed in m/s", high_m_s, low_m_s, 100.0)?;
    in_range("number of speeds", count as f64, 1.0, 256.0)?;
    if count > 1 && high_m_s / low_m_s < 1.0 + 1e-3 * (count - 1) as f64 {
        let least = low_m_s * (1.0 + 1e-3 * (count - 1) as f64);
        return Err(Error::OutOfRange { what: "highest speed in m/s", found: high_m_s, low: least, high: 100.0 });
    }
    let step = maths::pow(high_m_s / low_m_s, 1.0 / (count.max(2) - 1) as f64);
    Ok((0..count).map(|index| f64::from((low_m_s * maths::powi(step, index as i32)) as f32)).collect())
}
