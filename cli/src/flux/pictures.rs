//! Pictures of the front at even intervals, in one view.

use pyrophone_flame::import::Numbering;
use rayon::prelude::*;

use super::extras::Fronts;
use super::measuring::{Plan, Whole};
use crate::error::Error;
use crate::progress::Work;
use crate::report::{Picture, View};

/// Number of pictures of the front in a report.
const PICTURES: usize = 12;

/// Fronts to picture that fall within the plan's own frames.
pub fn fronts(plan: &Plan, whole: &Whole, work: &Work) -> Result<Fronts, Error> {
    let _stage = work.stage("drawing");
    let last = whole.indices.len().saturating_sub(1);
    let count = PICTURES.min(whole.indices.len());
    let chosen = (0..count).filter_map(|n| whole.indices.get(n * last / count.saturating_sub(1).max(1)).copied());
    let own: Vec<usize> = chosen.filter(|index| plan.indices.binary_search(index).is_ok()).collect();
    let found: Result<Vec<_>, Error> = own
        .par_iter()
        .map(|index| {
            work.check()?;
            // Read as it was measured: frames that were skipped have no picture either.
            let frame = plan.read_front(*index).ok();
            Ok(frame.and_then(|frame| Some((frame.number, plan.front.mesh(&frame.field).ok()?))))
        })
        .collect();
    Ok(found?.into_iter().flatten().collect())
}

/// Pictures with their labels; `first` is the first step with a file.
pub fn draw(
    fronts: &Fronts,
    numbering: &Numbering,
    rate_hz: Option<f64>,
    first: i64,
    work: &Work,
) -> Vec<(String, Picture)> {
    let stage = work.stage("drawing");
    stage.report(0.5);
    let view = View::of_meshes(fronts.iter().map(|(_, mesh)| mesh));
    let time_s = |number: i64| rate_hz.map(|rate_hz| number.saturating_sub(first) as f64 / rate_hz);
    let label =
        |number: i64| format!("frame {} · {:.3} s", numbering.label(number), time_s(number).unwrap_or_default());
    fronts.par_iter().map(|(number, mesh)| (label(*number), view.draw(mesh))).collect()
}
