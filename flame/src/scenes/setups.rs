//! Set-up of each scene: box and gas; its emitters are those of its [`Script`].
//!
//! Lengths are those of the papers where stated (a dragon 1.2 m high, a box 1.5 m wide). The others were chosen so that
//! the pressure resembles fire's: bursts, with energy from 30 to 180 Hz.

use super::script::Script;
use super::{Options, Scene};
use crate::error::Error;
use crate::solver::{Combustion, Cooling, Domain, Mixing, Parameters, Side};

/// Everything that a simulation needs.
pub(super) struct Setup {
    pub domain: Domain,
    pub parameters: Parameters,
    pub script: Script,
}

/// Sides of a box that is open all round.
const OPEN: [[Side; 2]; 3] = [[Side::Open; 2]; 3];
/// Sides of a box that is open except for a floor.
const FLOOR: [[Side; 2]; 3] = [[Side::Open; 2], [Side::Open; 2], [Side::Wall, Side::Open]];
/// Sides of a closed box.
const CLOSED: [[Side; 2]; 3] = [[Side::Wall; 2]; 3];

/// Combustion of fuel in most scenes.
const FUEL: Combustion = Combustion::Fuel { ignition: 0.2, rate_hz: 8.0, heat: 1.5, expansion: 2.0 };

/// Spread of the burn rate's logarithm by mixing: a few times faster or slower from eddy to eddy.
const SPREAD: f64 = 1.0;
/// Frequencies in Hz at which mixing changes: those that the resolved flow does not reach, up to the limit of 360 steps
/// per second.
const MIXING_HZ: (f64, f64) = (12.0, 170.0);

pub(super) fn setup(scene: Scene, options: &Options) -> Result<Setup, Error> {
    let base = Parameters {
        combustion: Some(FUEL),
        cooling: Cooling { radiation_hz: 2.0, dissipation_hz: 0.5 },
        buoyancy_m_s2: 25.0,
        confinement: 0.35 * options.turbulence,
        // The viscosity of air is far below that of the grid.
        viscosity_m2_s: 0.0,
        turbulence_m_s2: 30.0 * options.turbulence,
        turbulence_scale_m: 0.3,
        turbulence_rate_hz: 6.0,
        turbulence_origin_m: [0.0; 3],
        mixing: Mixing {
            spread: SPREAD * options.turbulence.sqrt(),
            scale_m: 0.25,
            slowest_hz: MIXING_HZ.0,
            fastest_hz: MIXING_HZ.1,
        },
    };
    let mixed = |scale_m: f64| Mixing { scale_m, ..base.mixing };
    let (size_m, sides, parameters) = match scene {
        Scene::Candle => {
            let mut sides = FLOOR;
            sides[0][0] = Side::Inflow(0.8 * options.wind);
            let combustion = Some(Combustion::Fuel { ignition: 0.2, rate_hz: 16.0, heat: 1.5, expansion: 2.0 });
            let parameters = Parameters {
                combustion,
                turbulence_scale_m: 0.1,
                turbulence_rate_hz: 10.0,
                mixing: mixed(0.06),
                ..base
            };
            ([0.32, 0.16, 0.32], sides, parameters)
        }
        Scene::Torch => {
            let combustion =
                Some(Combustion::BlueCore { flame_speed_m_s: 0.5, expansion: 4.0, depth_m: 0.05, fall_s: 0.4 });
            let turbulence_m_s2 = 4.0 * base.turbulence_m_s2;
            (
                [1.2, 0.6, 1.2],
                OPEN,
                Parameters { combustion, turbulence_m_s2, turbulence_rate_hz: 10.0, mixing: mixed(0.12), ..base },
            )
        }
        Scene::FlameJet => {
            ([1.5, 1.0, 1.0], CLOSED, Parameters { turbulence_m_s2: 2.0 * base.turbulence_m_s2, ..base })
        }
        Scene::BurningBrick => ([1.0, 0.5, 0.75], OPEN, Parameters { mixing: mixed(0.16), ..base }),
        Scene::Dragon => ([2.4, 1.2, 1.2], OPEN, Parameters { turbulence_m_s2: 2.0 * base.turbulence_m_s2, ..base }),
        Scene::Campfire => ([1.125, 1.125, 1.8], FLOOR, base),
        Scene::Flamethrower => {
            let turbulence_m_s2 = 4.0 * base.turbulence_m_s2;
            ([2.0, 4.0, 2.0], OPEN, Parameters { turbulence_m_s2, mixing: mixed(0.5), ..base })
        }
        Scene::Explosion => {
            let turbulence_m_s2 = 4.0 * base.turbulence_m_s2;
            ([2.4, 2.4, 3.6], FLOOR, Parameters { turbulence_m_s2, mixing: mixed(0.5), ..base })
        }
    };
    let (shape, voxel_size_m) = cells(size_m, options.resolution);
    let domain = Domain::new(shape, voxel_size_m, sides)?;
    // Eddies belong to the world, regardless of the cells.
    let parameters = Parameters { turbulence_origin_m: domain.origin_m(), ..parameters };
    Ok(Setup { domain, parameters, script: Script::new(scene, options.seed) })
}

/// A box of about `size_m`, with `resolution` cells along its longest side: multiples of 8, or below 32 of 2. The other
/// sides have multiples of 4 or 2, so that the box is nearly the same for all.
fn cells(size_m: [f64; 3], resolution: usize) -> ([usize; 3], f64) {
    let longest = size_m.iter().copied().fold(0.0, f64::max);
    let unit = if resolution >= 32 { 8 } else { 2 };
    let along = resolution.div_ceil(unit) * unit;
    let voxel_size_m = longest / along as f64;
    let unit = if resolution >= 32 { 4 } else { 2 };
    let shape = size_m.map(|size| ((size / voxel_size_m / unit as f64).round() as usize * unit).max(4));
    (shape, voxel_size_m)
}
