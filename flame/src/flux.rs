//! The flux of a whole simulation, step by step: tables, shards of them, and gaps.

use std::collections::BTreeMap;
use std::io::{Result as IoResult, Write};

use crate::error::{Error, in_range};
use crate::front::Measure;
use crate::import::Numbering;

/// Most frames between the first and the last of a table: a single stray number must not fill memory with interpolated
/// steps.
pub const MAX_FRAMES: u64 = 10_000_000;

/// Start of a partial table's first line; its settings follow.
const MARK: &str = "# pyrophone flux 3; ";

/// Start of the line that names the cache of a part.
const CACHE_MARK: &str = "# cache ";

/// Start of a part's last line; the number of steps and a hash of everything before follow.
const END_MARK: &str = "# end ";

/// Start of the line with a change to the next step.
const CHANGE_MARK: char = '+';

/// One step of a flame, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// The step's number.
    pub frame: i64,
    /// Velocity flux through the front, volume per second.
    pub flux: f64,
    /// The front's area.
    pub area: f64,
    /// The front's mean curvature; none if the table does not state it.
    pub mean_curvature: Option<f64>,
}

impl Row {
    /// The row of a frame's measurements.
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
    /// Numbers of the interpolated steps, in order.
    pub interpolated: Vec<i64>,
}

impl Flux {
    /// Fills skipped and missing steps: linearly between neighbours, and with the nearest step's values before the
    /// first and after the last measured step.
    ///
    /// # Errors
    /// If nothing was measured, or beyond [`MAX_FRAMES`].
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

    /// Writes `frame,flux,area` and, if steps per second are known, `time_s`; flux and area read back as the same
    /// `f64`. Frames are named by `label`.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_csv(&self, rate_hz: Option<f64>, label: impl Fn(i64) -> String, to: &mut impl Write) -> IoResult<()> {
        writeln!(to, "frame,flux,area{}", if rate_hz.is_some() { ",time_s" } else { "" })?;
        self.rows.iter().try_for_each(|row| {
            write!(to, "{},{:?},{:?}", label(row.frame), row.flux, row.area)?;
            rate_hz.map_or(Ok(()), |rate_hz| write!(to, ",{:.9}", row.frame as f64 / rate_hz))?;
            writeln!(to)
        })
    }

    /// Reads the output of [`write_csv`](Self::write_csv), or any table that begins with the same columns; `name` is
    /// used in messages. Missing frames in between are interpolated.
    ///
    /// # Errors
    /// [`Error::Table`] with the line if a row is malformed; [`Error::NoFrames`] if no frame was measured.
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
                .ok_or_else(|| damaged("flux and area must follow the frame number".into()))?;
            if steps.insert(frame, Some(Row { frame, flux, area, mean_curvature: None })).is_some() {
                return Err(damaged(format!("duplicate frame {frame}")));
            }
        }
        Self::from_steps(&steps)
    }
}

/// The row at `frame`, linear between `before` and `after`; outside them, the nearer of the two.
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

/// Changes from each step to the next, by the number of the first one; the values are defined by the upsampler.
pub type Changes = BTreeMap<i64, Vec<f64>>;

/// A part of a simulation's table, with the data that must agree when parts are merged.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FluxShard {
    /// Settings of the measurement, one line; empty if nothing burns in any frame, or none could be measured.
    pub settings: String,
    /// The cache that was measured, as one word; empty if it does not matter.
    pub cache: String,
    /// Steps per second, if known.
    pub rate_hz: Option<f64>,
    /// Relation of frame numbers to its steps.
    pub numbering: Numbering,
    /// Its steps.
    pub steps: Steps,
    /// Changes from each of its steps to the next, if upsampling needs them.
    pub changes: Changes,
}

impl FluxShard {
    /// Writes lines with the settings and the cache, then `frame,flux,area,mean_curvature` (skipped frames have empty
    /// fields), then changes, and last the number of steps with a hash of everything before, which reveals truncated
    /// files.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write(&self, to: &mut impl Write) -> IoResult<()> {
        let mut text = vec![];
        self.write_head(&mut text)?;
        for (frame, row) in &self.steps {
            Self::write_step(*frame, row.as_ref(), &mut text)?;
        }
        for (frame, change) in &self.changes {
            Self::write_change(*frame, change, &mut text)?;
        }
        let hash = hash(&text);
        writeln!(text, "{END_MARK}{} {hash:016x}", self.steps.len())?;
        to.write_all(&text)
    }

    /// Writes the lines before the steps. Control characters become spaces.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_head(&self, to: &mut impl Write) -> IoResult<()> {
        let plain = |text: &str| text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect::<String>();
        let [stride, subframes, rest] = self.numbering.parts();
        let rate = self.rate_hz.map_or("unknown".into(), |rate_hz| format!("{rate_hz:?}"));
        writeln!(to, "{MARK}{}", plain(&self.settings))?;
        writeln!(to, "{CACHE_MARK}{}; rate {rate}; steps {stride} {subframes} {rest}", plain(&self.cache))?;
        writeln!(to, "frame,flux,area,mean_curvature")
    }

    /// Reads the line with the cache.
    fn read_cache(&mut self, line: &str) -> Option<()> {
        let mut parts = line.strip_prefix(CACHE_MARK)?.splitn(3, "; ");
        self.cache = parts.next()?.to_owned();
        let rate = parts.next()?.strip_prefix("rate ")?;
        self.rate_hz = rate.parse().ok().filter(|rate_hz: &f64| *rate_hz > 0.0 && rate_hz.is_finite());
        let numbers: Vec<i64> =
            parts.next()?.strip_prefix("steps ")?.split(' ').map_while(|n| n.parse().ok()).collect();
        self.numbering = Numbering::of_parts(*numbers.first_chunk()?)?;
        Some(())
    }

    /// Writes one step's line.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_step(frame: i64, row: Option<&Row>, to: &mut impl Write) -> IoResult<()> {
        match row {
            None => writeln!(to, "{frame},,,"),
            Some(Row { flux, area, mean_curvature: Some(curvature), .. }) => {
                writeln!(to, "{frame},{flux:?},{area:?},{curvature:?}")
            }
            Some(Row { flux, area, .. }) => writeln!(to, "{frame},{flux:?},{area:?},"),
        }
    }

    /// Writes the line of the change from step `frame` to the next.
    ///
    /// # Errors
    /// If writing to `to` fails.
    pub fn write_change(frame: i64, change: &[f64], to: &mut impl Write) -> IoResult<()> {
        write!(to, "{CHANGE_MARK}{frame}")?;
        change.iter().try_for_each(|number| write!(to, ",{number:?}"))?;
        writeln!(to)
    }

    /// Reads the output of [`write`](Self::write); `name` is used in messages.
    ///
    /// # Errors
    /// If the text is not a part, or was truncated or modified.
    pub fn read(text: &str, name: &str) -> Result<Self, Error> {
        let damaged = |line, reason: String| Error::Table { name: name.into(), line, reason };
        if !text.starts_with(MARK) {
            return Err(damaged(1, "this is not a part of a flux table".into()));
        }
        let (body, end) = text.rfind(END_MARK).map(|at| text.split_at(at)).unwrap_or((text, ""));
        let count = text.lines().count();
        let part = Self::read_unfinished(body, name)?;
        let expected = format!("{END_MARK}{} {:016x}\n", part.steps.len(), hash(body.as_bytes()));
        if end == expected { Ok(part) } else { Err(damaged(count, "the part was truncated or modified".into())) }
    }

    /// Reads a part whose last line is still to come.
    ///
    /// # Errors
    /// As [`read`](Self::read), except that the last line may be missing.
    pub fn read_unfinished(text: &str, name: &str) -> Result<Self, Error> {
        let damaged = |line, reason: String| Error::Table { name: name.into(), line, reason };
        let mut head = text.lines();
        let Some(settings) = head.next().and_then(|line| line.strip_prefix(MARK)) else {
            return Err(damaged(1, "this is not a part of a flux table".into()));
        };
        let mut part = Self { settings: settings.into(), ..Self::default() };
        head.next()
            .and_then(|line| part.read_cache(line))
            .ok_or_else(|| damaged(2, "the line with the cache is missing".into()))?;
        for (number, line) in lines(text).skip(1) {
            part.read_line(line).map_err(|reason| damaged(number, reason))?;
        }
        Ok(part)
    }

    fn read_line(&mut self, line: &str) -> Result<(), String> {
        let change = line.strip_prefix(CHANGE_MARK);
        let fields: Vec<&str> = change.unwrap_or(line).split(',').collect();
        let (frame, numbers) = fields_of(&fields)?;
        if change.is_some() {
            let before = self.changes.insert(frame, numbers);
            return before.map_or(Ok(()), |_| Err(format!("duplicate change of frame {frame}")));
        }
        let row = match numbers[..] {
            [] => None,
            [flux, area] => Some(Row { frame, flux, area, mean_curvature: None }),
            [flux, area, curvature] => Some(Row { frame, flux, area, mean_curvature: Some(curvature) }),
            _ => return Err("there must be 0, 2 or 3 values".into()),
        };
        let before = self.steps.insert(frame, row);
        before.map_or(Ok(()), |_| Err(format!("duplicate frame {frame}")))
    }

    /// Merges parts in any order, each with its name for messages.
    ///
    /// # Errors
    /// If their settings or caches differ, if two contain the same frame, or if a frame between the first and the last is missing. Parts in which nothing burns or could be measured have no settings.
    pub fn merge(parts: &[(String, Self)]) -> Result<Self, Error> {
        let is_measured = |(_, part): &&(String, Self)| part.steps.values().any(Option::is_some);
        let decides = |(_, part): &&(String, Self)| !part.settings.is_empty();
        let found = parts.iter().find(decides).or_else(|| parts.iter().find(is_measured));
        let Some((first, Self { settings, cache, numbering, .. })) = found else { return Err(Error::NoFrames) };
        let mut merged: BTreeMap<i64, (Option<Row>, &str)> = BTreeMap::new();
        let mut changes = Changes::new();
        for (name, part) in parts {
            if part.settings != *settings && !part.settings.is_empty() {
                return Err(Error::SettingsDiffer {
                    first: first.clone(),
                    first_settings: settings.clone(),
                    second: name.clone(),
                    second_settings: part.settings.clone(),
                });
            }
            if part.cache != *cache || part.numbering != *numbering {
                return Err(Error::CachesDiffer { first: first.clone(), second: name.clone() });
            }
            for (frame, row) in &part.steps {
                if let Some((_, before)) = merged.insert(*frame, (*row, name)) {
                    return Err(Error::Overlap { frame: *frame, first: before.into(), second: name.clone() });
                }
            }
            changes.extend(part.changes.iter().map(|(frame, change)| (*frame, change.clone())));
        }
        if let Some((before, _)) =
            merged.keys().zip(merged.keys().skip(1)).find(|(before, after)| before.checked_add(1) != Some(**after))
        {
            return Err(Error::Hole { frame: before + 1 });
        }
        let steps = merged.into_iter().map(|(frame, (row, _))| (frame, row)).collect();
        let rate_hz = parts.iter().find_map(|(_, part)| part.rate_hz);
        let (settings, cache, numbering) = (settings.clone(), cache.clone(), *numbering);
        Ok(Self { settings, cache, rate_hz, numbering, steps, changes })
    }
}

/// FNV-1a of 64 bits (Fowler, Noll & Vo): detects damage, not malice.
fn hash(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// Lines with content, numbered from 1.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let says = |line: &str| !line.trim().is_empty() && !line.starts_with('#');
    text.lines().enumerate().filter(move |(_, line)| says(line)).map(|(index, line)| (index + 1, line))
}

/// A frame number, and the values after it up to the first empty field.
fn fields_of(fields: &[&str]) -> Result<(i64, Vec<f64>), String> {
    let (frame, values) = fields.split_first().ok_or("the line is empty")?;
    let frame = frame.parse().map_err(|_| format!("'{}' is not a frame number", clean(frame)))?;
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
