//! A flux with its time: what is measured, before it becomes sound.

use pyrophone_flame::flux::{Changes, Flux};
use pyrophone_flame::import::Numbering;
use pyrophone_flame::upsample::Upsampler;

use crate::args::TimelineArgs;

/// Steps per second for checking options while the true rate is not known yet: the paper's.
pub const LIKELY_RATE_HZ: f64 = 360.0;

/// A flux with its time.
#[derive(Clone)]
pub struct Signal {
    /// One value per step.
    pub flux: Vec<f64>,
    /// The front's area at every step; empty where it is not known.
    pub area: Vec<f64>,
    /// Number of the first step.
    pub first_frame: i64,
    /// Steps per second; a likely value if it is unknown.
    pub rate_hz: f64,
    /// Whether that rate is known.
    pub is_timed: bool,
    /// Timeline options, if any were given.
    pub timeline: Option<TimelineArgs>,
    /// The frame of the film at which it starts, where a curve says so.
    pub film_frame: Option<f64>,
    /// Relation of frame numbers to measured steps.
    pub numbering: Numbering,
    /// Steps per measured step.
    pub substeps: usize,
}

impl Signal {
    /// The signal of measured frames.
    pub fn of_flux(flux: &Flux, rate_hz: Option<f64>) -> Self {
        Self {
            flux: flux.values(),
            area: flux.rows.iter().map(|row| row.area).collect(),
            first_frame: flux.rows.first().map_or(0, |row| row.frame),
            rate_hz: rate_hz.unwrap_or(LIKELY_RATE_HZ),
            is_timed: rate_hz.is_some(),
            timeline: None,
            film_frame: None,
            numbering: Numbering::default(),
            substeps: 1,
        }
    }

    /// The signal of a series.
    pub fn of_series(flux: Vec<f64>, first_frame: i64, rate_hz: f64) -> Self {
        let none = Flux::default();
        Self { flux, first_frame, ..Self::of_flux(&none, Some(rate_hz)) }
    }

    /// The same, its steps counted by frames' numbers.
    pub fn counted(self, numbering: Numbering) -> Self {
        Self { numbering, ..self }
    }

    /// The same on a timeline.
    pub fn on_timeline(self, timeline: &TimelineArgs) -> Self {
        Self { timeline: Some(timeline.clone()), ..self }
    }

    /// The first frame's number.
    pub fn first_number(&self) -> f64 {
        self.numbering.number(self.first_frame)
    }

    /// The same with more steps.
    pub fn upsampled(self, upsampler: &Upsampler, changes: &Changes) -> Self {
        let substeps = upsampler.substeps();
        let area = |area: &f64| std::iter::repeat_n(*area, substeps);
        Self {
            flux: upsampler.series(&self.flux, self.first_frame, changes),
            area: self.area.iter().flat_map(area).collect(),
            rate_hz: self.rate_hz * substeps as f64,
            substeps,
            ..self
        }
    }

    /// Steps per second that were measured.
    pub fn measured_hz(&self) -> f64 {
        self.rate_hz / self.substeps as f64
    }
}
