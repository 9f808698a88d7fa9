//! Stages of a substep: advection, burning, forces, viscosity, boundary conditions and pressure.

use rayon::prelude::*;

use super::advect::{InflowBoundary, Neglect, SampleSite, advect};
use super::combustion::{self, Combustion, Fire};
use super::domain::{Side, cell_index};
use super::forces::Gas;
use super::lattice::Lattice;
use super::parallel::{planes, rows};
use super::{Forcing, Scratch, Solver};

/// Remaining divergence, relative to the largest speed per voxel.
const TOLERANCE: f64 = 4e-5;

/// Velocity differences between neighbouring cells of a flame's box, relative to the largest speed, that do not need
/// second-order advection: those of air far from the flame.
const NEGLIGIBLE: f32 = 2e-3;

impl Solver {
    /// Advects everything with the flow.
    pub(super) fn advect(&mut self, dt_s: f64) {
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

    /// Burns fuel, and moves a blue core's front.
    pub(super) fn burn(&mut self, dt_s: f64, boost: f64) {
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
    pub(super) fn apply_forces(&mut self, dt_s: f64) {
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
    pub(super) fn diffuse(&mut self, dt_s: f64) {
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
    pub(super) fn apply_boundary_conditions(&mut self, surroundings: &Forcing) {
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
    pub(super) fn project(&mut self) -> f64 {
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
