//! Scenes: the five of Chadwick & James 2011 (§6) and the three of Dobashi et al. 2004 (§6), ready to simulate.

mod bursts;
mod script;
mod setups;
mod wander;

pub use bursts::Bursts;
pub use wander::Wander;

use crate::error::{Error, in_range};
use crate::frame::Frame;
use crate::solver::{Forcing, Solver, Step};

/// Steps per second of sound, in the paper's simulations and in these.
pub const STEP_RATE_HZ: f64 = 360.0;

/// The kind of fire.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Scene {
    /// A small flame blown by a turbulent wind.
    Candle,
    /// A torch swung through the air; a blue core.
    Torch,
    /// Fuel injected into a closed box in pulses, at high speed.
    FlameJet,
    /// A small, rapidly moving burning block.
    BurningBrick,
    /// A fire-breathing dragon's modulated breath.
    Dragon,
    /// A wide, randomly perturbed source of heat.
    Campfire,
    /// A long jet.
    Flamethrower,
    /// Bursts whose speed decays, then rising flow.
    Explosion,
}

impl Scene {
    /// All scenes.
    pub const ALL: [Self; 8] = [
        Self::Candle,
        Self::Torch,
        Self::FlameJet,
        Self::BurningBrick,
        Self::Dragon,
        Self::Campfire,
        Self::Flamethrower,
        Self::Explosion,
    ];

    /// Name in commands and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Candle => "candle",
            Self::Torch => "torch",
            Self::FlameJet => "flame_jet",
            Self::BurningBrick => "burning_brick",
            Self::Dragon => "dragon",
            Self::Campfire => "campfire",
            Self::Flamethrower => "flamethrower",
            Self::Explosion => "explosion",
        }
    }

    /// One-line description.
    pub fn summary(self) -> &'static str {
        match self {
            Self::Candle => "A small flame blown by a turbulent wind",
            Self::Torch => "A torch swung through the air",
            Self::FlameJet => "Fuel injected into a closed box in pulses",
            Self::BurningBrick => "A small, rapidly moving burning block",
            Self::Dragon => "A fire-breathing dragon",
            Self::Campfire => "A wide, randomly perturbed fire",
            Self::Flamethrower => "A long jet",
            Self::Explosion => "Bursts, then rising flow",
        }
    }

    /// Seconds after which the scene repeats, if it does.
    pub fn period_s(self) -> Option<f64> {
        match self {
            Self::FlameJet => Some(script::JET_PERIOD_S),
            Self::Explosion => Some(script::BURST_PERIOD_S),
            _ => None,
        }
    }

    /// The scene with a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name() == name)
    }

    /// Default number of seconds simulated before the first recorded one: a flame that always burns should not begin
    /// with its ignition.
    pub fn default_pre_roll_s(self) -> f64 {
        match self {
            Self::FlameJet | Self::Explosion => 0.0,
            _ => 0.5,
        }
    }
}

/// Options of a simulated scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Cells along the longest side of the box: 8-512, rounded up to a multiple of 8 (below 32, of 2), for which the
    /// pressure solve is fast.
    pub resolution: usize,
    /// Random seed.
    pub seed: u64,
    /// Amount and speed of the fuel, 0-4; 1 as designed.
    pub intensity: f64,
    /// Wind and motion of the burning object, 0-4; 1 as designed.
    pub wind: f64,
    /// Turbulence and vorticity confinement, 0-4; 1 as designed.
    pub turbulence: f64,
}

impl Default for Options {
    /// The scene as designed, with 64 cells.
    fn default() -> Self {
        Self { resolution: 64, seed: 1, intensity: 1.0, wind: 1.0, turbulence: 1.0 }
    }
}

impl Options {
    fn validate(&self) -> Result<(), Error> {
        in_range("resolution", self.resolution as f64, 8.0, 512.0)?;
        in_range("intensity", self.intensity, 0.0, 4.0)?;
        in_range("wind", self.wind, 0.0, 4.0)?;
        in_range("turbulence", self.turbulence, 0.0, 4.0)
    }
}

/// A running simulation of a scene.
#[derive(Debug)]
pub struct Simulation {
    scene: Scene,
    options: Options,
    script: script::Script,
    solver: Solver,
    steps: u64,
}

impl Simulation {
    /// The scene before its first step.
    ///
    /// # Errors
    /// If an option is out of range.
    pub fn new(scene: Scene, options: Options) -> Result<Self, Error> {
        options.validate()?;
        let setup = setups::setup(scene, &options)?;
        let solver = Solver::new(setup.domain, setup.parameters, options.seed)?;
        Ok(Self { scene, options, script: setup.script, solver, steps: 0 })
    }

    /// The kind of fire.
    pub fn scene(&self) -> Scene {
        self.scene
    }

    /// Its options.
    pub fn options(&self) -> &Options {
        &self.options
    }

    /// Returns to the state before the first step.
    pub fn reset(&mut self) {
        self.solver.reset();
        self.steps = 0;
    }

    /// Number of steps taken.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Takes one step of 1/360 s.
    pub fn step(&mut self) -> Step {
        let surroundings = self.surroundings();
        self.steps += 1;
        self.solver.step(1.0 / STEP_RATE_HZ, &surroundings)
    }

    /// Forcing of the gas at the present step.
    pub fn surroundings(&self) -> Forcing {
        self.script.forcing_at(self.steps as f64 / STEP_RATE_HZ, &self.options)
    }

    /// Front and flow after the last step, numbered by the steps taken.
    ///
    /// # Errors
    /// As [`Solver::frame`].
    pub fn frame(&self) -> Result<Frame, Error> {
        self.solver.frame(i64::try_from(self.steps).unwrap_or(i64::MAX))
    }

    /// As [`frame`](Self::frame), but with the flow near the front only: all that its flux needs, in less time.
    ///
    /// # Errors
    /// As [`Solver::frame`].
    pub fn front_frame(&self) -> Result<Frame, Error> {
        self.solver.front_frame(i64::try_from(self.steps).unwrap_or(i64::MAX))
    }

    /// The gas.
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// Writes everything that the next step depends on.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn save(&self, mut to: impl std::io::Write) -> std::io::Result<()> {
        to.write_all(&self.steps.to_le_bytes())?;
        self.solver.save(to)
    }

    /// Restores a state saved by the same scene with the same options.
    ///
    /// # Errors
    /// If the bytes end early or belong to another run; the scene is then before its first step.
    pub fn load(&mut self, mut from: impl std::io::Read) -> Result<(), Error> {
        let mut word = [0; 8];
        let steps = from.read_exact(&mut word).map_err(|_| Error::Checkpoint { reason: "it ends early" });
        let loaded = steps.and_then(|()| self.solver.load(from));
        match loaded {
            Ok(()) => self.steps = u64::from_le_bytes(word),
            Err(_) => self.reset(),
        }
        loaded
    }
}
