//! A table of numbers under a header, line by line.

use std::io::{BufRead, Read};
use std::path::Path;

use super::dialect::{Delimiter, is_numeric, name_and_unit, seconds};
use super::values::{MOST_ROWS, Series, Timing, rate_hz};
use crate::import::error::{Error, shown, shown_path};

/// Largest number of bytes in a line.
const LONGEST_LINE: u64 = 4096;

/// Number of text lines before the first row of numbers that are kept: names and units are in the last ones.
const MOST_HEAD_LINES: usize = 16;

/// Names of time columns.
const TIME_NAMES: [&str; 5] = ["time_s", "time", "t", "seconds", "time_ms"];

/// Names of columns with the flux or an equivalent.
const FLUX_NAMES: [&str; 4] = ["flux", "heat_release", "heat_release_rate", "hrr"];

/// Indices of the columns in use.
#[derive(Clone, Copy)]
struct Columns {
    flux: usize,
    frame: Option<usize>,
    time: Option<usize>,
    /// Seconds of one unit of time.
    unit_s: f64,
}

/// A line of text before the first row of numbers.
struct HeadLine {
    line: u64,
    text: String,
}

pub(super) struct Table<'a> {
    path: &'a Path,
    most_rows: usize,
    line: u64,
    head: Vec<HeadLine>,
    delimiter: Delimiter,
    columns: Option<Columns>,
    /// The first and the last frame so far.
    frames: Option<(i64, i64)>,
    times: Vec<f64>,
    values: Vec<f64>,
}

impl<'a> Table<'a> {
    pub fn new(path: &'a Path) -> Self {
        Self {
            path,
            most_rows: MOST_ROWS,
            line: 0,
            head: vec![],
            delimiter: Delimiter::Comma,
            columns: None,
            frames: None,
            times: vec![],
            values: vec![],
        }
    }

    fn fault(&self, reason: impl Into<String>) -> Error {
        self.fault_at(self.line, reason)
    }

    fn fault_at(&self, line: u64, reason: impl Into<String>) -> Error {
        Error::Row { path: shown_path(self.path), line, reason: reason.into() }
    }

    pub fn read(mut self, mut reader: impl BufRead) -> Result<Series, Error> {
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
            // Tabs at the ends separate columns, too.
            let text = text.trim_matches([' ', '\r', '\n']);
            if !text.trim().is_empty() {
                self.row(text)?;
            }
        }
        self.finish()
    }

    fn row(&mut self, text: &str) -> Result<(), Error> {
        let is_comment = text.starts_with('#');
        match self.columns {
            Some(_) if is_comment => Ok(()),
            Some(columns) => {
                let cells = self.delimiter.split(text);
                self.values_of(columns, &cells)
            }
            None if !is_comment && is_numeric(text) => {
                self.delimiter = Delimiter::of_row(text);
                let cells = self.delimiter.split(text);
                let columns = *self.columns.insert(self.header(&cells)?);
                self.values_of(columns, &cells)
            }
            None => {
                if self.head.len() >= MOST_HEAD_LINES {
                    self.head.remove(0);
                }
                let text = text.trim_start_matches(['#', ' ']).to_owned();
                self.head.push(HeadLine { line: self.line, text });
                Ok(())
            }
        }
    }

    /// The columns named by the lines before the first row.
    fn header(&self, row: &[&str]) -> Result<Columns, Error> {
        let named = self.head.iter().rev().find_map(|head| {
            let own = Delimiter::of_row(&head.text).split(&head.text);
            // Names may have another separator than numbers, but then there must be as many: otherwise it is a
            // sentence.
            let as_parted = || self.columns(&own).filter(|_| own.len() == row.len());
            self.columns(&self.delimiter.split(&head.text)).or_else(as_parted)
        });
        match (named, self.head.first(), row) {
            (Some(columns), ..) => Ok(columns),
            // A single column may have any name.
            (None, _, [_]) => Ok(Columns { flux: 0, frame: None, time: None, unit_s: 1.0 }),
            (None, Some(head), _) => {
                let reason = "no column is named flux; begin with a line such as frame,flux or time_s,flux";
                Err(self.fault_at(head.line, reason))
            }
            (None, None, _) => {
                Err(self.fault("columns without names; begin with a line such as frame,flux or time_s,flux"))
            }
        }
    }

    /// The columns of a line of names; none if none is the flux.
    fn columns(&self, cells: &[&str]) -> Option<Columns> {
        let is_one_of = |cell: &str, names: &[&str]| {
            let (name, _) = name_and_unit(cell);
            names.iter().any(|known| name.eq_ignore_ascii_case(known))
        };
        let find = |names: &[&str]| cells.iter().position(|cell| is_one_of(cell, names));
        let time = find(&TIME_NAMES);
        let flux = find(&FLUX_NAMES)?;
        Some(Columns { flux, frame: find(&["frame"]), time, unit_s: time.map_or(1.0, |time| self.unit_s(cells, time)) })
    }

    /// The unit of time: in the name, in brackets after it, or in a line of units.
    fn unit_s(&self, names: &[&str], column: usize) -> f64 {
        let cell = names[column];
        if cell.eq_ignore_ascii_case("time_ms") {
            return 1e-3;
        }
        let in_brackets = name_and_unit(cell).1.and_then(seconds);
        let in_line = || {
            self.head.iter().find_map(|head| {
                let cells = self.delimiter.split(&head.text);
                cells.get(column).filter(|_| cells.len() == names.len()).and_then(|unit| seconds(unit))
            })
        };
        in_brackets.or_else(in_line).unwrap_or(1.0)
    }

    fn values_of(&mut self, columns: Columns, cells: &[&str]) -> Result<(), Error> {
        let most_rows = self.most_rows;
        if self.values.len() >= most_rows {
            return Err(self.fault(format!("more than {most_rows} rows; use a shorter series")));
        }
        let value = self.number(cells, columns.flux)?;
        if let Some(column) = columns.frame {
            let frame = self.frame(cells, column);
            if columns.time.is_some() && frame.is_err() {
                // Sub-frames, or every second frame: the times state all that matters.
                self.columns = Some(Columns { frame: None, ..columns });
                self.frames = None;
            } else {
                frame?;
            }
        }
        if let Some(column) = columns.time {
            self.time(cells, column, columns.unit_s)?;
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
        let number = self.delimiter.number(cell);
        number.ok_or_else(|| self.fault(format!("\"{}\" is not a finite number", shown(cell))))
    }

    fn frame(&mut self, cells: &[&str], column: usize) -> Result<(), Error> {
        let cell = self.cell(cells, column)?;
        let frame = cell.parse::<i64>();
        let frame = frame.map_err(|_| self.fault(format!("\"{}\" is not a frame number", shown(cell))))?;
        if let Some((_, last)) = self.frames
            && last.checked_add(1) != Some(frame)
        {
            return Err(self.fault(format!("frame {frame} follows {last}; frames must count up by one")));
        }
        self.frames = Some((self.frames.map_or(frame, |(first, _)| first), frame));
        Ok(())
    }

    fn time(&mut self, cells: &[&str], column: usize, unit_s: f64) -> Result<(), Error> {
        let time = unit_s * self.number(cells, column)?;
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
        let timing = match (self.frames, self.times.is_empty()) {
            (Some((first, _)), _) => Timing::Frames(first),
            (None, true) => Timing::Frames(0),
            (None, false) => Timing::Times(self.times),
        };
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
    fn dialects_of_every_kind_are_read() {
        let values = [100.0, 103.5, 107.25];
        for text in [
            "time_s\tflux\n0,00\t100\n0,01\t103,5\n0,02\t107,25\n",
            "time_s\tflux\n0.00\t100\n0.01\t103.5\n0.02\t107.25\n",
            "t;hrr\n0,00;100,0\n0,01;103,5\n0,02;107,25\n",
            "#time_s,flux\n0.00,100\n0.01,103.5\n0.02,107.25\n",
            "# made by hand\n# time_s,flux\n0.00,100\n# half way\n0.01,103.5\n0.02,107.25\n",
            "# time flux\n0.00 100\n0.01 103.5\n0.02 107.25\n",
            "time_s,flux\ns,kW\n0.00,100\n0.01,103.5\n0.02,107.25\n",
            "time_s,flux\n[s],[kW]\n0.00,100\n0.01,103.5\n0.02,107.25\n",
            "s,kW,kW\nTime,HRR,Q_RADI\n 0.0E+00, 1.0E+02, 0\n 1.0E-02, 1.035E+02, 0\n 2.0E-02, 1.0725E+02, 0\n",
            "s,kW\n\"Time\",\"HRR\"\n0.00,100\n0.01,103.5\n0.02,107.25\n",
            "time [s],HRR (kW)\n0.00,100\n0.01,103.5\n0.02,107.25\n",
            "time [ms],flux [W]\n0,100\n10,103.5\n20,107.25\n",
            "time,flux\nms,W\n0,100\n10,103.5\n20,107.25\n",
            "time_ms,flux\n0,100\n10,103.5\n20,107.25\n",
            "Burner 7 of 9\ntime,flux\n0.00,100\n0.01,103.5\n0.02,107.25\n",
        ] {
            let series = read(text).unwrap_or_else(|error| panic!("{text:?}: {error}"));
            assert_eq!(series.values, values, "{text:?}");
            let rate_hz = series.rate_hz.unwrap_or_else(|| panic!("{text:?} has no rate"));
            assert!((rate_hz - 100.0).abs() < 1e-6, "{text:?}: {rate_hz}");
        }
    }

    #[test]
    fn times_beside_frames_tell_the_rate() {
        let series = read("frame,time_s,flux\n7,0.0,1\n8,0.5,2\n9,1.0,3\n").unwrap();
        assert_eq!((series.timing, series.rate_hz), (Timing::Frames(7), Some(2.0)));
    }

    #[test]
    fn frames_that_do_not_count_up_matter_only_without_times() {
        for frames in [["1", "1.5", "2"], ["1001", "1003", "1005"]] {
            let [a, b, c] = frames;
            let text = format!("frame,flux,area,time_s\n{a},1,0,0.0\n{b},2,0,0.1\n{c},3,0,0.2\n");
            let series = read(&text).unwrap();
            assert_eq!((series.values, series.rate_hz), (vec![1.0, 2.0, 3.0], Some(10.0)));
            assert!(read(&format!("frame,flux\n{a},1\n{b},2\n{c},3\n")).is_err());
        }
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
