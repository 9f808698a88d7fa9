//! Decision that a flow is settled and may be recorded.
//!
//! A flow is settled if the variance of its velocity over three passages through the box equals that over the three
//! before to within a fifth, and if continuity held at every step of them (the paper's criterion, §5.1). The energy of
//! the mean flow is excluded, since it would hide a growing fluctuation. A flow that is never steady for that long is
//! also settled if the second half of sixty passages is as unsteady as the first: it sways, but does not grow.

use super::flow::Flow;
use crate::error::Error;

/// Passages of the mean flow through the box that are compared with as many before.
const PASSAGES: usize = 3;
/// Number of such stretches before the flow is judged by halves.
const STRETCHES: usize = 20;

/// Largest allowed change of the velocity variance, relative to the larger.
const MOST_CHANGE: f64 = 0.2;

/// Largest allowed divergence, relative to the largest speed per voxel.
const MOST_DIVERGENCE: f64 = 1e-3;

/// Runs a flow until it has settled.
///
/// # Errors
/// If it has not settled after all [`STRETCHES`], or if `go_on` fails.
pub(super) fn settle(flow: &mut Flow, mut go_on: impl FnMut() -> Result<(), Error>) -> Result<(), Error> {
    let steps = PASSAGES * flow.passage_steps();
    let voxel_size_m = flow.solver().domain().voxel_size_m();
    let mut energies: Vec<f64> = vec![];
    let mut divergence = 0.0;
    while energies.len() < STRETCHES {
        let mut energy = 0.0;
        divergence = 0.0;
        for _ in 0..steps {
            go_on()?;
            let step = flow.step();
            energy += flow.unrest_m2_s2() / steps as f64;
            let fastest = step.fastest_m_s.max(f64::MIN_POSITIVE);
            divergence = f64::max(divergence, step.divergence_hz * voxel_size_m / fastest);
        }
        let is_steady = energies.last().is_some_and(|before| change(*before, energy) <= MOST_CHANGE);
        energies.push(energy);
        if is_steady && divergence <= MOST_DIVERGENCE {
            return Ok(());
        }
    }
    let (first, second) = energies.split_at(STRETCHES / 2);
    let change = change(first.iter().sum(), second.iter().sum());
    if change <= MOST_CHANGE && divergence <= MOST_DIVERGENCE {
        return Ok(());
    }
    Err(Error::Unsettled { passages: PASSAGES * STRETCHES, change, divergence })
}

/// Difference of two energies relative to the larger; 0 if both are zero.
fn change(one: f64, other: f64) -> f64 {
    (other - one).abs() / one.max(other).max(f64::MIN_POSITIVE)
}
