//! The unit of a simulation's velocity, and a check of it and the rate against the smoke.

use pyrophone_flame::advection::Fitting;
use pyrophone_flame::import::{Selection, Sequence};

use super::sight::Sight;
use crate::args::{FluxArgs, Measure};
use crate::error::Error;
use crate::input::in_range;
use crate::progress::{Work, note};

/// Mantaflow's time units in a second at a time scale of 1: a frame is 0.1 · 25/fps of them (Blender's
/// `MANTA::initDomain`, dt_default).
const BLENDER_UNITS_PER_S: f64 = 2.5;

/// Relative tolerance between voxel sizes that should be equal: they are written with few digits.
const SAME_SIZE: f64 = 1e-4;

/// Number of frame pairs, evenly spaced, that are examined.
const PAIRS: usize = 3;

/// The selection with its velocity in world units per second: as given, otherwise as known for the program that wrote
/// it.
pub fn scaled(
    selection: Selection,
    sequence: &Sequence,
    sight: Option<&Sight>,
    args: &FluxArgs,
) -> Result<Selection, Error> {
    if let Some(scale) = args.velocity.scale {
        in_range("--velocity-scale", scale, 1e-9, 1e9)?;
        return Ok(Selection { velocity_scale: scale, ..selection });
    }
    let Some(sight) = sight.filter(|sight| sight.is_blender && args.measure == Measure::Flux) else {
        return Ok(selection);
    };
    let edges = blender_voxels(sequence);
    // All parts of a simulation must find the same factor, to the last digit.
    let edge = edges.first().copied().unwrap_or(sight.voxel_edges[0]);
    if edges.iter().any(|other| (other / edge - 1.0).abs() > SAME_SIZE) {
        note(
            "the voxel size changes from frame to frame, because Blender's adaptive domain stores it wrongly; put the cache's config folder back beside data, or velocities and fluxes are wrong",
        );
    }
    let scale = BLENDER_UNITS_PER_S * edge;
    note(&format!(
        "the velocity is Blender's, in cells per unit of Blender's time; it is multiplied by 2.5 voxels ({scale:.6}), which gives world units per second at a time scale of 1; for another time scale, use --velocity-scale"
    ));
    Ok(Selection { velocity_scale: scale, ..selection })
}

/// Voxel sizes of Blender's grids in the first, middle and last frames of the sequence.
fn blender_voxels(sequence: &Sequence) -> Vec<f64> {
    let last = sequence.len().saturating_sub(1);
    let edge = |index: usize| {
        let grids = sequence.describe(index).ok()?.grids;
        grids.into_iter().find(|grid| grid.is_blender).and_then(|grid| Some(grid.voxel_edges?[0]))
    };
    [0, last / 2, last].into_iter().filter_map(edge).collect()
}

/// Checks that the smoke moves with the gas; if it does not, the rate or the velocity's unit must be wrong.
pub fn check(
    sequence: &Sequence,
    selection: &Selection,
    indices: &[usize],
    rate_hz: Option<f64>,
    work: &Work,
) -> Result<Option<String>, Error> {
    let Some(rate_hz) = rate_hz else { return Ok(None) };
    let numbers: Vec<i64> = sequence.numbers().collect();
    let follow = |pair: &&[usize]| numbers[pair[0]].checked_add(1) == Some(numbers[pair[1]]);
    let neighbours: Vec<&[usize]> = indices.windows(2).filter(follow).collect();
    let mut fitting = Fitting::new(1.0 / rate_hz);
    for n in 1..=PAIRS {
        work.check()?;
        let Some(pair) = neighbours.get(n * neighbours.len() / (PAIRS + 1)) else { continue };
        // Read errors are reported when the frame is measured.
        let before = sequence.read_carried(pair[0], selection).ok().flatten();
        let after = before.as_ref().and_then(|_| sequence.read_carried_field(pair[1]).ok().flatten());
        if let (Some((before, flow)), Some(after)) = (before, after) {
            fitting.add(&before, &after, &flow);
        }
    }
    let Some(fit) = fitting.best() else { return Ok(None) };
    let found_speed = format!("the smoke moves at {:.3} times the velocity, at {rate_hz} steps per second", fit.factor);
    if fit.is_wrong() {
        note(&format!(
            "{found_speed}: the rate or the velocity's unit must be wrong; if the unit is right, the rate is about {:.0} (--rate); if the rate is right, use --velocity-scale {:.4}",
            rate_hz / fit.factor,
            selection.velocity_scale * fit.factor
        ));
    }
    Ok(Some(format!(
        "{found_speed} (1 means that rate and unit agree; {:.0} % of its change is unexplained)",
        100.0 * fit.left
    )))
}
