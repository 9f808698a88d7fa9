//! When a flow may be recorded.
//!
//! Settled is a flow that has passed through the box twice at least, whose energy over one passage is that of the
//! passage before, but for a tenth, and whose continuity was met at every step of it (the paper's criterion, §5.1).

use super::flow::Flow;
use crate::error::Error;

/// Passages of the mean flow through the box: at least, and at most.
const LEAST: usize = 2;
const MOST: usize = 24;

/// Change of the energy from one passage to the next.
const MOST_CHANGE: f64 = 0.1;

/// Divergence left over, as a part of the largest speed per voxel.
const MOST_DIVERGENCE: f64 = 1e-3;

/// Moves a flow on until it is settled.
///
/// Fails where it is not after [`MOST`] passages, and where `go_on` fails.
pub(super) fn settle(flow: &mut Flow, mut go_on: impl FnMut() -> Result<(), Error>) -> Result<(), Error> {
    let steps = flow.passage_steps();
    let voxel_size_m = flow.solver().domain().voxel_size_m();
    let (mut before, mut change, mut divergence) = (0.0, f64::INFINITY, f64::INFINITY);
    for passage in 1..=MOST {
        let mut energy = 0.0;
        divergence = 0.0;
        for _ in 0..steps {
            go_on()?;
            let step = flow.step();
            energy += flow.energy_m2_s2() / steps as f64;
            let fastest = step.fastest_m_s.max(f64::MIN_POSITIVE);
            divergence = f64::max(divergence, step.divergence_hz * voxel_size_m / fastest);
        }
        change = ((energy - before) / energy).abs();
        before = energy;
        if passage > LEAST && change <= MOST_CHANGE && divergence <= MOST_DIVERGENCE {
            return Ok(());
        }
    }
    Err(Error::Unsettled { passages: MOST, change, divergence })
}
