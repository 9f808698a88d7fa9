//! Burning: what it does to the gas, and the field whose iso-surface is the flame front.

use rayon::prelude::*;

use super::parallel::elements;

/// Fuel, 0-1; in a blue core the level set: distance from the front in m, negative in unburnt gas.
pub(crate) const FUEL: usize = 0;
/// Temperature above ambient, 1 = that of a hot flame.
pub(crate) const TEMPERATURE: usize = 1;
/// Smoke, 0-1.
pub(crate) const SMOKE: usize = 2;
/// Seconds since the gas burnt (blue core).
pub(crate) const AGE: usize = 3;

/// Cells behind a blue core's front over which the gas expands.
const EXPANDING_CELLS: f32 = 3.0;

/// Hottest that gas can get.
const HOTTEST: f32 = 2.0;

/// How fuel burns (Chadwick & James 2011, §2.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Combustion {
    /// Fuel above its ignition temperature burns at a constant rate.
    Fuel {
        /// Temperature above which it burns, 0-1.
        ignition: f64,
        /// Fuel burnt per second; a cell full of fuel has 1.
        rate_hz: f64,
        /// Temperature gained by burning all of a cell's fuel.
        heat: f64,
        /// Volume gained by burning all of a cell's fuel, in volumes.
        expansion: f64,
    },
    /// A premixed flame's blue core: a front that eats into unburnt gas (Nguyen, Fedkiw & Jensen 2002).
    BlueCore {
        /// Speed of the front relative to the unburnt gas, in m/s.
        flame_speed_m_s: f64,
        /// Volume gained by burning, in volumes.
        expansion: f64,
        /// Seconds in which burnt gas becomes hottest.
        rise_s: f64,
        /// Seconds in which it then cools to a third.
        fall_s: f64,
    },
}

/// How gas changes of itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooling {
    /// Loss of temperature per second at temperature 1; it grows with the fourth power.
    pub radiation_hz: f64,
    /// Loss of smoke per second.
    pub dissipation_hz: f64,
}

/// One step of burning, cell by cell: `source` is the divergence in 1/s, `front` 1 where it burns and 0 elsewhere, one
/// half on the front.
pub(crate) fn burn(
    combustion: &Combustion,
    cooling: &Cooling,
    voxel_size_m: f64,
    dt_s: f64,
    scalars: &mut [[f32; 4]],
    source: &mut [f32],
    front: &mut [f32],
) {
    let cell = |scalar: &mut [f32; 4], source: &mut f32, front: &mut f32| match *combustion {
        Combustion::Fuel { ignition, rate_hz, heat, expansion } => {
            let most = (rate_hz * dt_s) as f32;
            let fuel = scalar[FUEL].clamp(0.0, 1.0);
            let burnt = if scalar[TEMPERATURE] > ignition as f32 { fuel.min(most) } else { 0.0 };
            scalar[FUEL] = fuel - burnt;
            scalar[TEMPERATURE] = (scalar[TEMPERATURE] + heat as f32 * burnt).clamp(0.0, HOTTEST);
            scalar[SMOKE] = (scalar[SMOKE] + burnt).clamp(0.0, 1.0);
            *source = expansion as f32 * burnt / dt_s as f32;
            *front = if most > 0.0 { burnt / most } else { 0.0 };
        }
        Combustion::BlueCore { flame_speed_m_s, expansion, rise_s, fall_s } => {
            let distance = scalar[FUEL];
            let unburnt = distance < 0.0;
            scalar[AGE] = if unburnt { 0.0 } else { scalar[AGE] + dt_s as f32 };
            scalar[TEMPERATURE] = if unburnt { 0.0 } else { temperature(scalar[AGE], rise_s as f32, fall_s as f32) };
            scalar[SMOKE] = if unburnt { 1.0 } else { scalar[SMOKE].clamp(0.0, 1.0) };
            scalar[TEMPERATURE] *= scalar[SMOKE];
            // All of the expansion lies on the burnt side, or it would blow up the core itself; the front that is listened
            // to encloses it.
            let behind = EXPANDING_CELLS * voxel_size_m as f32;
            *source = (flame_speed_m_s * expansion) as f32 * delta(distance - 0.5 * behind, 0.5 * behind);
            *front = (0.5 - (distance - behind) / (8.0 * voxel_size_m as f32)).clamp(0.0, 1.0);
        }
    };
    let cells = elements(scalars).zip(elements(source)).zip(elements(front));
    let (radiation, dissipation) = ((cooling.radiation_hz * dt_s) as f32, (cooling.dissipation_hz * dt_s) as f32);
    cells.for_each(|((scalar, source), front)| {
        cell(scalar, source, front);
        // Implicit, so that it cannot overshoot.
        let cube = scalar[TEMPERATURE].powi(3);
        scalar[TEMPERATURE] /= 1.0 + radiation * cube;
        scalar[SMOKE] /= 1.0 + dissipation;
    });
}

/// Temperature of gas that burnt `age_s` ago: it rises in a half sine, and falls exponentially.
fn temperature(age_s: f32, rise_s: f32, fall_s: f32) -> f32 {
    if age_s < rise_s {
        (std::f32::consts::FRAC_PI_2 * age_s / rise_s.max(1e-6)).sin()
    } else {
        (-(age_s - rise_s) / fall_s.max(1e-6)).exp()
    }
}

/// A peak of area 1 over -`width`..`width`.
fn delta(distance: f32, width: f32) -> f32 {
    if distance.abs() >= width {
        return 0.0;
    }
    (1.0 + (std::f32::consts::PI * distance / width).cos()) / (2.0 * width)
}
