//! Automation from a file: steps and ramps of parameters, sample-accurate.
//!
//! ```csv
//! time_s,id,value,curve
//! 0.5,alpha,3.0,step
//! 0.5,texture_level,-6 dB,linear
//! 1.25,dynamic_range,off,
//! 2.0,texture_level,0 dB,
//! ```
//!
//! The first line states whether times are seconds (`time_s`) or samples (`sample`), and whether there is a column
//! `curve`. Rows are sorted by time; several may share one. Lines that begin with `#` are comments. If the first line
//! uses semicolons, so do all, and numbers may have a decimal comma.
//!
//! A `step` (also a row without a curve) holds until the parameter's next row. From a `linear` row the value moves
//! evenly, in the parameter's own unit, to that of the next row; without a next row it holds. A ramp is a staircase:
//! its steps are as fine as the parameter's last decimal allows, but at least [`RAMP_STEP_S`] long. They depend only on
//! the file and the sample rate, so every host and block size gets the same.

mod ramp;
mod read;

use std::path::Path;

pub use ramp::RAMP_STEP_S;

use crate::Error;

/// One step of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// First sample that has the new value.
    pub sample: u64,
    /// Index into [`PARAMETERS`](crate::PARAMETERS).
    pub parameter: usize,
    /// The new plain value.
    pub value: f64,
}

/// Steps and ramps of parameters, sorted by time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Automation {
    rows: Vec<Row>,
}

/// A line of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    time: Time,
    parameter: usize,
    value: f64,
    curve: Curve,
}

/// Course of a parameter until its next row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Curve {
    Step,
    Linear,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Time {
    Seconds(f64),
    Sample(u64),
}

impl Automation {
    /// Reads an automation file.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Self::from_csv(&text)
    }

    /// Reads an automation's text.
    pub fn from_csv(text: &str) -> Result<Self, Error> {
        Ok(Self { rows: read::rows(text)? })
    }

    /// All steps at a sample rate, including those of ramps, sorted; a time in seconds becomes the nearest sample.
    pub fn events(&self, sample_rate_hz: f64) -> Vec<Event> {
        let rows: Vec<(Event, Curve)> = self.rows.iter().map(|row| (row.event(sample_rate_hz), row.curve)).collect();
        let mut events = Vec::with_capacity(rows.len());
        // From the last row to the first, so that each row knows the next of its parameter.
        let mut next_of_parameter = [None; crate::COUNT];
        for (event, curve) in rows.iter().rev() {
            let next = next_of_parameter[event.parameter].replace(*event);
            if let (Curve::Linear, Some(next)) = (curve, next) {
                events.extend(ramp::between(*event, next, sample_rate_hz).rev());
            }
            events.push(*event);
        }
        events.reverse();
        // Stable, so that rows of one sample stay in the file's order.
        events.sort_by_key(|event| event.sample);
        events
    }

    /// True if there are no steps.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Row {
    fn event(&self, sample_rate_hz: f64) -> Event {
        let sample = match self.time {
            Time::Seconds(seconds) => (seconds * sample_rate_hz).round() as u64,
            Time::Sample(sample) => sample,
        };
        Event { sample, parameter: self.parameter, value: self.value }
    }
}
