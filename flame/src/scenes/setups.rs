//! Set-up of each scene: box, gas, emitters, and their motion.
//!
//! Lengths are those of the papers where stated (a dragon 1.2 m high, a box 1.5 m wide). The others were chosen so that
//! the pressure resembles fire's: bursts, with energy from 30 to 180 Hz.

use std::f64::consts::TAU;

use super::{Bursts, Options, Scene, Wander};
use crate::error::Error;
use crate::solver::{Combustion, Cooling, Domain, Emitter, EmitterShape, Forcing, Mixing, Parameters, Side};

/// Everything that a simulation needs.
pub(super) struct Setup {
    pub domain: Domain,
    pub parameters: Parameters,
    pub script: Script,
}

/// A scene's motion over time.
#[derive(Debug)]
pub(super) struct Script {
    scene: Scene,
    /// Slow and fast random motion.
    slow: [Wander; 3],
    fast: Wander,
    /// Times of the flare-ups, and the burn rates between bursts and at the peak of a typical one, relative to the
    /// usual.
    bursts: Bursts,
    burning: [f64; 2],
}

/// Sides of a box that is open all round.
const OPEN: [[Side; 2]; 3] = [[Side::Open; 2]; 3];
/// Sides of a box that is open except for a floor.
const FLOOR: [[Side; 2]; 3] = [[Side::Open; 2], [Side::Open; 2], [Side::Wall, Side::Open]];
/// Sides of a closed box.
const CLOSED: [[Side; 2]; 3] = [[Side::Wall; 2]; 3];

/// Seconds from pulse to pulse of the flame jet.
pub(super) const JET_PERIOD_S: f64 = 1.5;
/// Seconds from burst to burst of the explosion.
pub(super) const BURST_PERIOD_S: f64 = 2.5;

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
    Ok(Setup { domain, parameters, script: script(scene, options.seed) })
}

fn script(scene: Scene, seed: u64) -> Script {
    let number = |which: u64| seed.wrapping_mul(4).wrapping_add(which);
    // Bursts per second, their fall in seconds, and the burn rate between them and at their peak.
    let (rate_hz, fall_s, burning) = match scene {
        // Gusts of wind.
        Scene::Candle => (2.5, 0.06, [0.45, 2.8]),
        Scene::Torch => (2.0, 0.07, [0.45, 2.6]),
        Scene::BurningBrick => (2.0, 0.07, [0.5, 2.1]),
        Scene::FlameJet => (2.0, 0.08, [0.65, 1.7]),
        Scene::Dragon => (2.0, 0.08, [0.5, 2.4]),
        // A pool of this width puffs 1.5 / sqrt(0.56 m) times a second (Cetegen & Ahmed 1993).
        Scene::Campfire => (2.0, 0.08, [0.5, 2.2]),
        Scene::Flamethrower => (1.5, 0.08, [0.7, 1.5]),
        // Its bursts are the explosions themselves.
        Scene::Explosion => (1.0, 0.1, [1.0, 0.0]),
    };
    Script {
        scene,
        slow: std::array::from_fn(|index| Wander::new(number(index as u64), 0.15, 1.5)),
        fast: Wander::new(number(3), 3.0, 15.0),
        bursts: Bursts::new(number(2).wrapping_add(1 << 32), rate_hz, 0.012, fall_s),
        burning,
    }
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

impl Script {
    /// Forcing of the gas at a time.
    pub fn at(&self, time_s: f64, options: &Options) -> Forcing {
        let (power, wind) = (options.intensity, options.wind);
        let slow = |index: usize| self.slow[index].at(time_s);
        let fast = self.fast.at(time_s);
        let burner = |shape: EmitterShape, centre_m: [f64; 3]| Emitter {
            shape,
            centre_m,
            velocity_m_s: [0.0; 3],
            drag_hz: 0.0,
            fuel: power.min(1.0),
            flicker: 0.0,
            temperature: 1.0,
            outflow_hz: 0.0,
        };
        let (emitter, gust_m_s, unrest_m_s) = match self.scene {
            Scene::Candle => {
                let wick = burner(EmitterShape::Cylinder { radius_m: 0.02, half_height_m: 0.012 }, [-0.08, 0.0, 0.04]);
                let blown = Emitter { velocity_m_s: [0.0, 0.0, 0.6 * power], drag_hz: 40.0, ..wick };
                (blown, wind * (0.4 * slow(0) + 0.25 * fast), 0.35 * wind)
            }
            Scene::Torch => {
                // A swing back and forth, faster in the middle, and slightly irregular.
                let angle = TAU * 0.8 * wind * time_s + 0.5 * slow(0);
                let centre_m = [0.38 * maths::sin(angle), 0.08 * slow(1), 0.3 + 0.1 * maths::cos(2.0 * angle)];
                let head = burner(EmitterShape::Ball { radius_m: 0.07 }, centre_m);
                let flow = 1.2 * power * (1.0 + 0.25 * fast);
                let fuel = if power > 0.0 { 1.0 } else { 0.0 };
                (Emitter { velocity_m_s: [0.0, 0.0, flow], drag_hz: 60.0, fuel, ..head }, 0.0, 0.0)
            }
            Scene::FlameJet => {
                // 0.9 s on, 0.6 s off.
                let on = time_s % JET_PERIOD_S < 0.9;
                let nozzle = burner(EmitterShape::Ball { radius_m: 0.08 }, [-0.62, 0.0, 0.5]);
                let speed = if on { 9.0 * power * (1.0 + 0.1 * fast) } else { 0.0 };
                let jet = Emitter {
                    velocity_m_s: [speed, 0.0, 0.0],
                    drag_hz: 200.0,
                    fuel: if on { nozzle.fuel } else { 0.0 },
                    temperature: if on { 1.0 } else { 0.0 },
                    ..nozzle
                };
                (jet, 0.0, 0.0)
            }
            Scene::BurningBrick => {
                let swing = TAU * 0.9 * wind * time_s;
                let centre_m = [
                    0.32 * maths::sin(swing) + 0.04 * slow(0),
                    0.06 * maths::sin(1.7 * swing),
                    0.28 + 0.09 * maths::sin(1.3 * swing + 1.0),
                ];
                let brick = burner(EmitterShape::Box { half_m: [0.09, 0.05, 0.05] }, centre_m);
                (Emitter { flicker: 0.5, velocity_m_s: [0.0, 0.0, 0.5 * power], drag_hz: 30.0, ..brick }, 0.0, 0.0)
            }
            Scene::Dragon => {
                // Breath comes in blasts, with a flutter on top.
                let breath = (0.55 + 0.6 * slow(0)).clamp(0.0, 1.4) * (1.0 + 0.2 * wind * fast);
                let mouth = burner(
                    EmitterShape::Ball { radius_m: 0.09 },
                    [-1.0, 0.05 * wind * slow(1), 0.6 + 0.05 * wind * slow(2)],
                );
                let jet = Emitter {
                    velocity_m_s: [10.0 * power * breath, 0.0, -1.0],
                    drag_hz: 150.0,
                    fuel: if breath > 0.05 { mouth.fuel } else { 0.0 },
                    ..mouth
                };
                (jet, 0.0, 0.0)
            }
            Scene::Campfire => {
                let pit = burner(EmitterShape::Cylinder { radius_m: 0.28, half_height_m: 0.06 }, [0.0, 0.0, 0.1]);
                let fuel = (power * (0.7 + 0.15 * slow(0))).clamp(0.0, 1.0);
                (
                    Emitter {
                        fuel,
                        flicker: 0.9,
                        velocity_m_s: [0.2 * wind * slow(1), 0.2 * wind * slow(2), 0.6],
                        drag_hz: 10.0,
                        ..pit
                    },
                    0.0,
                    0.0,
                )
            }
            Scene::Flamethrower => {
                let nozzle = burner(EmitterShape::Ball { radius_m: 0.22 }, [0.0, -1.7, 1.0]);
                let speed = 14.0 * power * (1.0 + 0.12 * fast + 0.15 * slow(0));
                let jet = Emitter {
                    velocity_m_s: [0.8 * wind * slow(1), speed, 1.0 + 0.5 * wind * slow(2)],
                    drag_hz: 150.0,
                    ..nozzle
                };
                (jet, 0.0, 0.0)
            }
            Scene::Explosion => {
                // The first burst comes after a tenth of a second.
                let since = (time_s - 0.1).rem_euclid(BURST_PERIOD_S);
                let bursting = time_s >= 0.1 && since < 0.25;
                let ball = burner(EmitterShape::Ball { radius_m: 0.35 }, [0.1 * slow(0), 0.1 * slow(1), 0.6]);
                let burst = Emitter {
                    fuel: if bursting { ball.fuel } else { 0.0 },
                    temperature: if bursting { 1.0 } else { 0.0 },
                    flicker: 0.3,
                    outflow_hz: if bursting { 45.0 * power * maths::exp(-since / 0.06) } else { 0.0 },
                    ..ball
                };
                (burst, 0.0, 0.0)
            }
        };
        let [between, at_peak] = self.burning;
        let mixing_boost = between - 1.0 + at_peak * self.bursts.at(time_s);
        Forcing { emitters: vec![emitter], gust_m_s, unrest_m_s, mixing_boost }
    }
}
