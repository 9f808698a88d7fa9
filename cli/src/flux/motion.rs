//! Speed field of a simulation, for vortex sound: the speed of the gas in each region.

use std::collections::BTreeMap;
use std::path::Path;

use pyrophone_flame::speed_field::{Regions, Up, stride};
use pyrophone_flame::velocity::join;
use pyrophone_recording::write_file;
use pyrophone_synthesis::vortex::{End, SpeedField};
use rayon::prelude::*;

use super::measuring::{Plan, Span, Whole};
use crate::args::UpAxis;
use crate::error::Error;
use crate::progress::Work;

/// Number of frames, evenly spaced, that are examined for the box.
const LOOKS: usize = 24;

/// Times and region of the measurement: the same for the whole simulation and for every part of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Steps of the whole simulation.
    pub span: Span,
    /// Stride between measured steps.
    pub every: u64,
    /// The box that contains all motion: its lowest and highest corners; none if nothing moves.
    pub extent: Option<[[f64; 3]; 2]>,
    /// Voxel edge in that box.
    pub voxel: f64,
}

/// Mean speeds of all regions, by step; unreadable steps are missing.
pub type Speeds = BTreeMap<i64, Vec<f32>>;

impl Survey {
    /// Examines frames of the whole simulation, whose steps come at `rate_hz`.
    pub fn new(plan: &Plan, whole: &Whole, rate_hz: f64, work: &Work) -> Result<Self, Error> {
        let survey = Self { span: whole.span, every: stride(rate_hz), extent: None, voxel: 0.0 };
        let there: Vec<usize> = survey.steps().filter_map(|step| plan.index_of(step, &whole.indices)).collect();
        let looks: Vec<usize> = there.iter().copied().step_by(there.len().div_ceil(LOOKS).max(1)).collect();
        let seen = |index: &usize| -> Result<_, Error> {
            work.check()?;
            let velocity = plan.read(*index).ok().map(|frame| frame.velocity);
            Ok(velocity.and_then(|velocity| Some((velocity.transform().voxel_edges()[0], velocity.bounds()?))))
        };
        let boxes: Vec<_> = looks.par_iter().map(seen).collect::<Result<_, Error>>()?;
        // A frame in which nothing moves yet may have no grid, and so no voxel size.
        let voxel = boxes.iter().flatten().map(|(voxel, _)| *voxel).next().unwrap_or_default();
        let extent = boxes.iter().flatten().map(|(_, bounds)| *bounds).reduce(join);
        Ok(Self { extent, voxel, ..survey })
    }

    /// The measured steps, with or without a file.
    fn steps(&self) -> impl Iterator<Item = i64> + use<> {
        (self.span.first..=self.span.last).step_by(usize::try_from(self.every).unwrap_or(usize::MAX))
    }

    /// The box divided into sub-volumes; none if nothing moves.
    fn regions(&self) -> Option<Regions> {
        let [low, high] = self.extent?;
        // Samples stand in the middle of their voxels.
        let half = 0.5 * self.voxel;
        Some(Regions::new(low.map(|x| x - half), high.map(|x| x + half), self.voxel))
    }

    /// Measures those of the survey's steps that the plan has.
    pub fn measure(&self, plan: &Plan, work: &Work) -> Result<Speeds, Error> {
        let stage = work.stage("measuring the flow");
        let Some(regions) = self.regions() else { return Ok(Speeds::new()) };
        let at = |step: i64| plan.index_of(step, &plan.indices).map(|index| (step, index));
        let chosen: Vec<(i64, usize)> = self.steps().filter_map(at).collect();
        let mut speeds = Speeds::new();
        for (n, portion) in chosen.chunks(4 * rayon::current_num_threads()).enumerate() {
            let measured = |(step, index): &(i64, usize)| {
                work.check()?;
                Ok(plan.read(*index).ok().map(|frame| (*step, regions.mean_speeds(&frame.velocity))))
            };
            let found: Result<Vec<_>, Error> = portion.par_iter().map(measured).collect();
            speeds.extend(found?.into_iter().flatten());
            stage.report((n * portion.len()) as f32 / chosen.len() as f32);
        }
        Ok(speeds)
    }

    /// The field of the measured speeds, whose first step is at `start_s` on the timeline. A missing step repeats the
    /// one before.
    pub fn field(&self, speeds: &Speeds, up: UpAxis, rate_hz: f64, start_s: f64) -> Result<SpeedField, Error> {
        let regions = self.regions().ok_or(pyrophone_flame::Error::NoMotion)?;
        let mut steps: Vec<Vec<f32>> = vec![];
        for step in self.steps() {
            let last = || steps.last().cloned().unwrap_or_else(|| vec![0.0; regions.len()]);
            let speeds = speeds.get(&step).filter(|speeds| speeds.len() == regions.len()).cloned();
            steps.push(speeds.unwrap_or_else(last));
        }
        let up = match up {
            UpAxis::Y => Up::Y,
            UpAxis::Z => Up::Z,
        };
        Ok(regions.field(&steps, rate_hz / self.every as f64, up, End::Clamped)?.starting_at(start_s))
    }
}

/// Writes a speed field to a file.
pub fn write(path: &Path, field: &SpeedField) -> Result<(), Error> {
    Ok(write_file(path, |file| std::io::Write::write_all(file, &field.to_bytes()))?)
}
