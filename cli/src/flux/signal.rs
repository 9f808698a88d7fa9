//! A flux series with its timing: the measurement before it becomes sound.

use pyrophone_flame::flux::{Changes, Flux};
use pyrophone_flame::import::Numbering;
use pyrophone_flame::upsample::Upsampler;

use crate::args::TimelineArgs;

/// Assumed steps per second for checking options before the true rate is known: the paper's rate.
pub const LIKELY_RATE_HZ: f64 = 360.0;

/// A flux series with its timing.
#[derive(Clone)]
pub struct Signal {
    /// One value per step.
    pub flux: Vec<f64>,
    /// Area of the front at every step; empty if unknown.
    pub area: Vec<f64>,
    /// Number of the first step.
    pub first_frame: i64,
    /// Steps per second; an assumed rate if it is unknown.
    pub rate_hz: f64,
    /// True if that rate is known.
    pub is_timed: bool,
    /// Timeline options, if any were given.
    pub timeline: Option<TimelineArgs>,
    /// Film frame at the start of the signal, if a retiming curve sets it.
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

    /// The same signal, with its steps counted by the frames' numbers.
    pub fn counted(self, numbering: Numbering) -> Self {
        Self { numbering, ..self }
    }

    /// The same signal on a timeline.
    pub fn on_timeline(self, timeline: &TimelineArgs) -> Self {
        Self { timeline: Some(timeline.clone()), ..self }
    }

    /// Number of the first frame.
    pub fn first_number(&self) -> f64 {
        self.numbering.number(self.first_frame)
    }

    /// The same signal with more steps.
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

    /// Measured steps per second.
    pub fn measured_hz(&self) -> f64 {
        self.rate_hz / self.substeps as f64
    }
}
