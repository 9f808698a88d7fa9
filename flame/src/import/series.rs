//! A flux, or rate of heat release, that was measured elsewhere: one number per step.

mod dialect;
mod table;

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use self::table::Table;
use super::error::{Error, Fault};
use super::npy::Header;
use super::sequence::{open, snapped_rate_hz};

/// Rows of a series.
const MOST_ROWS: usize = 10_000_000;

/// How far a time may stand from its even place, in steps, for the series to have a rate.
const MOST_UNEVEN: f64 = 0.02;

/// When the values of a series take place.
#[derive(Debug, Clone, PartialEq)]
pub enum Timing {
    /// At consecutive frames from this number on.
    Frames(i64),
    /// At these times in seconds, ascending.
    Times(Vec<f64>),
}

/// A series of numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// When the values take place.
    pub timing: Timing,
    /// The values, all finite; at least one.
    pub values: Vec<f64>,
    /// Values per second where there are times and they are even (to 2 % of a step).
    pub rate_hz: Option<f64>,
}

impl Series {
    /// Reads a `.npy` array of one axis, or else a table: columns `flux` and `frame` or `time_s` under a header in any
    /// order (others are left out), or one column with or without a header.
    ///
    /// Columns are parted by commas, tabs, semicolons (numbers may then have a decimal comma) or spaces. Lines that begin
    /// with `#` are comments, but for one that names the columns. A line of units may stand before or behind the names, as
    /// in what FDS writes, or units in brackets beside them; times in milliseconds or minutes become seconds.
    ///
    /// Fails with the line where a row has no finite number in its place, where frames do not count up by one, where
    /// times do not ascend, and beyond 10 million rows.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let (file, size) = open(path)?;
        let is_array = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy"));
        if is_array {
            return array(file, size).map_err(Error::of_file(path));
        }
        Table::new(path).read(BufReader::new(file))
    }
}

fn array(file: File, size: u64) -> Result<Series, Fault> {
    let mut reader = BufReader::new(file);
    let header = Header::read(&mut reader)?;
    header.check_size(size)?;
    let [length] = *header.shape.as_slice() else {
        let advice = "save a series as an array of one axis";
        return Err(Fault::Unsupported { found: format!("an array of shape {:?}", header.shape), advice });
    };
    if length > MOST_ROWS {
        return Err(Fault::TooLarge { what: "values", found: length as u64, allowed: MOST_ROWS as u64 });
    }
    let mut values = Vec::with_capacity(length);
    header.values(&mut reader, |value| values.push(value))?;
    if let Some(index) = values.iter().position(|value| !value.is_finite()) {
        return Err(Fault::Damaged(format!("value {index} (counting from 0) is not a finite number")));
    }
    if values.is_empty() {
        return Err(Fault::Damaged("it holds no values".into()));
    }
    Ok(Series { timing: Timing::Frames(0), values, rate_hz: None })
}

/// Values per second where all times are near their even places.
fn rate_hz(times: &[f64]) -> Option<f64> {
    let ([first, ..], [.., last]) = (times, times) else { return None };
    let steps = times.len() as f64 - 1.0;
    let step = (last - first) / steps;
    let is_even =
        times.iter().enumerate().all(|(i, time)| (time - first - i as f64 * step).abs() <= MOST_UNEVEN * step);
    (steps > 0.0 && step.is_finite() && step > 0.0 && is_even).then(|| snapped_rate_hz(1.0 / step))
}
