//! A flux, or rate of heat release, that was measured elsewhere: one number per step.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::error::{Error, Fault, shown, shown_path};
use super::npy::Header;
use super::sequence::open;

/// Rows of a series.
const MOST_ROWS: usize = 10_000_000;

/// Bytes of a line.
const LONGEST_LINE: u64 = 4096;

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
    /// Values per second where the times are even (to 2 % of a step); frames have no rate of their own.
    pub rate_hz: Option<f64>,
}

/// Columns that hold seconds.
const TIME_NAMES: [&str; 4] = ["time_s", "time", "t", "seconds"];

/// Columns that hold the flux, or what is as good.
const FLUX_NAMES: [&str; 4] = ["flux", "heat_release", "heat_release_rate", "hrr"];

impl Series {
    /// Reads a `.npy` array of one axis, or else a table: columns `flux` and `frame` or `time_s` under a header in any
    /// order (others are left out), or one column with or without a header.
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
    (steps > 0.0 && step.is_finite() && step > 0.0 && is_even).then(|| 1.0 / step)
}

/// What the first column in use tells.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Clock {
    Frame,
    Time,
}

/// Which columns are used, by their places.
#[derive(Clone, Copy)]
struct Columns {
    flux: usize,
    clock: Option<(Clock, usize)>,
}

struct Table<'a> {
    path: &'a Path,
    most_rows: usize,
    line: u64,
    columns: Option<Columns>,
    /// The first frame and the last so far.
    frames: Option<(i64, i64)>,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> Table<'a> {
    fn new(path: &'a Path) -> Self {
        Self { path, most_rows: MOST_ROWS, line: 0, columns: None, frames: None, times: vec![], values: vec![] }
    }

    fn fault(&self, reason: impl Into<String>) -> Error {
        Error::Row { path: shown_path(self.path), line: self.line, reason: reason.into() }
    }

    fn read(mut self, mut reader: impl BufRead) -> Result<Series, Error> {
        let mut bytes = vec![];
        loop {
            bytes.clear();
            let count = reader.by_ref().take(LONGEST_LINE + 1).read_until(b'\n', &mut bytes);
            if count.map_err(Error::of_system(self.path))? == 0 {
                break;
            }
            self.line += 1;
            if bytes.len() as u64 > LONGEST_LINE {
                return Err(self.fault(format!("a line of more than {LONGEST_LINE} characters; this is not a table")));
            }
            let text = String::from_utf8_lossy(&bytes);
            let text = if self.line == 1 { text.strip_prefix('\u{feff}').unwrap_or(&text) } else { &text };
            if !text.trim().is_empty() {
                self.row(text.trim())?;
            }
        }
        self.finish()
    }

    fn row(&mut self, text: &str) -> Result<(), Error> {
        let cells: Vec<&str> = text.split(',').map(|cell| cell.trim().trim_matches('"')).collect();
        match self.columns {
            Some(columns) => self.values_of(columns, &cells),
            None if cells.first().is_some_and(|cell| cell.parse::<f64>().is_ok()) => {
                if cells.len() != 1 {
                    let reason = "columns without names; begin with a line such as frame,flux or time_s,flux";
                    return Err(self.fault(reason));
                }
                let columns = *self.columns.insert(Columns { flux: 0, clock: None });
                self.values_of(columns, &cells)
            }
            None => {
                self.columns = Some(self.header(&cells)?);
                Ok(())
            }
        }
    }

    fn header(&self, cells: &[&str]) -> Result<Columns, Error> {
        let find =
            |names: &[&str]| cells.iter().position(|cell| names.iter().any(|name| cell.eq_ignore_ascii_case(name)));
        let frame = find(&["frame"]).map(|column| (Clock::Frame, column));
        let time = find(&TIME_NAMES).map(|column| (Clock::Time, column));
        match (find(&FLUX_NAMES), cells) {
            (Some(flux), _) => Ok(Columns { flux, clock: frame.or(time) }),
            // A single column may be called anything.
            (None, [_]) => Ok(Columns { flux: 0, clock: None }),
            (None, _) => {
                Err(self.fault("no column is named flux; begin with a line such as frame,flux or time_s,flux"))
            }
        }
    }

    fn values_of(&mut self, columns: Columns, cells: &[&str]) -> Result<(), Error> {
        let most_rows = self.most_rows;
        if self.values.len() >= most_rows {
            return Err(self.fault(format!("more than {most_rows} rows; use a shorter series")));
        }
        let value = self.number(cells, columns.flux)?;
        match columns.clock {
            Some((Clock::Frame, column)) => self.frame(cells, column)?,
            Some((Clock::Time, column)) => self.time(cells, column)?,
            None => {}
        }
        self.values.push(value);
        Ok(())
    }

    fn cell<'c>(&self, cells: &[&'c str], column: usize) -> Result<&'c str, Error> {
        let missing = || self.fault(format!("{} columns, {} are needed", cells.len(), column + 1));
        cells.get(column).copied().ok_or_else(missing)
    }

    fn number(&self, cells: &[&str], column: usize) -> Result<f64, Error> {
        let cell = self.cell(cells, column)?;
        let number = cell.parse().ok().filter(|number: &f64| number.is_finite());
        number.ok_or_else(|| self.fault(format!("\"{}\" is not a finite number", shown(cell))))
    }

    fn frame(&mut self, cells: &[&str], column: usize) -> Result<(), Error> {
        let cell = self.cell(cells, column)?;
        let frame = cell.parse::<i64>();
        let frame = frame.map_err(|_| self.fault(format!("\"{}\" is not a frame's number", shown(cell))))?;
        if let Some((_, last)) = self.frames
            && last.checked_add(1) != Some(frame)
        {
            return Err(self.fault(format!("frame {frame} follows {last}; frames must count up by one")));
        }
        self.frames = Some((self.frames.map_or(frame, |(first, _)| first), frame));
        Ok(())
    }

    fn time(&mut self, cells: &[&str], column: usize) -> Result<(), Error> {
        let time = self.number(cells, column)?;
        if let Some(last) = self.times.last().filter(|last| **last >= time) {
            return Err(self.fault(format!("{time} s follows {last} s; times must ascend")));
        }
        self.times.push(time);
        Ok(())
    }

    fn finish(self) -> Result<Series, Error> {
        if self.values.is_empty() {
            return Err(self.fault("no rows of numbers; at least one is needed"));
        }
        let rate_hz = rate_hz(&self.times);
        let first_frame = self.frames.map_or(0, |(first, _)| first);
        let timing = if self.times.is_empty() { Timing::Frames(first_frame) } else { Timing::Times(self.times) };
        Ok(Series { timing, values: self.values, rate_hz })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Series, Error> {
        Table::new(Path::new("flux.csv")).read(text.as_bytes())
    }

    fn frames(first: i64, values: &[f64]) -> Series {
        Series { timing: Timing::Frames(first), values: values.into(), rate_hz: None }
    }

    #[test]
    fn frames_under_a_header() {
        assert_eq!(read("frame,flux,area\n1,0.5,9\n2,-1e-3,9\n").unwrap(), frames(1, &[0.5, -1e-3]));
        assert_eq!(read("\u{feff}\"Flux\", Frame\r\n\r\n 7 ,-3\r\n8,-2").unwrap(), frames(-3, &[7.0, 8.0]));
        assert_eq!(read("frame,flux,area\n1,2").unwrap(), frames(1, &[2.0]));
    }

    #[test]
    fn one_column() {
        assert_eq!(read("1\n2\n3").unwrap(), frames(0, &[1.0, 2.0, 3.0]));
        assert_eq!(read("heat release rate\n1\n2").unwrap(), frames(0, &[1.0, 2.0]));
    }

    #[test]
    fn times_and_their_rate() {
        let even = read("time_s,flux\n0.000,1\n0.042,2\n0.083,3\n0.125,4\n").unwrap();
        assert_eq!(even.timing, Timing::Times(vec![0.0, 0.042, 0.083, 0.125]));
        assert!((even.rate_hz.unwrap() - 24.0).abs() < 1e-9, "{:?}", even.rate_hz);
        assert_eq!(read("time_s,flux\n0,1\n1,2\n3,3\n").unwrap().rate_hz, None);
        assert_eq!(read("time_s,flux\n0,1\n").unwrap().rate_hz, None);
        assert_eq!(read("time_s,flux\n-1e308,1\n1e308,2\n").unwrap().rate_hz, None);
    }

    #[test]
    fn faults_tell_their_line() {
        for (text, line, part) in [
            ("", 0, "no rows"),
            ("frame,flux\n", 1, "no rows"),
            ("frame,flux\n1,2\n3,4\n", 3, "frame 3 follows 1"),
            ("frame,flux\n1,2\n1.5,4\n", 3, "\"1.5\""),
            ("frame,flux\n1,2\n2\n", 3, "1 columns, 2"),
            ("frame,flux\n1,nan\n", 2, "\"nan\""),
            ("1\n\n\ninf\n", 4, "\"inf\""),
            ("frame,area\n1,2\n", 1, "named flux"),
            ("1,2\n", 1, "without names"),
            ("time_s,flux\n1,2\n1,3\n", 3, "must ascend"),
            ("frame,flux\n9223372036854775807,2\n9223372036854775807,3\n", 3, "count up"),
        ] {
            match read(text) {
                Err(Error::Row { line: found, reason, .. }) => {
                    assert!(found == line && reason.contains(part), "{text:?}: line {found}: {reason}");
                }
                other => panic!("{text:?}: {other:?}"),
            }
        }
        let long = format!("flux\n1\n{}\n", "1".repeat(5000));
        assert!(matches!(read(&long), Err(Error::Row { line: 3, .. })));
        let binary = [0u8; 100_000];
        assert!(matches!(Table::new(Path::new("x")).read(&binary[..]), Err(Error::Row { line: 1, .. })));
    }

    #[test]
    fn more_rows_than_allowed() {
        let read = |text: &str| Table { most_rows: 3, ..Table::new(Path::new("x")) }.read(text.as_bytes());
        assert_eq!(read("1\n2\n3\n").unwrap().values.len(), 3);
        assert!(matches!(read("1\n2\n3\n4\n"), Err(Error::Row { line: 4, .. })));
    }
}
