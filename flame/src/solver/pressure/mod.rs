//! The pressure solve: conjugate gradients, preconditioned with one multigrid V-cycle.

mod level;
mod transfer;

use rayon::prelude::*;

use crate::solver::parallel::{PORTION, elements, largest};

use super::domain::{Domain, Side};
use level::{AxisBoundary, Level};
use transfer::Transfer;

/// Iterations after which a solve stops; a converging one needs about ten.
const MOST_ITERATIONS: usize = 200;

/// Poisson's equation over a box: finds p with `laplacian(p) = right side`, p = 0 on open sides and no gradient on
/// walls and inflows.
#[derive(Debug)]
pub struct Poisson {
    levels: Vec<Level>,
    /// Transfers from level l to l + 1.
    transfers: Vec<Transfer>,
    is_closed: bool,
    residual: Vec<f32>,
    direction: Vec<f32>,
    image: Vec<f32>,
    preconditioned: Vec<f32>,
    scratch: Vec<Scratch>,
}

/// A level's unknowns in a V-cycle.
#[derive(Debug)]
struct Scratch {
    right: Vec<f32>,
    solution: Vec<f32>,
    step: Vec<f32>,
    image: Vec<f32>,
}

impl Poisson {
    /// Prepares the levels for a box, which is halved for as long as all its sizes are even.
    pub fn new(domain: &Domain) -> Self {
        let ends = domain.sides().map(|pair| pair.map(ends_of));
        let mut levels = vec![Level::new(domain.shape(), domain.voxel_size_m(), ends)];
        let mut transfers = vec![];
        while let Some(finest) = levels.last()
            && finest.shape().iter().all(|size| size % 2 == 0 && *size >= 4)
        {
            transfers.push(Transfer::new(finest.shape(), &ends));
            let coarser = Level::new(finest.shape().map(|size| size / 2), 2.0 * finest.voxel_size_m(), ends);
            levels.push(coarser);
        }
        let cells = domain.cells();
        let scratch = levels
            .iter()
            .map(|level| {
                let zeros = || vec![0.0; level.cells()];
                Scratch { right: zeros(), solution: zeros(), step: zeros(), image: zeros() }
            })
            .collect();
        Self {
            levels,
            transfers,
            is_closed: domain.is_closed(),
            residual: vec![0.0; cells],
            direction: vec![0.0; cells],
            image: vec![0.0; cells],
            preconditioned: vec![0.0; cells],
            scratch,
        }
    }

    /// Solves for `pressure`, starting from what it holds, until no cell is off by more than `tolerance`. In a closed box
    /// the mean of `right` is taken out first: nothing can leave, so a source compresses the gas everywhere.
    ///
    /// Returns the error of the worst cell.
    pub fn solve(&mut self, right: &mut [f32], pressure: &mut [f32], tolerance: f64) -> f64 {
        if self.is_closed {
            let mean = (sum(right) / right.len() as f64) as f32;
            elements(right).for_each(|value| *value -= mean);
        }
        // The operator is the negative Laplacian, which is positive definite.
        self.levels[0].apply(pressure, &mut self.image);
        let terms = right.par_iter().zip(&self.image);
        elements(&mut self.residual).zip(terms).for_each(|(r, (right, image))| *r = -*right - *image);
        let mut worst = f64::from(largest(&self.residual));
        let mut energy = 0.0;
        for iteration in 0..MOST_ITERATIONS {
            if worst <= tolerance {
                break;
            }
            self.precondition();
            let next = dot(&self.residual, &self.preconditioned);
            if !(next.is_finite() && next > 0.0) {
                break;
            }
            let share = if iteration == 0 { 0.0 } else { (next / energy) as f32 };
            energy = next;
            let steps = elements(&mut self.direction).zip(&self.preconditioned);
            steps.for_each(|(direction, z)| *direction = *z + share * *direction);
            self.levels[0].apply(&self.direction, &mut self.image);
            let stiffness = dot(&self.direction, &self.image);
            if !(stiffness.is_finite() && stiffness > 0.0) {
                break;
            }
            let length = (energy / stiffness) as f32;
            elements(pressure).zip(&self.direction).for_each(|(p, d)| *p += length * *d);
            elements(&mut self.residual).zip(&self.image).for_each(|(r, a)| *r -= length * *a);
            worst = f64::from(largest(&self.residual));
        }
        worst
    }

    /// One V-cycle from zero, from the residual into `preconditioned`.
    fn precondition(&mut self) {
        self.scratch[0].right.copy_from_slice(&self.residual);
        let last = self.levels.len() - 1;
        for (index, level) in self.levels.iter().enumerate() {
            let (upper, lower) = self.scratch.split_at_mut(index + 1);
            let Scratch { right, solution, step, image } = &mut upper[index];
            if index == last {
                level.solve_small(right, solution, step, image);
                break;
            }
            level.smooth_from_zero(right, solution, step, image);
            level.apply(solution, image);
            elements(image).zip(&*right).for_each(|(image, right)| *image = *right - *image);
            self.transfers[index].restrict(image, &mut lower[0].right);
        }
        for index in (0..last).rev() {
            let (upper, lower) = self.scratch.split_at_mut(index + 1);
            let Scratch { right, solution, step, image } = &mut upper[index];
            self.transfers[index].add_prolonged(&lower[0].solution, solution);
            self.levels[index].smooth(right, solution, step, image);
        }
        self.preconditioned.copy_from_slice(&self.scratch[0].solution);
        if self.is_closed {
            let mean = (sum(&self.preconditioned) / self.preconditioned.len() as f64) as f32;
            elements(&mut self.preconditioned).for_each(|value| *value -= mean);
        }
    }
}

fn ends_of(side: Side) -> AxisBoundary {
    match side {
        Side::Open => AxisBoundary::Zero,
        Side::Wall | Side::Inflow(_) => AxisBoundary::Flat,
        Side::Periodic => AxisBoundary::Wrapped,
    }
}

/// Portions have a fixed size and are added in order, so the sum does not depend on the number of threads.
fn sum(values: &[f32]) -> f64 {
    let parts: Vec<f64> =
        values.par_chunks(PORTION).map(|part| part.iter().map(|value| f64::from(*value)).sum()).collect();
    parts.iter().sum()
}

/// A scalar product, added up as in [`sum`].
fn dot(a: &[f32], b: &[f32]) -> f64 {
    let parts: Vec<f64> = a
        .par_chunks(PORTION)
        .zip(b.par_chunks(PORTION))
        .map(|(a, b)| a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum())
        .collect();
    parts.iter().sum()
}
