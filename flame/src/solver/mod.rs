//! Flame solver: flow, fire and heat in a box.
//!
//! Three-dimensional incompressible flow with a source of volume where it burns (Chadwick & James 2011, eq. 1) on a
//! staggered grid; one [`Solver::step`] is
//!
//! ```text
//! emitters ─ advection ─ burning ─ forces ─ sides ─ pressure
//!            (advect)   (combustion, (forces) (faces) (pressure)
//!                        level_set)
//! ```
//!
//! The result is the same for any number of threads, and however a run is divided by [`Solver::save`] and
//! [`Solver::load`].

mod activity;
mod advect;
mod checkpoint;
mod combustion;
mod domain;
mod emitter;
mod faces;
mod forces;
mod lattice;
mod level_set;
mod mixing;
mod near_front;
mod parallel;
mod parameters;
mod pressure;
mod random;
mod sources;
mod turbulence;

use rayon::prelude::*;

pub use combustion::{Combustion, Cooling};
pub use domain::{Domain, Side};
pub use emitter::{Emitter, EmitterShape};
pub use mixing::Mixing;
pub use parameters::Parameters;
pub use pressure::Poisson;
pub use random::Random;
pub use turbulence::Turbulence;

use activity::Activity;
use advect::{InflowBoundary, Neglect, SampleSite, Trajectories, advect};
use combustion::{FUEL, Fire, TEMPERATURE};
use domain::cell_index;
use faces::Faces;
use forces::{Forces, Gas};
use lattice::Lattice;
use level_set::{BAND_CELLS, LevelSet};
use mixing::MixingField;
use parallel::{planes, rows};

use crate::error::Error;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::velocity::{Placement, Velocity};

/// Cells that gas may cross in one substep; more would lose detail.
const CELLS_PER_SUBSTEP: f32 = 2.5;

/// Largest number of substeps in a step.
const MOST_SUBSTEPS: f32 = 4.0;

/// Cells that gas may cross in one step: faster gas is slowed down to this. No realistic flame reaches it.
const FASTEST_CELLS: f32 = 16.0;

/// Remaining divergence, relative to the largest speed per voxel.
const TOLERANCE: f64 = 4e-5;

/// Velocity differences between neighbouring cells of a flame's box, relative to the largest speed, that do not need
/// second-order advection: those of air far from the flame.
const NEGLIGIBLE: f32 = 2e-3;

/// Forcing of the box from outside during one step.
#[derive(Debug, Clone, Default)]
pub struct Forcing {
    /// The emitters.
    pub emitters: Vec<Emitter>,
    /// Speed of all inflows beyond their mean, in m/s.
    pub gust_m_s: f64,
    /// Random part of the inflows, rms in m/s.
    pub unrest_m_s: f64,
    /// Increase of the mixing and burn rate relative to the usual one; -1 to 100.
    pub mixing_boost: f64,
}

/// Results of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Largest speed of any component in m/s.
    pub fastest_m_s: f64,
    /// Largest remaining divergence, with the source subtracted, in 1/s.
    pub divergence_hz: f64,
    /// Number of substeps in the step.
    pub substeps: usize,
}

/// The gas in its box.
#[derive(Debug)]
pub struct Solver {
    domain: Domain,
    parameters: Parameters,
    seed: u64,
    velocity: Faces,
    /// Fuel (or level set), temperature, smoke, age at the cells' centres.
    scalars: Vec<[f32; 4]>,
    /// Pressure over density, times the time step: the starting point of the next solve.
    pressure: Vec<f32>,
    source: Vec<f32>,
    front: Vec<f32>,
    time_s: f64,
    turbulence: Turbulence,
    poisson: Poisson,
    activity: Activity,
    level_set: LevelSet,
    mixing: MixingField,
    forces: Forces,
    scratch: Scratch,
}

/// Working memory of a step; nothing in it outlives the step.
#[derive(Debug, Default)]
struct Scratch {
    centres: Vec<[f32; 4]>,
    acceleration: Vec<[f32; 4]>,
    paths: Trajectories,
    scalars: advect::Scratch<4>,
    faces: advect::Scratch<1>,
    component: Vec<f32>,
}

impl Solver {
    /// Gas at rest, with nothing burning. `seed` is the seed of all randomness.
    ///
    /// # Errors
    /// If a parameter is out of range.
    pub fn new(domain: Domain, parameters: Parameters, seed: u64) -> Result<Self, Error> {
        parameters.validate()?;
        let cells = domain.cells();
        let mixing = mixing_field(&domain, &parameters, seed);
        let mut solver = Self {
            mixing,
            velocity: Faces::new(&domain),
            scalars: vec![[0.0; 4]; cells],
            pressure: vec![0.0; cells],
            source: vec![0.0; cells],
            front: vec![0.0; cells],
            time_s: 0.0,
            turbulence: Turbulence::new(seed),
            poisson: Poisson::new(&domain),
            activity: Activity::default(),
            level_set: LevelSet::default(),
            forces: Forces::default(),
            scratch: Scratch::default(),
            domain,
            parameters,
            seed,
        };
        solver.reset();
        Ok(solver)
    }

    /// Returns to gas at rest.
    pub fn reset(&mut self) {
        let ambient = self.ambient();
        self.velocity = Faces::new(&self.domain);
        self.scalars.fill(ambient);
        self.pressure.fill(0.0);
        self.source.fill(0.0);
        self.front.fill(0.0);
        self.time_s = 0.0;
    }

    /// The box.
    pub fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Seconds since the gas was at rest.
    pub fn time_s(&self) -> f64 {
        self.time_s
    }

    /// Velocity components in m/s on the faces across their axes, with the shape of [`Domain::face_shape`], z fastest.
    pub fn face_velocities(&self) -> [&[f32]; 3] {
        self.velocity.components.each_ref().map(Vec::as_slice)
    }

    /// Sets the flow. `velocity` gives the component along an axis, in m/s, at a position in m (the box's lower corner
    /// is at 0).
    pub fn set_velocity(&mut self, velocity: impl Fn(usize, [f64; 3]) -> f64) {
        let h = self.domain.voxel_size_m();
        for axis in 0..3 {
            let shape = self.domain.face_shape(axis);
            for (index, value) in self.velocity.components[axis].iter_mut().enumerate() {
                let position = [index / (shape[1] * shape[2]), index / shape[2] % shape[1], index % shape[2]];
                let place = std::array::from_fn(|a| {
                    let offset = if a == axis { 0.0 } else { 0.5 };
                    (position[a] as f64 + offset) * h
                });
                *value = velocity(axis, place) as f32;
            }
        }
    }

    /// Fuel at the cells' centres, 0-1; in a blue core, the distance from its front in m, negative in unburnt gas.
    pub fn fuels(&self) -> impl Iterator<Item = f32> + '_ {
        self.scalars.iter().map(|scalar| scalar[FUEL])
    }

    /// Volume that every cell gained in the last substep by burning and bursts, in volumes per second.
    pub fn sources(&self) -> impl Iterator<Item = f32> + '_ {
        self.source.iter().copied()
    }

    /// Temperatures at the cells' centres, 1 = that of a hot flame; z fastest.
    pub fn temperatures(&self) -> impl Iterator<Item = f32> + '_ {
        self.scalars.iter().map(|scalar| scalar[TEMPERATURE])
    }

    /// True if every number in the box is finite.
    pub fn is_finite(&self) -> bool {
        let faces = self.velocity.components.iter().flatten();
        let cells = self.scalars.iter().flatten().chain(&self.front).chain(&self.pressure);
        faces.chain(cells).all(|value| value.is_finite())
    }

    /// Advances by `dt_s` (1e-6 to 1 s).
    pub fn step(&mut self, dt_s: f64, surroundings: &Forcing) -> Step {
        // Runs inside the pool, so that parts of the work do not wait for a thread to wake up.
        rayon::scope(|_| self.step_in_pool(dt_s, surroundings))
    }

    fn step_in_pool(&mut self, dt_s: f64, surroundings: &Forcing) -> Step {
        let dt_s = if dt_s.is_finite() { dt_s.clamp(1e-6, 1.0) } else { 1e-6 };
        let cells_per_step = (dt_s / self.domain.voxel_size_m()) as f32;
        self.velocity.limit(FASTEST_CELLS / cells_per_step);
        let crossed = self.velocity.fastest() * cells_per_step;
        let substeps = (crossed / CELLS_PER_SUBSTEP).ceil().clamp(1.0, MOST_SUBSTEPS);
        let mut result = Step { fastest_m_s: 0.0, divergence_hz: 0.0, substeps: substeps as usize };
        for _ in 0..substeps as usize {
            result.divergence_hz = self.substep(dt_s / f64::from(substeps), surroundings);
        }
        result.fastest_m_s = f64::from(self.velocity.fastest());
        result
    }

    /// Takes a substep and returns the largest remaining divergence, in 1/s. The projection comes last, so that frames, and
    /// the next advection, see a flow whose only divergence is that of burning.
    fn substep(&mut self, dt_s: f64, surroundings: &Forcing) -> f64 {
        self.emit(dt_s, surroundings);
        self.advect(dt_s);
        self.burn(dt_s, surroundings.mixing_boost);
        self.add_expansion(dt_s, surroundings);
        self.apply_forces(dt_s);
        self.diffuse(dt_s);
        self.time_s += dt_s;
        self.apply_boundary_conditions(surroundings);
        self.project()
    }

    /// The front and the flow at the cells' centres, as in files and for the flux.
    ///
    /// # Errors
    /// If the cells' transform is unusable.
    pub fn frame(&self, number: i64) -> Result<Frame, Error> {
        let (front, velocity) = self.centred();
        let transform = self.domain.transform()?;
        let shape = self.domain.shape();
        Ok(Frame {
            number,
            field: Grid::dense(shape, &front, transform)?,
            velocity: Velocity::Vectors(Grid::dense(shape, &velocity, transform)?, Placement::Collocated),
        })
    }

    /// As [`frame`](Self::frame), but with the flow near the front only: all that its flux needs, in less time.
    ///
    /// # Errors
    /// As [`frame`](Self::frame).
    pub fn front_frame(&self, number: i64) -> Result<Frame, Error> {
        near_front::frame(&self.domain, &self.velocity, &self.front, number)
    }

    /// The front's field and the velocity in m/s at the cells' centres, z fastest.
    pub fn centred(&self) -> (Vec<[f32; 1]>, Vec<[f32; 3]>) {
        let mut centres = vec![[0.0; 4]; self.domain.cells()];
        self.velocity.to_centres(&self.domain, &mut centres);
        let velocity = centres.iter().map(|[u, v, w, _]| [*u, *v, *w]).collect();
        (self.front.iter().map(|value| [*value]).collect(), velocity)
    }

    /// Position of the cells: the box's bottom is z = 0, its axis x = y = 0.
    pub fn origin_m(&self) -> [f64; 3] {
        self.domain.origin_m()
    }

    /// State of the gas around the box.
    fn ambient(&self) -> [f32; 4] {
        match self.parameters.combustion {
            // The level set's value far from the front.
            Some(Combustion::BlueCore { .. }) => [BAND_CELLS * self.domain.voxel_size_m() as f32, 0.0, 0.0, 0.0],
            _ => [0.0; 4],
        }
    }

    /// Advects everything with the flow.
    fn advect(&mut self, dt_s: f64) {
        let ambient = self.ambient();
        let Scratch { centres, paths, scalars, faces, .. } = &mut self.scratch;
        centres.resize(self.domain.cells(), [0.0; 4]);
        self.velocity.to_centres(&self.domain, centres);
        paths.trace(&self.domain, centres, (dt_s / self.domain.voxel_size_m()) as f32);
        // One cell more for interpolation, and one for forces that use their neighbours.
        let reach = paths.longest().ceil() as usize + 2;
        self.activity.update(&self.domain, &self.scalars, ambient, reach);
        let entering =
            InflowBoundary::from_sides(&self.domain, ambient, |side| matches!(side, Side::Open | Side::Inflow(_)));
        let neglect = Neglect { activity: Some(&self.activity), difference: 0.0 };
        advect(&mut self.scalars, &self.domain, SampleSite::Centres, paths, &entering, neglect, scalars);
        // The air outside is at rest; inflows have prescribed values.
        let still = InflowBoundary::from_sides(&self.domain, [0.0], |side| side == Side::Open);
        let burns = self.parameters.combustion.is_some();
        let difference = if burns { NEGLIGIBLE * self.velocity.fastest() } else { 0.0 };
        let neglect = Neglect { activity: None, difference };
        for axis in 0..3 {
            let component = self.velocity.components[axis].as_chunks_mut::<1>().0;
            advect(component, &self.domain, SampleSite::Faces(axis), paths, &still, neglect, faces);
        }
    }

    fn burn(&mut self, dt_s: f64, boost: f64) {
        let Some(combustion) = self.parameters.combustion else {
            self.source.fill(0.0);
            return;
        };
        self.mixing.advance(self.time_s, 1.0 + boost);
        let fire = Fire {
            domain: &self.domain,
            origin_m: self.domain.origin_m(),
            mixing: &self.mixing,
            activity: &self.activity,
            dt_s,
        };
        if let Combustion::BlueCore { flame_speed_m_s, .. } = combustion {
            self.level_set.advance(&fire, flame_speed_m_s, &mut self.scalars);
        }
        let cooling = &self.parameters.cooling;
        combustion::burn(&combustion, cooling, &fire, &mut self.scalars, &mut self.source, &mut self.front);
    }

    /// Applies forces, computed from the present flow.
    fn apply_forces(&mut self, dt_s: f64) {
        let Scratch { centres, acceleration, .. } = &mut self.scratch;
        acceleration.resize(self.domain.cells(), [0.0; 4]);
        self.velocity.to_centres(&self.domain, centres);
        let gas = Gas {
            velocity: centres,
            scalars: &self.scalars,
            // Without combustion, the gas may be stirred anywhere; a flame's surrounding air is left alone.
            activity: self.parameters.combustion.map(|_| &self.activity),
            turbulence: &self.turbulence,
            time_s: self.time_s,
        };
        self.forces.evaluate(&self.domain, &self.parameters, &gas, acceleration);
        self.velocity.accelerate(&self.domain, acceleration, dt_s as f32);
    }

    /// Applies viscosity, in as many explicit parts as stability requires, up to 32; beyond that it is limited.
    fn diffuse(&mut self, dt_s: f64) {
        let h = self.domain.voxel_size_m();
        let spread = self.parameters.viscosity_m2_s * dt_s / (h * h);
        let parts = (spread / 0.1).ceil().clamp(0.0, 32.0);
        for _ in 0..parts as usize {
            // An explicit step in three dimensions is unstable beyond a sixth.
            let share = ((spread / parts).min(0.15)) as f32;
            for axis in 0..3 {
                let lattice = Lattice::faces(&self.domain, axis);
                let component = &mut self.velocity.components[axis];
                self.scratch.component.clone_from(component);
                diffuse(&lattice, &self.scratch.component, component, share);
            }
        }
    }

    /// Applies the velocities prescribed by walls and inflows.
    fn apply_boundary_conditions(&mut self, surroundings: &Forcing) {
        let h = self.domain.voxel_size_m();
        let eddies = self.parameters.turbulence_scale_m;
        let turnovers = (self.time_s * self.parameters.turbulence_rate_hz) as f32;
        let (gust, unrest) = (surroundings.gust_m_s as f32, surroundings.unrest_m_s as f32);
        let (turbulence, origin_m) = (&self.turbulence, self.parameters.turbulence_origin_m);
        self.velocity.apply_sides(&self.domain, |axis, end, position| {
            let sign = if end == 0 { 1.0 } else { -1.0 };
            let noise = if unrest == 0.0 {
                0.0
            } else {
                let place = std::array::from_fn(|a| ((position[a] as f64 * h + origin_m[a]) / eddies) as f32);
                turbulence.velocity_at(place, turnovers)[axis]
            };
            sign * gust + unrest * noise
        });
    }

    /// Makes the flow's divergence match the burning; returns the largest deviation, in 1/s.
    fn project(&mut self) -> f64 {
        let fastest = f64::from(self.velocity.fastest());
        let divergence = &mut self.scratch.component;
        divergence.resize(self.domain.cells(), 0.0);
        self.velocity.divergence(&self.domain, &self.source, divergence);
        let tolerance = TOLERANCE * fastest / self.domain.voxel_size_m();
        let worst = self.poisson.solve(divergence, &mut self.pressure, tolerance);
        self.velocity.subtract_gradient(&self.domain, &self.pressure);
        worst
    }
}

/// Mixing in a box, including one cell beyond its sides.
fn mixing_field(domain: &Domain, parameters: &Parameters, seed: u64) -> MixingField {
    let (h, low) = (domain.voxel_size_m(), domain.origin_m());
    let high = std::array::from_fn(|axis| low[axis] + h * domain.shape()[axis] as f64);
    MixingField::new(parameters.mixing, low.map(|low| low - h), high, seed)
}

/// One explicit step of diffusion; there is no gradient at the ends.
fn diffuse(lattice: &Lattice, before: &[f32], after: &mut [f32], share: f32) {
    let [_, ny, nz] = lattice.shape;
    planes(after, ny * nz).enumerate().for_each(|(i, plane)| {
        for ([j, k], value) in rows(plane, nz) {
            let here = before[cell_index(lattice.shape, i, j, k)];
            let next = |axis: usize, upper: bool| {
                let mut place = [i, j, k];
                place[axis] = lattice.beside(axis, place[axis], upper);
                before[cell_index(lattice.shape, place[0], place[1], place[2])] - here
            };
            let sum: f32 = (0..3).map(|axis| next(axis, false) + next(axis, true)).sum();
            *value = here + share * sum;
        }
    });
}
