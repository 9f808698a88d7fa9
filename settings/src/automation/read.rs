//! An automation's text: its header, and its rows one by one.

use csv::{ReaderBuilder, StringRecord, Trim};

use super::{Curve, Row, Time};
use crate::{Error, PARAMETERS, ParameterKind, index_of};

/// The latest time allowed in seconds: a day, so that no row can be beyond the range of samples.
const LATEST_S: f64 = 86_400.0;

/// The format that the first line declares.
#[derive(Clone, Copy)]
struct Columns {
    in_seconds: bool,
    has_curve: bool,
    has_semicolons: bool,
}

/// The rows of a text, sorted by time.
pub(super) fn rows(text: &str) -> Result<Vec<Row>, Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#')).unwrap_or_default();
    let has_semicolons = first.contains(';');
    let mut reader = ReaderBuilder::new()
        .delimiter(if has_semicolons { b';' } else { b',' })
        .comment(Some(b'#'))
        .trim(Trim::All)
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut records = reader.records();
    let header = records.next().and_then(Result::ok).unwrap_or_default();
    let columns = columns(&header, has_semicolons)?;
    let mut rows: Vec<Row> = Vec::new();
    let mut previous = String::new();
    for record in records {
        let record = record.map_err(|error| Error::AutomationRow {
            line: error.position().map_or(0, csv::Position::line),
            message: error.to_string(),
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let row = row(&record, columns, line)?;
        if rows.last().is_some_and(|above| row.time.is_before(above.time)) {
            return Err(Error::AutomationOrder { line, found: record[0].to_owned(), previous });
        }
        previous = record[0].to_owned();
        rows.push(row);
    }
    Ok(rows)
}

fn columns(header: &StringRecord, has_semicolons: bool) -> Result<Columns, Error> {
    let names: Vec<&str> = header.iter().collect();
    let (in_seconds, has_curve) = match names.as_slice() {
        ["time_s", "id", "value"] => (true, false),
        ["time_s", "id", "value", "curve"] => (true, true),
        ["sample", "id", "value"] => (false, false),
        ["sample", "id", "value", "curve"] => (false, true),
        found => return Err(Error::AutomationHeader { found: found.join(",") }),
    };
    Ok(Columns { in_seconds, has_curve, has_semicolons })
}

fn row(record: &StringRecord, columns: Columns, line: u64) -> Result<Row, Error> {
    let fields: Vec<&str> = record.iter().collect();
    let (time, id, value, curve) = match (fields.as_slice(), columns.has_curve) {
        ([time, id, value], _) => (*time, *id, *value, ""),
        ([time, id, value, curve], true) => (*time, *id, *value, *curve),
        (_, has_curve) => {
            let allowed = if has_curve { "three or four: time, id, value, curve" } else { "three: time, id, value" };
            let message = format!("{} fields, but a row has {allowed}", fields.len());
            return Err(Error::AutomationRow { line, message });
        }
    };
    // Programs that write semicolons do so because their decimals have commas.
    let number = |text: &str| if columns.has_semicolons { text.replace(',', ".") } else { text.to_owned() };
    let time = Time::read(&number(time), columns.in_seconds).map_err(|allowed| Error::AutomationRow {
        line,
        message: format!("the time is `{time}`, but must be {allowed}"),
    })?;
    let in_row = |source| Error::AutomationValue { line, source: Box::new(source) };
    let parameter = index_of(id).map_err(in_row)?;
    if !PARAMETERS[parameter].automatable {
        return Err(in_row(Error::NotAutomatable { id: PARAMETERS[parameter].id }));
    }
    let value = PARAMETERS[parameter].parse(&number(value)).map_err(in_row)?;
    let curve = Curve::read(curve, parameter).map_err(|message| Error::AutomationRow { line, message })?;
    Ok(Row { time, parameter, value, curve })
}

impl Curve {
    fn read(text: &str, parameter: usize) -> Result<Self, String> {
        let parameter = &PARAMETERS[parameter];
        match text {
            "" | "step" => Ok(Self::Step),
            "linear" if matches!(parameter.kind, ParameterKind::Choice { .. } | ParameterKind::Toggle { .. }) => {
                Err(format!("{} has no intermediate values, so its curve must be `step`", parameter.id))
            }
            "linear" => Ok(Self::Linear),
            found => Err(format!("the curve is `{found}`, but must be `step` or `linear`")),
        }
    }
}

impl Time {
    /// Reads a time; the error states what is allowed.
    fn read(text: &str, in_seconds: bool) -> Result<Self, &'static str> {
        if in_seconds {
            let seconds = text.parse().ok().filter(|seconds| (0.0..=LATEST_S).contains(seconds));
            seconds.map(Time::Seconds).ok_or("seconds from 0 to 86400")
        } else {
            text.parse().map(Time::Sample).map_err(|_| "a whole number of samples from 0")
        }
    }

    fn is_before(self, other: Self) -> bool {
        match (self, other) {
            (Self::Seconds(a), Self::Seconds(b)) => a < b,
            (Self::Sample(a), Self::Sample(b)) => a < b,
            _ => false,
        }
    }
}
