//! The flux of a whole simulation, step by step: tables, shards of them, and gaps.

use std::collections::BTreeMap;
use std::io::{Result as IoResult, Write};

use crate::error::{Error, in_range};
use crate::front::Measure;

/// Most frames between the first and the last of a table.
pub const MAX_FRAMES: u64 = 10_000_000;

/// How a partial table begins; its settings follow.
const MARK: &str = "# pyrophone flux 1; ";

/// One step of a flame, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The step's number.
    pub frame: i64,
    /// Velocity flux through the front, volume per second.
    pub flux: f64,
    /// The front's area.
    pub area: f64,
    /// The front's mean curvature; none where the table it was read from does not say.
    pub mean_curvature: Option<f64>,
}

impl Row {
    /// What was measured at a frame.
    pub fn new(frame: i64, measure: &Measure) -> Self {
        let Measure { flux, area, mean_curvature, .. } = *measure;
        Self { frame, flux, area, mean_curvature }
    }
}

/// Steps by number; none for a frame that was skipped.
pub type Steps = BTreeMap<i64, Option<Row>>;

/// Flux and area of every step from the first to the last, at an even rate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Flux {
    /// The steps, in order and without gaps.
    pub rows: Vec<Row>,
    /// Numbers of those that were not measured but interpolated, in order.
    pub interpolated: Vec<i64>,
}

impl Flux {
    /// Fills what was skipped or is missing: linear between its neighbours, and the nearest step's values before the
    /// first and after the last one measured.
    ///
    /// Fails where nothing was measured, or beyond [`MAX_FRAMES`].
    pub fn from_steps(steps: &Steps) -> Result<Self, Error> {
        let measured: Vec<Row> = steps.values().flatten().copied().collect();
        let (Some(first), Some(last)) = (steps.keys().next(), steps.keys().next_back()) else {
            return Err(Error::NoFrames);
        };
        let (Some(mut before), Some(end)) = (measured.first().copied(), measured.last().copied()) else {
            return Err(Error::NoFrames);
        };
        in_range(
            "the number of frames from the first to the last",
            last.abs_diff(*first) as f64,
            0.0,
            MAX_FRAMES as f64,
        )?;
        let mut flux = Self::default();
        let mut coming = measured.iter().peekable();
        for frame in *first..=*last {
            if let Some(row) = coming.next_if(|row| row.frame == frame) {
                before = *row;
                flux.rows.push(before);
                continue;
            }
            let after = coming.peek().copied().copied().unwrap_or(end);
            flux.rows.push(between(&before, &after, frame));
            flux.interpolated.push(frame);
        }
        Ok(flux)
    }

    /// The flux of every step.
    pub fn values(&self) -> Vec<f64> {
        self.rows.iter().map(|row| row.flux).collect()
    }

    /// Writes `frame,flux,area`; the numbers read back as the same `f64`.
    pub fn write_csv(&self, to: &mut impl Write) -> IoResult<()> {
        writeln!(to, "frame,flux,area")?;
        self.rows.iter().try_for_each(|row| writeln!(to, "{},{:?},{:?}", row.frame, row.flux, row.area))
    }

    /// Reads what [`write_csv`](Self::write_csv) wrote, or any table whose first columns are these; `name` stands in
    /// messages. Frames missing in between are interpolated.
    pub fn read_csv(text: &str, name: &str) -> Result<Self, Error> {
        let mut steps = Steps::new();
        let mut has_header = false;
        for (number, line) in lines(text) {
            let damaged = |reason: String| Error::Table { name: name.into(), line: number, reason };
            let fields: Vec<&str> = line.split(',').map(str::trim).collect();
            if !has_header {
                has_header = fields.starts_with(&["frame", "flux", "area"]);
                if !has_header {
                    return Err(damaged("the header must begin with frame,flux,area".into()));
                }
                continue;
            }
            let (frame, numbers) = fields_of(&fields).map_err(damaged)?;
            let [flux, area] = numbers
                .get(..2)
                .and_then(|two| two.try_into().ok())
                .ok_or_else(|| damaged("flux and area must follow the frame's number".into()))?;
            if steps.insert(frame, Some(Row { frame, flux, area, mean_curvature: None })).is_some() {
                return Err(damaged(format!("frame {frame} stands there twice")));
            }
        }
        Self::from_steps(&steps)
    }
}

/// The row at `frame`, linear from `before` to `after`; the nearer of the two outside them.
fn between(before: &Row, after: &Row, frame: i64) -> Row {
    let span = after.frame.saturating_sub(before.frame).max(0);
    let share = if span == 0 { 0.0 } else { frame.saturating_sub(before.frame).clamp(0, span) as f64 / span as f64 };
    let mix = |a: f64, b: f64| a + share * (b - a);
    Row {
        frame,
        flux: mix(before.flux, after.flux),
        area: mix(before.area, after.area),
        mean_curvature: before.mean_curvature.zip(after.mean_curvature).map(|(a, b)| mix(a, b)),
    }
}

/// A part of a simulation's table, with what must agree before parts are put together.
#[derive(Debug, Clone, PartialEq)]
pub struct Partial {
    /// How it was measured, one line.
    pub settings: String,
    /// Its steps.
    pub steps: Steps,
}

impl Partial {
    /// Writes a line with the settings, then `frame,flux,area,mean_curvature`; skipped frames have empty fields.
    pub fn write(&self, to: &mut impl Write) -> IoResult<()> {
        Self::write_head(&self.settings, to)?;
        self.steps.iter().try_for_each(|(frame, row)| Self::write_step(*frame, row.as_ref(), to))
    }

    /// Writes the lines before the steps. Control characters in `settings` become spaces.
    pub fn write_head(settings: &str, to: &mut impl Write) -> IoResult<()> {
        let settings: String = settings.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        writeln!(to, "{MARK}{settings}\nframe,flux,area,mean_curvature")
    }

    /// Writes one step's line.
    pub fn write_step(frame: i64, row: Option<&Row>, to: &mut impl Write) -> IoResult<()> {
        match row {
            None => writeln!(to, "{frame},,,"),
            Some(Row { flux, area, mean_curvature: Some(curvature), .. }) => {
                writeln!(to, "{frame},{flux:?},{area:?},{curvature:?}")
            }
            Some(Row { flux, area, .. }) => writeln!(to, "{frame},{flux:?},{area:?},"),
        }
    }

    /// Reads what [`write`](Self::write) wrote; `name` stands in messages.
    pub fn read(text: &str, name: &str) -> Result<Self, Error> {
        let damaged = |line, reason: String| Error::Table { name: name.into(), line, reason };
        let Some(settings) = text.lines().next().and_then(|line| line.strip_prefix(MARK)) else {
            return Err(damaged(1, "this is not a part of a flux table".into()));
        };
        let mut steps = Steps::new();
        for (number, line) in lines(text).skip(1) {
            let fields: Vec<&str> = line.split(',').collect();
            let (frame, numbers) = fields_of(&fields).map_err(|reason| damaged(number, reason))?;
            let row = match numbers[..] {
                [] => None,
                [flux, area] => Some(Row { frame, flux, area, mean_curvature: None }),
                [flux, area, curvature] => Some(Row { frame, flux, area, mean_curvature: Some(curvature) }),
                _ => return Err(damaged(number, "there must be 0, 2 or 3 values".into())),
            };
            if steps.insert(frame, row).is_some() {
                return Err(damaged(number, format!("frame {frame} stands there twice")));
            }
        }
        Ok(Self { settings: settings.into(), steps })
    }

    /// Puts parts together, each with the name that stands in messages, in any order.
    ///
    /// Fails where their settings differ, where two hold the same frame, and where a frame between the first and the
    /// last is in none.
    pub fn merge(parts: &[(String, Self)]) -> Result<Self, Error> {
        let Some((first, Self { settings, .. })) = parts.first() else { return Err(Error::NoFrames) };
        let mut merged: BTreeMap<i64, (Option<Row>, &str)> = BTreeMap::new();
        for (name, part) in parts {
            if part.settings != *settings {
                return Err(Error::SettingsDiffer {
                    first: first.clone(),
                    first_settings: settings.clone(),
                    second: name.clone(),
                    second_settings: part.settings.clone(),
                });
            }
            for (frame, row) in &part.steps {
                if let Some((_, before)) = merged.insert(*frame, (*row, name)) {
                    return Err(Error::Overlap { frame: *frame, first: before.into(), second: name.clone() });
                }
            }
        }
        if let Some((before, _)) =
            merged.keys().zip(merged.keys().skip(1)).find(|(before, after)| before.checked_add(1) != Some(**after))
        {
            return Err(Error::Hole { frame: before + 1 });
        }
        let steps = merged.into_iter().map(|(frame, (row, _))| (frame, row)).collect();
        Ok(Self { settings: settings.clone(), steps })
    }
}

/// Lines that say something, numbered from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let says = |line: &str| !line.trim().is_empty() && !line.starts_with('#');
    text.lines().enumerate().filter(move |(_, line)| says(line)).map(|(index, line)| (index + 1, line))
}

/// A frame's number, and the values after it up to the first empty field.
fn fields_of(fields: &[&str]) -> Result<(i64, Vec<f64>), String> {
    let (frame, values) = fields.split_first().ok_or("the line is empty")?;
    let frame = frame.parse().map_err(|_| format!("'{}' is not a frame's number", clean(frame)))?;
    let number = |field: &&str| match field.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("'{}' is not a finite number", clean(field))),
    };
    let values: Result<Vec<f64>, String> = values.iter().take_while(|field| !field.is_empty()).map(number).collect();
    Ok((frame, values?))
}

/// The beginning of a field, fit for a message.
fn clean(field: &str) -> String {
    field.chars().take(40).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}
