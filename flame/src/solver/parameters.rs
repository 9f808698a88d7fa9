//! Properties of the gas.

use super::combustion::{Combustion, Cooling};
use super::mixing::Mixing;
use crate::error::{Error, in_range};

/// Properties of the gas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// Combustion; none for gas that does not burn.
    pub combustion: Option<Combustion>,
    /// Cooling and dissipation.
    pub cooling: Cooling,
    /// Upward acceleration at temperature 1, in m/s²; 0-1000.
    pub buoyancy_m_s2: f64,
    /// Vorticity confinement, 0-100: speeds of voxel-sized eddies restored per second.
    pub confinement: f64,
    /// Kinematic viscosity in m²/s, 0-1; numerical viscosity of the grid is not included.
    pub viscosity_m2_s: f64,
    /// Stirring of hot gas: rms acceleration per component in m/s², 0-10,000.
    pub turbulence_m_s2: f64,
    /// Size in m of the largest added eddies.
    pub turbulence_scale_m: f64,
    /// Rate of change, in 1/s.
    pub turbulence_rate_hz: f64,
    /// Position in m of the box's first cell within the added eddies; -1e6 to 1e6.
    pub turbulence_origin_m: [f64; 3],
    /// Fluctuation of mixing, and so of the burn rate.
    pub mixing: Mixing,
}

impl Parameters {
    /// Gas without combustion, buoyancy or friction.
    pub fn still() -> Self {
        Self {
            combustion: None,
            cooling: Cooling { radiation_hz: 0.0, dissipation_hz: 0.0 },
            buoyancy_m_s2: 0.0,
            confinement: 0.0,
            viscosity_m2_s: 0.0,
            turbulence_m_s2: 0.0,
            turbulence_scale_m: 1.0,
            turbulence_rate_hz: 0.0,
            turbulence_origin_m: [0.0; 3],
            mixing: Mixing::EVEN,
        }
    }

    /// Checks all values.
    ///
    /// # Errors
    /// [`Error::OutOfRange`], naming the first value outside its range.
    pub fn validate(&self) -> Result<(), Error> {
        in_range("buoyancy in m/s²", self.buoyancy_m_s2, 0.0, 1000.0)?;
        in_range("vorticity confinement", self.confinement, 0.0, 100.0)?;
        in_range("viscosity in m²/s", self.viscosity_m2_s, 0.0, 1.0)?;
        in_range("turbulence in m/s²", self.turbulence_m_s2, 0.0, 10_000.0)?;
        in_range("scale of turbulence in m", self.turbulence_scale_m, 1e-4, 1e4)?;
        in_range("rate of turbulence in Hz", self.turbulence_rate_hz, 0.0, 1e4)?;
        in_range("radiation in Hz", self.cooling.radiation_hz, 0.0, 1e4)?;
        in_range("dissipation in Hz", self.cooling.dissipation_hz, 0.0, 1e4)?;
        for coordinate in self.turbulence_origin_m {
            in_range("place among eddies in m", coordinate, -1e6, 1e6)?;
        }
        in_range("spread of mixing", self.mixing.spread, 0.0, 3.0)?;
        in_range("scale of mixing in m", self.mixing.scale_m, 1e-3, 1e4)?;
        in_range("slowest mixing in Hz", self.mixing.slowest_hz, 0.01, 1e3)?;
        in_range("fastest mixing in Hz", self.mixing.fastest_hz, self.mixing.slowest_hz, 1e3)?;
        match self.combustion {
            None => Ok(()),
            Some(Combustion::Fuel { ignition, rate_hz, heat, expansion }) => {
                in_range("ignition temperature", ignition, 0.0, 2.0)?;
                in_range("burn rate in Hz", rate_hz, 0.0, 1e4)?;
                in_range("heat", heat, 0.0, 100.0)?;
                in_range("expansion", expansion, 0.0, 100.0)
            }
            Some(Combustion::BlueCore { flame_speed_m_s, expansion, depth_m, fall_s }) => {
                in_range("flame speed in m/s", flame_speed_m_s, 0.0, 100.0)?;
                in_range("expansion", expansion, 0.0, 100.0)?;
                in_range("depth in m", depth_m, 0.0, 100.0)?;
                in_range("fall in s", fall_s, 0.0, 100.0)
            }
        }
    }
}
