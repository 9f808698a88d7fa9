//! Speed field of a simulation, for vortex sound: how fast the gas flows, and where.

use std::path::Path;

use pyrophone_flame::speed_field::{Regions, Up, stride};
use pyrophone_flame::velocity::join;
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::{End, SpeedField};
use rayon::prelude::*;

use super::measuring::Plan;
use crate::args::UpAxis;
use crate::error::Error;
use crate::progress::Work;

/// Frames whose boxes are looked at, at even distances.
const LOOKS: usize = 24;

/// Writes the speed field of frames that come `rate_hz` times per second, the first at `start_s` of the timeline.
pub fn write_of_frames(
    path: &Path,
    plan: &Plan,
    up: UpAxis,
    rate_hz: f64,
    start_s: f64,
    work: &Work,
) -> Result<(), Error> {
    let stage = work.stage("measuring the flow");
    let every = stride(rate_hz);
    let numbers: Vec<i64> = plan.sequence.numbers().collect();
    let (first, last) = (plan.first_frame().unwrap_or(0), plan.last_frame().unwrap_or(0));
    // By number: where a frame is missing, or cannot be read and is skipped, the flow goes on as it was.
    let index_of = |number: i64| numbers.binary_search(&number).ok().filter(|index| plan.indices.contains(index));
    let chosen: Vec<Option<usize>> = (first..=last).step_by(every as usize).map(index_of).collect();
    let read = |index: &Option<usize>| work.check().map(|()| index.and_then(|index| plan.read(index).ok()));
    let seen = |index: &Option<usize>| -> Result<_, Error> {
        let velocity = read(index)?.map(|frame| frame.velocity);
        Ok(velocity.map(|velocity| (velocity.transform().voxel_edges()[0], velocity.bounds())))
    };
    let there: Vec<Option<usize>> = chosen.iter().copied().filter(Option::is_some).collect();
    let looks: Vec<Option<usize>> = there.iter().copied().step_by(there.len().div_ceil(LOOKS).max(1)).collect();
    let boxes: Vec<_> = looks.par_iter().map(seen).collect::<Result<_, Error>>()?;
    let voxel = boxes.iter().flatten().map(|(voxel, _)| *voxel).next();
    let around = boxes.iter().flatten().filter_map(|(_, bounds)| *bounds).reduce(join);
    let (Some(voxel), Some([low, high])) = (voxel, around) else { return Err(pyrophone_flame::Error::NoMotion.into()) };
    // Samples stand in the middle of their voxels.
    let (low, high) = (low.map(|x| x - 0.5 * voxel), high.map(|x| x + 0.5 * voxel));
    let regions = Regions::new(low, high, voxel);
    let mut steps: Vec<Vec<f32>> = Vec::with_capacity(chosen.len());
    for portion in chosen.chunks(4 * rayon::current_num_threads()) {
        let speeds: Result<Vec<_>, Error> = portion
            .par_iter()
            .map(|index| Ok(read(index)?.map(|frame| regions.mean_speeds(&frame.velocity))))
            .collect();
        for speeds in speeds? {
            let last = || steps.last().cloned().unwrap_or_else(|| vec![0.0; regions.len()]);
            let speeds = speeds.unwrap_or_else(last);
            steps.push(speeds);
        }
        stage.at(steps.len() as f32 / chosen.len() as f32);
    }
    let up = match up {
        UpAxis::Y => Up::Y,
        UpAxis::Z => Up::Z,
    };
    let field = regions.field(&steps, rate_hz / every as f64, up, End::Clamped)?;
    write(path, field.starting_at(start_s))
}

/// Writes a field's file.
pub fn write(path: &Path, field: SpeedField) -> Result<(), Error> {
    Ok(write_file(path, |file| std::io::Write::write_all(file, &field.to_bytes()))?)
}
