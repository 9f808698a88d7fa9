//! What happens in each scene over time: its emitter, the wind, and how fast it burns.

use std::f64::consts::TAU;

use super::{Bursts, Options, Scene, Wander};
use crate::solver::{Emitter, EmitterShape, Forcing};

/// Seconds from pulse to pulse of the flame jet.
pub(super) const JET_PERIOD_S: f64 = 1.5;
/// Seconds from burst to burst of the explosion.
pub(super) const BURST_PERIOD_S: f64 = 2.5;

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

impl Script {
    /// The script of a scene; `seed` is the seed of its random motion.
    pub fn new(scene: Scene, seed: u64) -> Self {
        let number = |which: u64| seed.wrapping_mul(4).wrapping_add(which);
        // Bursts per second, their fall in seconds, and the burn rate between them and at their peak. They last about
        // a third of the time, and little burns between them, as in the paper's signals.
        let (rate_hz, fall_s, burning) = match scene {
            // Gusts of wind.
            Scene::Candle => (2.0, 0.14, [0.1, 2.2]),
            Scene::Torch => (1.6, 0.18, [0.15, 1.7]),
            Scene::BurningBrick => (1.7, 0.18, [0.1, 1.9]),
            // Its bursts are mostly the pulses of its fuel.
            Scene::FlameJet => (2.0, 0.08, [0.65, 1.7]),
            Scene::Dragon => (1.6, 0.18, [0.2, 1.9]),
            // A pool of this width puffs 1.5 / sqrt(0.56 m) = 2 times a second (Cetegen & Ahmed 1993); at that rate bursts
            // of this length would leave no pauses.
            Scene::Campfire => (1.6, 0.18, [0.1, 1.9]),
            Scene::Flamethrower => (1.5, 0.18, [0.12, 1.8]),
            // Its bursts are the explosions themselves.
            Scene::Explosion => (1.0, 0.1, [1.0, 0.0]),
        };
        Self {
            scene,
            slow: std::array::from_fn(|index| Wander::new(number(index as u64), 0.15, 1.5)),
            fast: Wander::new(number(3), 3.0, 15.0),
            bursts: Bursts::new(number(2).wrapping_add(1 << 32), rate_hz, 0.012, fall_s),
            burning,
        }
    }

    /// Forcing of the gas at a time.
    pub fn forcing_at(&self, time_s: f64, options: &Options) -> Forcing {
        let fast = self.fast.value_at(time_s);
        let moment = Moment { slow: &self.slow, fast, time_s, power: options.intensity, wind: options.wind };
        let (gust_m_s, unrest_m_s) = match self.scene {
            Scene::Candle => moment.gusts(),
            _ => (0.0, 0.0),
        };
        let emitter = match self.scene {
            Scene::Candle => moment.candle(),
            Scene::Torch => moment.torch(),
            Scene::FlameJet => moment.flame_jet(),
            Scene::BurningBrick => moment.burning_brick(),
            Scene::Dragon => moment.dragon(),
            Scene::Campfire => moment.campfire(),
            Scene::Flamethrower => moment.flamethrower(),
            Scene::Explosion => moment.explosion(),
        };
        let [between, at_peak] = self.burning;
        let mixing_boost = between - 1.0 + at_peak * self.bursts.strength_at(time_s);
        Forcing { emitters: vec![emitter], gust_m_s, unrest_m_s, mixing_boost }
    }
}

/// A moment of a scene, from which its emitter follows.
struct Moment<'a> {
    slow: &'a [Wander; 3],
    /// Value of the fast random motion.
    fast: f64,
    time_s: f64,
    /// The options' intensity and wind.
    power: f64,
    wind: f64,
}

impl Moment<'_> {
    /// Value of a slow random motion.
    fn slow(&self, index: usize) -> f64 {
        self.slow[index].value_at(self.time_s)
    }

    /// An emitter at rest.
    fn burner(&self, shape: EmitterShape, centre_m: [f64; 3]) -> Emitter {
        Emitter {
            shape,
            centre_m,
            velocity_m_s: [0.0; 3],
            drag_hz: 0.0,
            fuel: self.power.min(1.0),
            flicker: 0.0,
            temperature: 1.0,
            outflow_hz: 0.0,
        }
    }

    /// Speed of the wind that blows the candle, and its unrest, in m/s.
    fn gusts(&self) -> (f64, f64) {
        (self.wind * (0.4 * self.slow(0) + 0.25 * self.fast), 0.35 * self.wind)
    }

    fn candle(&self) -> Emitter {
        let wick = self.burner(EmitterShape::Cylinder { radius_m: 0.02, half_height_m: 0.012 }, [-0.08, 0.0, 0.04]);
        Emitter { velocity_m_s: [0.0, 0.0, 0.6 * self.power], drag_hz: 40.0, ..wick }
    }

    fn torch(&self) -> Emitter {
        // A swing back and forth, faster in the middle, and slightly irregular.
        let angle = TAU * 0.8 * self.wind * self.time_s + 0.5 * self.slow(0);
        let centre_m = [0.38 * maths::sin(angle), 0.08 * self.slow(1), 0.3 + 0.1 * maths::cos(2.0 * angle)];
        let head = self.burner(EmitterShape::Ball { radius_m: 0.07 }, centre_m);
        let flow = 1.2 * self.power * (1.0 + 0.25 * self.fast);
        let fuel = if self.power > 0.0 { 1.0 } else { 0.0 };
        Emitter { velocity_m_s: [0.0, 0.0, flow], drag_hz: 60.0, fuel, ..head }
    }

    fn flame_jet(&self) -> Emitter {
        // 0.9 s on, 0.6 s off.
        let on = self.time_s % JET_PERIOD_S < 0.9;
        let nozzle = self.burner(EmitterShape::Ball { radius_m: 0.08 }, [-0.62, 0.0, 0.5]);
        let speed = if on { 9.0 * self.power * (1.0 + 0.1 * self.fast) } else { 0.0 };
        Emitter {
            velocity_m_s: [speed, 0.0, 0.0],
            drag_hz: 200.0,
            fuel: if on { nozzle.fuel } else { 0.0 },
            temperature: if on { 1.0 } else { 0.0 },
            ..nozzle
        }
    }

    fn burning_brick(&self) -> Emitter {
        let swing = TAU * 0.9 * self.wind * self.time_s;
        let centre_m = [
            0.32 * maths::sin(swing) + 0.04 * self.slow(0),
            0.06 * maths::sin(1.7 * swing),
            0.28 + 0.09 * maths::sin(1.3 * swing + 1.0),
        ];
        let brick = self.burner(EmitterShape::Box { half_m: [0.09, 0.05, 0.05] }, centre_m);
        Emitter { flicker: 0.5, velocity_m_s: [0.0, 0.0, 0.5 * self.power], drag_hz: 30.0, ..brick }
    }

    fn dragon(&self) -> Emitter {
        // Breath comes in blasts, with a flutter on top.
        let breath = (0.55 + 0.6 * self.slow(0)).clamp(0.0, 1.4) * (1.0 + 0.2 * self.wind * self.fast);
        let centre_m = [-1.0, 0.05 * self.wind * self.slow(1), 0.6 + 0.05 * self.wind * self.slow(2)];
        let mouth = self.burner(EmitterShape::Ball { radius_m: 0.09 }, centre_m);
        Emitter {
            velocity_m_s: [10.0 * self.power * breath, 0.0, -1.0],
            drag_hz: 150.0,
            fuel: if breath > 0.05 { mouth.fuel } else { 0.0 },
            ..mouth
        }
    }

    fn campfire(&self) -> Emitter {
        let pit = self.burner(EmitterShape::Cylinder { radius_m: 0.28, half_height_m: 0.06 }, [0.0, 0.0, 0.1]);
        Emitter {
            fuel: (self.power * (0.7 + 0.15 * self.slow(0))).clamp(0.0, 1.0),
            flicker: 0.9,
            velocity_m_s: [0.2 * self.wind * self.slow(1), 0.2 * self.wind * self.slow(2), 0.6],
            drag_hz: 10.0,
            ..pit
        }
    }

    fn flamethrower(&self) -> Emitter {
        let nozzle = self.burner(EmitterShape::Ball { radius_m: 0.22 }, [0.0, -1.7, 1.0]);
        let speed = 14.0 * self.power * (1.0 + 0.12 * self.fast + 0.15 * self.slow(0));
        Emitter {
            velocity_m_s: [0.8 * self.wind * self.slow(1), speed, 1.0 + 0.5 * self.wind * self.slow(2)],
            drag_hz: 150.0,
            ..nozzle
        }
    }

    fn explosion(&self) -> Emitter {
        // The first burst comes after a tenth of a second.
        let since = (self.time_s - 0.1).rem_euclid(BURST_PERIOD_S);
        let bursting = self.time_s >= 0.1 && since < 0.25;
        let centre_m = [0.1 * self.slow(0), 0.1 * self.slow(1), 0.6];
        let ball = self.burner(EmitterShape::Ball { radius_m: 0.35 }, centre_m);
        Emitter {
            fuel: if bursting { ball.fuel } else { 0.0 },
            temperature: if bursting { 1.0 } else { 0.0 },
            flicker: 0.3,
            outflow_hz: if bursting { 45.0 * self.power * maths::exp(-since / 0.06) } else { 0.0 },
            ..ball
        }
    }
}
