//! Combustion: its effect on the gas, and the field whose iso-surface is the flame front.

use rayon::prelude::*;

use super::activity::{Activity, SEGMENT};
use super::domain::Domain;
use super::mixing::MixingField;
use super::parallel::{planes, rows};

/// Fuel, 0-1; in a blue core the level set: distance from the front in m, negative in unburnt gas.
pub(crate) const FUEL: usize = 0;
/// Temperature above ambient, 1 = that of a hot flame.
pub(crate) const TEMPERATURE: usize = 1;
/// Smoke, 0-1.
pub(crate) const SMOKE: usize = 2;

/// Temperature range above ignition over which burning sets in. A threshold would switch whole cells on and off, which
/// is audible as grid noise.
const KINDLING: f32 = 0.2;

/// Amount of fuel below which burning slows down in proportion.
const LEAN: f32 = 0.25;

/// Amount of fuel at the front, where it is hot, and the temperature range over which it becomes so: the front encloses
/// nearly everything that burns.
const FUEL_ON_FRONT: f32 = 0.05;
/// See [`FUEL_ON_FRONT`].
const KINDLING_ON_FRONT: f32 = 0.1;

/// Least number of cells over which a blue core's gas expands.
const FEWEST_EXPANDING_CELLS: f64 = 2.0;

/// Amount of fuel, temperature or smoke that is treated as none.
const TRACE: f32 = 1e-4;

/// Highest temperature of gas.
const HOTTEST: f32 = 2.0;

/// Combustion model (Chadwick & James 2011, §2.1).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Combustion {
    /// Fuel above its ignition temperature burns at a constant rate, more slowly where little is left.
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
    /// The blue core of a premixed flame: a front that advances into unburnt gas (Nguyen, Fedkiw & Jensen 2002).
    BlueCore {
        /// Speed of the front relative to the unburnt gas, in m/s.
        flame_speed_m_s: f64,
        /// Volume gained by burning, in volumes.
        expansion: f64,
        /// Depth behind the front within which gas burns, heats up and expands, in m; at least two cells.
        depth_m: f64,
        /// Time in seconds in which it then cools to a third.
        fall_s: f64,
    },
}

/// Cooling and dissipation of gas.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cooling {
    /// Loss of temperature per second at temperature 1; it grows with the fourth power.
    pub radiation_hz: f64,
    /// Loss of smoke per second.
    pub dissipation_hz: f64,
}

/// Position and time at which gas burns.
pub(crate) struct Fire<'a> {
    pub domain: &'a Domain,
    pub origin_m: [f64; 3],
    pub mixing: &'a MixingField,
    pub activity: &'a Activity,
    pub dt_s: f64,
}

/// Takes one step of burning, cell by cell: `source` is the divergence in 1/s; `front` is large in the flame, one half
/// at the front and 0 elsewhere. Both change continuously as gas moves through the cells.
pub(crate) fn burn(
    combustion: &Combustion,
    cooling: &Cooling,
    fire: &Fire,
    scalars: &mut [[f32; 4]],
    source: &mut [f32],
    front: &mut [f32],
) {
    match *combustion {
        Combustion::Fuel { ignition, rate_hz, heat, expansion } => {
            let [ignition, rate_hz, heat, expansion] = [ignition, rate_hz, heat, expansion].map(|x| x as f32);
            let fuel = Fuel { ignition, rate_hz, heat, expansion };
            let dt_s = fire.dt_s as f32;
            burn_cells(cooling, fire, scalars, source, front, FUEL, |scalar, mixing| {
                burn_fuel(&fuel, scalar, dt_s, mixing)
            });
        }
        Combustion::BlueCore { flame_speed_m_s, expansion, depth_m, fall_s } => {
            let core = Core {
                expanding_m_s: (flame_speed_m_s * expansion) as f32,
                depth_m: depth_m.max(FEWEST_EXPANDING_CELLS * fire.domain.voxel_size_m()) as f32,
                kept: maths::exp(-fire.dt_s / fall_s.max(1e-6)) as f32,
            };
            burn_cells(cooling, fire, scalars, source, front, TEMPERATURE, |scalar, mixing| {
                burn_core(&core, scalar, mixing)
            });
        }
    }
}

/// [`Combustion::Fuel`], prepared for the cells.
struct Fuel {
    ignition: f32,
    rate_hz: f32,
    heat: f32,
    expansion: f32,
}

/// [`Combustion::BlueCore`], prepared for the cells.
struct Core {
    /// Speed at which expansion makes gas recede from the front.
    expanding_m_s: f32,
    depth_m: f32,
    /// Share of the temperature that remains after a step.
    kept: f32,
}

fn burn_cells(
    cooling: &Cooling,
    fire: &Fire,
    scalars: &mut [[f32; 4]],
    source: &mut [f32],
    front: &mut [f32],
    first_thinned: usize,
    burn: impl Fn(&mut [f32; 4], &dyn Fn() -> f32) -> (f32, f32) + Sync,
) {
    let [_, ny, nz] = fire.domain.shape();
    let radiation = (cooling.radiation_hz * fire.dt_s) as f32;
    let dissipation = (cooling.dissipation_hz * fire.dt_s) as f32;
    let cells = planes(scalars, ny * nz).zip(planes(source, ny * nz)).zip(planes(front, ny * nz));
    cells.enumerate().for_each(|(i, ((scalars, source), front))| {
        let mut row = fire.activity.row(i, 0);
        for ((([j, k], scalar), source), front) in rows(scalars, nz).zip(source).zip(front) {
            if k == 0 {
                row = fire.activity.row(i, j);
            }
            if !row[k / SEGMENT] {
                (*source, *front) = (0.0, 0.0);
                continue;
            }
            (*source, *front) = burn(scalar, &|| fire.mixing.factor(fire.place_m([i, j, k])));
            // Implicit, so that it cannot overshoot.
            let cube = maths::powi(scalar[TEMPERATURE], 3);
            scalar[TEMPERATURE] /= 1.0 + radiation * cube;
            scalar[SMOKE] /= 1.0 + dissipation;
            // Traces become air, which then need not be advected.
            for thinned in &mut scalar[first_thinned..] {
                *thinned = if *thinned < TRACE { 0.0 } else { *thinned };
            }
        }
    });
}

impl Fire<'_> {
    /// Centre of a cell in m.
    pub fn place_m(&self, cell: [usize; 3]) -> [f64; 3] {
        let h = self.domain.voxel_size_m();
        std::array::from_fn(|axis| self.origin_m[axis] + cell[axis] as f64 * h)
    }
}

/// Burns a cell's fuel; returns source and front.
#[inline(always)]
fn burn_fuel(fuel: &Fuel, scalar: &mut [f32; 4], dt_s: f32, mixing: impl Fn() -> f32) -> (f32, f32) {
    let left = scalar[FUEL].clamp(0.0, 1.0);
    let kindled = smooth_step((scalar[TEMPERATURE] - fuel.ignition) / KINDLING);
    if left == 0.0 || kindled == 0.0 {
        scalar[FUEL] = left;
        scalar[TEMPERATURE] = scalar[TEMPERATURE].clamp(0.0, HOTTEST);
        scalar[SMOKE] = scalar[SMOKE].clamp(0.0, 1.0);
        return (0.0, 0.0);
    }
    // Exact for lean gas, so that it does not depend on the division into steps.
    let burnt = left * (1.0 - maths::exp(-fuel.rate_hz * kindled * mixing() * dt_s / left.max(LEAN)));
    scalar[FUEL] = left - burnt;
    scalar[TEMPERATURE] = (scalar[TEMPERATURE] + fuel.heat * burnt).clamp(0.0, HOTTEST);
    scalar[SMOKE] = (scalar[SMOKE] + burnt).clamp(0.0, 1.0);
    // Not cut off at larger amounts: interpolation between cells stays smooth, and a thin flame is not lost.
    let kindled = smooth_step((scalar[TEMPERATURE] - fuel.ignition) / KINDLING_ON_FRONT);
    (fuel.expansion * burnt / dt_s, kindled * scalar[FUEL] * (0.5 / FUEL_ON_FRONT))
}

/// Expands the gas behind a blue core's front, and cools it farther away; returns source and front.
#[inline(always)]
fn burn_core(core: &Core, scalar: &mut [f32; 4], mixing: impl Fn() -> f32) -> (f32, f32) {
    let depths = scalar[FUEL] / core.depth_m;
    if depths < 0.0 {
        (scalar[TEMPERATURE], scalar[SMOKE]) = (0.0, 1.0);
        return (0.0, 1.0);
    }
    scalar[SMOKE] = scalar[SMOKE].clamp(0.0, 1.0);
    scalar[TEMPERATURE] = (scalar[TEMPERATURE] * core.kept).clamp(0.0, HOTTEST);
    if depths >= 2.0 {
        return (0.0, scalar[TEMPERATURE]);
    }
    if depths < 1.0 {
        scalar[TEMPERATURE] = scalar[TEMPERATURE].max(depths);
    }
    // All of the expansion lies on the burnt side; otherwise it would inflate the core itself. The front that makes the
    // sound encloses it, together with the hot gas.
    let peak = delta(scalar[FUEL] - 0.5 * core.depth_m, 0.5 * core.depth_m);
    let source = if peak > 0.0 { core.expanding_m_s * mixing() * peak } else { 0.0 };
    (source, scalar[TEMPERATURE].max(1.0 - 0.5 * depths))
}

/// A smooth step from 0 (below 0) to 1 (above 1).
fn smooth_step(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// A peak of area 1 over -`width`..`width`.
fn delta(distance: f32, width: f32) -> f32 {
    if distance.abs() >= width {
        return 0.0;
    }
    (1.0 + maths::cos(std::f32::consts::PI * distance / width)) / (2.0 * width)
}
