//! Facts about a simulation for its report, the same from one run as from merged parts.

use pyrophone_flame::flux::Flux;
use pyrophone_flame::import::Numbering;

use super::measuring::Plan;
use crate::args::UpAxis;

/// Facts that can only be read from the cache.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct CacheFacts {
    /// The cache as the user named it.
    pub simulation: String,
    /// Size of the voxels and of the flame in the first frame; none before ignition.
    pub size: Option<String>,
    /// Agreement of the rate and the velocity unit with the smoke, if it could be checked.
    pub check: Option<String>,
}

impl CacheFacts {
    /// Facts of a plan, with the result of its check.
    pub fn of_plan(plan: &Plan, input: &std::path::Path, check: Option<String>) -> Self {
        let size = plan.sight.as_ref().map(|sight| {
            let (voxel, extent) = (sight.voxel_text(), sight.extent_text());
            format!("voxel {voxel}; the flame spans {extent} in the first frame (world units)")
        });
        Self { simulation: input.display().to_string(), size, check }
    }

    /// Labels and values in the order in which the page shows them.
    pub fn labelled(
        self,
        settings: &str,
        flux: &Flux,
        up: UpAxis,
        rate_hz: Option<f64>,
        numbering: &Numbering,
    ) -> Vec<(String, String)> {
        let up = match up {
            UpAxis::Y => "second",
            UpAxis::Z => "third",
        };
        let axes = format!("first, second, third as in the files; the {up} points up for the speed field (--up)");
        let told_hz = rate_hz.map_or("unknown".into(), |rate_hz| format!("{rate_hz} measured steps per second"));
        let interpolated = format!("{} of {} frames", flux.interpolated.len(), flux.rows.len());
        let facts = [
            ("Simulation", Some(self.simulation)),
            ("Measured with", Some(settings.to_owned())),
            ("Interpolated", Some(interpolated)),
            ("Size", self.size),
            ("Axes", Some(axes)),
            ("Rate", Some(format!("{told_hz}, {numbering}"))),
            ("Rate and unit", self.check),
        ];
        facts.into_iter().filter_map(|(label, value)| Some((label.to_owned(), value?))).collect()
    }
}
