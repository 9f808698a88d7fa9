//! Automation from a file: steps of parameters, each at its own sample.
//!
//! ```csv
//! time_s,id,value
//! 0.5,alpha,3.0
//! 0.5,texture_level,-6 dB
//! 1.25,dynamic_range,off
//! ```
//!
//! The first line says whether times are seconds (`time_s`) or samples (`sample`). Rows are
//! sorted by time; several may share one. Lines that begin with `#` are comments.

use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use crate::{Error, PARAMETERS, index_of};

/// One step of one parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// First sample that has the new value.
    pub sample: u64,
    /// Place in [`PARAMETERS`].
    pub parameter: usize,
    /// The new plain value.
    pub value: f64,
}

/// Steps of parameters, sorted by time.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Automation {
    rows: Vec<(Time, usize, f64)>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Time {
    Seconds(f64),
    Sample(u64),
}

/// The latest time allowed in seconds: a day, so that no row can be beyond the range of samples.
const LATEST_S: f64 = 86_400.0;

impl Automation {
    /// Reads an automation file.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(|source| Error::File { path: path.to_owned(), source })?;
        Self::from_csv(&text)
    }

    /// Reads an automation's text.
    pub fn from_csv(text: &str) -> Result<Self, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(Trim::All)
            .has_headers(false)
            .flexible(true)
            .from_reader(text.as_bytes());
        let mut records = reader.records();
        let header = records.next().and_then(Result::ok).unwrap_or_default();
        let in_seconds = match header.iter().collect::<Vec<_>>().as_slice() {
            ["time_s", "id", "value"] => true,
            ["sample", "id", "value"] => false,
            found => return Err(Error::AutomationHeader { found: found.join(",") }),
        };
        let mut rows: Vec<(Time, usize, f64)> = Vec::new();
        let mut previous = String::new();
        for record in records {
            let record = record.map_err(|error| Error::AutomationRow {
                line: error.position().map_or(0, csv::Position::line),
                message: error.to_string(),
            })?;
            let line = record.position().map_or(0, csv::Position::line);
            let row = read_row(&record, in_seconds, line)?;
            if rows.last().is_some_and(|above| row.0.is_before(above.0)) {
                return Err(Error::AutomationOrder { line, found: record[0].to_owned(), previous });
            }
            previous = record[0].to_owned();
            rows.push(row);
        }
        Ok(Self { rows })
    }

    /// The steps at a sample rate, sorted; a time in seconds becomes the nearest sample.
    pub fn events(&self, sample_rate_hz: f64) -> Vec<Event> {
        self.rows
            .iter()
            .map(|(time, parameter, value)| Event {
                sample: match time {
                    Time::Seconds(seconds) => (seconds * sample_rate_hz).round() as u64,
                    Time::Sample(sample) => *sample,
                },
                parameter: *parameter,
                value: *value,
            })
            .collect()
    }

    /// Whether there is no step at all.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

impl Time {
    fn is_before(self, other: Self) -> bool {
        match (self, other) {
            (Self::Seconds(a), Self::Seconds(b)) => a < b,
            (Self::Sample(a), Self::Sample(b)) => a < b,
            _ => false,
        }
    }
}

fn read_row(record: &StringRecord, in_seconds: bool, line: u64) -> Result<(Time, usize, f64), Error> {
    let fields: Vec<&str> = record.iter().collect();
    let [time, id, value] = fields[..] else {
        let message = format!("{} fields, but a row has three: time, id, value", fields.len());
        return Err(Error::AutomationRow { line, message });
    };
    let time = if in_seconds {
        time.parse().ok().filter(|seconds| (0.0..=LATEST_S).contains(seconds)).map(Time::Seconds)
    } else {
        time.parse().ok().map(Time::Sample)
    }
    .ok_or_else(|| {
        let allowed = if in_seconds { "seconds from 0 to 86400" } else { "a whole number of samples from 0" };
        Error::AutomationRow { line, message: format!("the time is `{time}`, but must be {allowed}") }
    })?;
    let in_row = |source| Error::AutomationValue { line, source: Box::new(source) };
    let parameter = index_of(id).map_err(in_row)?;
    if !PARAMETERS[parameter].automatable {
        return Err(in_row(Error::NotAutomatable { id: PARAMETERS[parameter].id }));
    }
    let value = PARAMETERS[parameter].parse(value).map_err(in_row)?;
    Ok((time, parameter, value))
}
