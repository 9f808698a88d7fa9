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
mod stages;
mod turbulence;

pub use combustion::{Combustion, Cooling};
pub use domain::{Domain, Side};
pub use emitter::{Emitter, EmitterShape};
pub use mixing::Mixing;
pub use parameters::Parameters;
pub use pressure::Poisson;
pub use random::Random;
pub use turbulence::Turbulence;

use activity::Activity;
use advect::Trajectories;
use combustion::{FUEL, TEMPERATURE};
use faces::Faces;
use forces::Forces;
use level_set::{BAND_CELLS, LevelSet};
use mixing::MixingField;

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
}

/// Mixing in a box, including one cell beyond its sides.
fn mixing_field(domain: &Domain, parameters: &Parameters, seed: u64) -> MixingField {
    let (h, low) = (domain.voxel_size_m(), domain.origin_m());
    let high = std::array::from_fn(|axis| low[axis] + h * domain.shape()[axis] as f64);
    MixingField::new(parameters.mixing, low.map(|low| low - h), high, seed)
}
