//! The flow in the recorded box: its inflow and its motion.

use super::recipe::{FlowModel, Recipe};
use crate::error::Error;
use crate::scenes::Wander;
use crate::solver::{Domain, Emitter, EmitterShape, Forcing, Parameters, Side, Solver, Step};

/// Vorticity confinement, as a share of the mean speed over a voxel: it makes the smallest eddies grow by this much in
/// each voxel that they pass, and without limit in a box that they hardly leave. The second is the solver's maximum.
const CONFINEMENT: f64 = 0.02;
const MOST_CONFINEMENT: f64 = 100.0;

/// Rms acceleration that stirs hot gas and the gas of a jet, in squares of the speed over the box's width: the
/// turbulence that they had before entering. Stirring acts all the way; more of it would make eddies faster than the
/// flow, and drown the flow's own.
const STIRRING: f64 = 1.5;
/// Largest stirring in m/s² that the solver accepts.
const MOST_STIRRING_M_S2: f64 = 10_000.0;

/// Ratio of speed to √(2 × buoyancy × height) in a fire, the same from the flames to far above them (McCaffrey 1979).
const RISE: f64 = 0.9;
/// Largest buoyancy in m/s² that the solver accepts.
const MOST_BUOYANCY_M_S2: f64 = 1000.0;

/// Number of hot patches, and their radius as a share of the box's width.
const PATCHES: u64 = 4;
const PATCH_RADIUS: f64 = 0.14;

/// Radius of a jet as a share of the box's width.
const JET_RADIUS: f64 = 0.15;
/// Mean speed of a jet's box, as a share of the jet's: the gas of the jet, and the gas that it draws along.
const JET_MEAN: f64 = 0.35;
/// Share of its speed by which a jet sways.
const JET_SWAY: f64 = 0.1;

/// Rate at which gas in the lowest voxels approaches the mean flow, in speeds over a voxel. The inflow's sideways
/// motion follows the gas above it; otherwise a wind through the periodic sides, once present, would persist and grow.
const STEADYING: f64 = 0.2;

/// Frequencies at which patches and jets move, in speeds over the box's width. With slower motion, a slow row would
/// depend on chance during its few passages.
const PACES: std::ops::Range<f64> = 0.5..4.0;

/// Gas in motion.
#[derive(Debug)]
pub(super) struct Flow {
    solver: Solver,
    step_s: f64,
    sources: Vec<MovingEmitter>,
    steady: Emitter,
    unrest_m_s: f64,
    mean_m_s: f64,
}

/// A source at the bottom, and the three motions that move it.
#[derive(Debug)]
struct MovingEmitter {
    emitter: Emitter,
    kind: FlowModel,
    motion: [Wander; 3],
    width_m: f64,
}

impl Flow {
    /// Gas at `speed_m_s` throughout the box, with steps of `step_s`.
    ///
    /// # Errors
    /// If the recipe, the speed or the step is out of range.
    pub fn new(recipe: &Recipe, speed_m_s: f64, step_s: f64) -> Result<Self, Error> {
        let mean_m_s = if recipe.kind == FlowModel::Jet { JET_MEAN * speed_m_s } else { speed_m_s };
        let sides = [[Side::Periodic; 2], [Side::Periodic; 2], [Side::Inflow(mean_m_s), Side::Open]];
        let domain = Domain::new(recipe.voxels, recipe.voxel_size_m, sides)?;
        // Rows identical except for their pace would beat when mixed.
        let seed = recipe.seed.wrapping_mul(0x1_0000_0001).wrapping_add(u64::from((speed_m_s as f32).to_bits()));
        let mut solver = Solver::new(domain, parameters(recipe, speed_m_s, mean_m_s), seed)?;
        solver.set_velocity(|axis, _| if axis == 2 { mean_m_s } else { 0.0 });
        let steady = steady(recipe, speed_m_s, mean_m_s);
        let sources = sources(recipe, speed_m_s, seed);
        Ok(Self { solver, step_s, sources, steady, unrest_m_s: recipe.perturbation * speed_m_s, mean_m_s })
    }

    /// Takes one step.
    pub fn step(&mut self) -> Step {
        let time_s = self.solver.time_s();
        let surroundings = Forcing {
            emitters: std::iter::once(self.steady)
                .chain(self.sources.iter().map(|source| source.emitter_at(time_s)))
                .collect(),
            unrest_m_s: self.unrest_m_s,
            ..Forcing::default()
        };
        self.solver.step(self.step_s, &surroundings)
    }

    /// The gas.
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// Number of steps in which the mean flow passes through the box.
    pub fn passage_steps(&self) -> usize {
        let domain = self.solver.domain();
        let height_m = domain.shape()[2] as f64 * domain.voxel_size_m();
        (height_m / (self.mean_m_s * self.step_s)).ceil() as usize
    }

    /// Variance of the flow's velocity about its mean, in m²/s².
    pub fn unrest_m2_s2(&self) -> f64 {
        let power = |axis: usize, values: &[f32]| {
            let mean = if axis == 2 { self.mean_m_s } else { 0.0 };
            values.iter().map(|value| maths::square(f64::from(*value) - mean)).sum::<f64>() / values.len() as f64
        };
        self.solver.face_velocities().into_iter().enumerate().map(|(axis, values)| power(axis, values)).sum()
    }
}

/// Width in m of the box.
fn width_m(recipe: &Recipe) -> f64 {
    let [nx, ny, _] = recipe.voxels;
    nx.min(ny) as f64 * recipe.voxel_size_m
}

/// Forces in a box for gas of `speed_m_s`, whose mean over the box is `mean_m_s`.
fn parameters(recipe: &Recipe, speed_m_s: f64, mean_m_s: f64) -> Parameters {
    let (width_m, voxel_size_m) = (width_m(recipe), recipe.voxel_size_m);
    // Buoyancy accelerates gas to this speed, here within the box. Fast gas comes from further below and is just as
    // unsteady; the box provides its share all the same.
    let buoyancy_m_s2 = maths::square(speed_m_s / RISE) / (2.0 * recipe.voxels[2] as f64 * voxel_size_m);
    Parameters {
        buoyancy_m_s2: if recipe.kind == FlowModel::Fire { buoyancy_m_s2.min(MOST_BUOYANCY_M_S2) } else { 0.0 },
        confinement: (CONFINEMENT * mean_m_s / voxel_size_m).min(MOST_CONFINEMENT),
        // The disturbance fits the periodic sides, and moves with the gas.
        turbulence_m_s2: (STIRRING * maths::square(speed_m_s) / width_m).min(MOST_STIRRING_M_S2),
        turbulence_scale_m: width_m,
        turbulence_rate_hz: speed_m_s / width_m,
        ..Parameters::still()
    }
}

/// An emitter without effect.
fn still(recipe: &Recipe) -> Emitter {
    Emitter {
        shape: EmitterShape::Ball { radius_m: width_m(recipe) },
        centre_m: [0.0; 3],
        velocity_m_s: [0.0; 3],
        drag_hz: 0.0,
        fuel: 0.0,
        flicker: 0.0,
        temperature: 0.0,
        outflow_hz: 0.0,
    }
}

/// The lowest voxels, where gas approaches the mean flow.
fn steady(recipe: &Recipe, speed_m_s: f64, mean_m_s: f64) -> Emitter {
    let voxel_size_m = recipe.voxel_size_m;
    let [nx, ny, _] = recipe.voxels;
    let half_m = [nx as f64 * voxel_size_m, ny as f64 * voxel_size_m, 0.5 * voxel_size_m];
    Emitter {
        shape: EmitterShape::Box { half_m },
        centre_m: [0.0, 0.0, half_m[2]],
        velocity_m_s: [0.0, 0.0, mean_m_s],
        drag_hz: STEADYING * speed_m_s / voxel_size_m,
        ..still(recipe)
    }
}

/// Hot patches of a fire, or a jet.
fn sources(recipe: &Recipe, speed_m_s: f64, seed: u64) -> Vec<MovingEmitter> {
    let (width_m, voxel_size_m) = (width_m(recipe), recipe.voxel_size_m);
    let pace_hz = speed_m_s / width_m;
    let source = |number: u64, emitter: Emitter| MovingEmitter {
        emitter,
        kind: recipe.kind,
        motion: std::array::from_fn(|axis| {
            let motion = seed.wrapping_mul(64).wrapping_add(3 * number + axis as u64);
            Wander::new(motion, PACES.start * pace_hz, PACES.end * pace_hz)
        }),
        width_m,
    };
    let disc = |radius: f64, voxels: f64| Emitter {
        shape: EmitterShape::Cylinder { radius_m: radius * width_m, half_height_m: 0.5 * voxels * voxel_size_m },
        centre_m: [0.0, 0.0, 0.5 * voxels * voxel_size_m],
        ..still(recipe)
    };
    match recipe.kind {
        FlowModel::Wind => vec![],
        FlowModel::Fire => {
            (0..PATCHES).map(|number| source(number, Emitter { temperature: 1.0, ..disc(PATCH_RADIUS, 2.0) })).collect()
        }
        FlowModel::Jet => {
            let drag_hz = 4.0 * speed_m_s / voxel_size_m;
            let velocity_m_s = [0.0, 0.0, speed_m_s];
            vec![source(0, Emitter { velocity_m_s, drag_hz, temperature: 1.0, ..disc(JET_RADIUS, 3.0) })]
        }
    }
}

impl MovingEmitter {
    fn emitter_at(&self, time_s: f64) -> Emitter {
        let [x, y, strength] = self.motion.each_ref().map(|motion| motion.value_at(time_s));
        let mut emitter = self.emitter;
        match self.kind {
            FlowModel::Wind => {}
            FlowModel::Fire => {
                let reach = 0.2 * self.width_m;
                emitter.centre_m[0] = (reach * x).clamp(-0.35 * self.width_m, 0.35 * self.width_m);
                emitter.centre_m[1] = (reach * y).clamp(-0.35 * self.width_m, 0.35 * self.width_m);
                emitter.temperature = (0.6 + 0.4 * strength).clamp(0.0, 1.0);
            }
            FlowModel::Jet => {
                let speed = self.emitter.velocity_m_s[2];
                emitter.velocity_m_s =
                    [JET_SWAY * speed * x, JET_SWAY * speed * y, speed * (1.0 + JET_SWAY * strength)];
            }
        }
        emitter
    }
}
