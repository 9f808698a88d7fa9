//! One parameter: its range, and its three representations (plain value, normalised value, text).
//!
//! Plain values lie on a grid of `decimals` decimal places. A value on the grid passes through a host, which handles it
//! as a normalised 32-bit float, and through text, without changing a bit: so the plug-in in a host and a render from
//! the command line use the same number.

use crate::Error;
use crate::group::Group;
use crate::id::Id;

/// Kind of a parameter's values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParameterKind {
    /// A continuous value.
    Float {
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
        /// Value of a fresh instance.
        default: f64,
        /// Exponent of the normalised scale, `normalised = ((plain - low) / (high - low))^skew`; 1 is linear, and less
        /// than 1 gives low values more room.
        skew: f64,
        /// Significant decimal places; values are rounded to them.
        decimals: u32,
        /// True if the smallest value means "off" (in dB: minus infinity).
        off_at_low: bool,
    },
    /// An integer.
    Int {
        /// Smallest value.
        low: i32,
        /// Largest value.
        high: i32,
        /// Value of a fresh instance.
        default: i32,
    },
    /// One of several, as an index; names are only ever appended, so that indices stay.
    Choice {
        /// The names.
        names: &'static [&'static str],
        /// Index of a fresh instance's choice.
        default: usize,
    },
    /// Off (0) or on (1).
    Toggle {
        /// Value of a fresh instance.
        default: bool,
    },
}

/// One row of the [table](crate::PARAMETERS).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameter {
    /// Position in the table.
    pub index: Id,
    /// Stable name in presets, states, automation and on the command line.
    pub id: &'static str,
    /// Name shown to the user.
    pub name: &'static str,
    /// Heading under which it is displayed.
    pub group: Group,
    /// Unit of its plain value; empty without one.
    pub unit: &'static str,
    /// Range and default.
    pub kind: ParameterKind,
    /// True if it may change during playback.
    pub automatable: bool,
    /// True if it decides sizes and latency (see [`pyrophone_synthesis::EngineConfig`]).
    pub structure: bool,
    /// The plain value in Chadwick & James 2011, if the paper has one.
    pub paper: Option<f64>,
    /// Effect on the sound.
    pub help: &'static str,
}

impl Parameter {
    /// Smallest plain value.
    pub fn low(&self) -> f64 {
        match self.kind {
            ParameterKind::Float { low, .. } => low,
            ParameterKind::Int { low, .. } => f64::from(low),
            ParameterKind::Choice { .. } | ParameterKind::Toggle { .. } => 0.0,
        }
    }

    /// Largest plain value.
    pub fn high(&self) -> f64 {
        match self.kind {
            ParameterKind::Float { high, .. } => high,
            ParameterKind::Int { high, .. } => f64::from(high),
            ParameterKind::Choice { names, .. } => (names.len() - 1) as f64,
            ParameterKind::Toggle { .. } => 1.0,
        }
    }

    /// Plain value of a fresh instance.
    pub fn default_value(&self) -> f64 {
        match self.kind {
            ParameterKind::Float { default, .. } => default,
            ParameterKind::Int { default, .. } => f64::from(default),
            ParameterKind::Choice { default, .. } => default as f64,
            ParameterKind::Toggle { default } => f64::from(u8::from(default)),
        }
    }

    /// True if `plain` means "off" for a parameter that can be off.
    pub fn is_off(&self, plain: f64) -> bool {
        matches!(self.kind, ParameterKind::Float { low, off_at_low: true, .. } if plain <= low)
    }

    /// The nearest allowed value; NaN becomes the default.
    pub fn snap(&self, plain: f64) -> f64 {
        if plain.is_nan() {
            return self.default_value();
        }
        let clamped = plain.clamp(self.low(), self.high());
        match self.kind {
            ParameterKind::Float { decimals, .. } => {
                let per_unit = maths::powi(10.0, decimals as i32);
                // Adding 0 turns a rounded -0 into 0.
                (clamped * per_unit).round() / per_unit + 0.0
            }
            _ => clamped.round(),
        }
    }

    /// The nearest value of the grid; fails if `plain` is outside the range.
    pub fn check(&self, plain: f64) -> Result<f64, Error> {
        if plain >= self.low() && plain <= self.high() {
            Ok(self.snap(plain))
        } else {
            let found = if self.unit.is_empty() { format!("{plain}") } else { format!("{plain} {}", self.unit) };
            let (low, high) = (self.to_text(self.low()), self.to_text(self.high()));
            Err(Error::OutOfRange { id: self.id, found, low, high })
        }
    }

    /// Plain to normalised (0-1), as hosts automate it.
    pub fn to_normalised(&self, plain: f64) -> f64 {
        let share = (self.snap(plain) - self.low()) / (self.high() - self.low());
        match self.kind {
            ParameterKind::Float { skew, .. } if skew != 1.0 => maths::pow(share, skew),
            _ => share,
        }
    }

    /// Normalised (0-1; beyond is clamped) to the nearest plain value of the grid.
    pub fn from_normalised(&self, normalised: f64) -> f64 {
        if normalised.is_nan() {
            return self.default_value();
        }
        let share = match self.kind {
            ParameterKind::Float { skew, .. } if skew != 1.0 => maths::pow(normalised.clamp(0.0, 1.0), skew.recip()),
            _ => normalised.clamp(0.0, 1.0),
        };
        self.snap(self.low() + share * (self.high() - self.low()))
    }

    /// The value as text, with its unit.
    pub fn to_text(&self, plain: f64) -> String {
        let plain = self.snap(plain);
        let number = match self.kind {
            ParameterKind::Choice { names, .. } => return names[plain as usize].to_owned(),
            ParameterKind::Toggle { .. } => return if plain > 0.5 { "on" } else { "off" }.to_owned(),
            ParameterKind::Float { .. } if self.is_off(plain) => return "off".to_owned(),
            ParameterKind::Float { decimals, .. } => format!("{plain:.*}", decimals as usize),
            ParameterKind::Int { .. } => format!("{plain}"),
        };
        if self.unit.is_empty() { number } else { format!("{number} {}", self.unit) }
    }

    /// Text to a plain value, with or without the unit or a common multiple of it (`0.25k` and `0.3 kHz` for Hz, `20
    /// ms` for seconds); `off` and `-inf` if it can be off. Case and spaces are ignored; a decimal comma is accepted.
    ///
    /// # Errors
    /// If the text is not a value of this parameter, or outside its range.
    pub fn parse(&self, text: &str) -> Result<f64, Error> {
        let trimmed = text.trim();
        let lower = trimmed.to_lowercase();
        let without_unit = match lower.strip_suffix(&self.unit.to_lowercase()) {
            Some(rest) => rest.trim_end(),
            None => lower.as_str(),
        };
        let wrong = || self.wrong_kind(format!("`{trimmed}`"));
        match self.kind {
            ParameterKind::Choice { names, .. } => {
                names.iter().position(|name| *name == lower).map(|index| index as f64).ok_or_else(wrong)
            }
            ParameterKind::Toggle { .. } => match lower.as_str() {
                "on" | "true" | "yes" | "1" => Ok(1.0),
                "off" | "false" | "no" | "0" => Ok(0.0),
                _ => Err(wrong()),
            },
            ParameterKind::Float { low, off_at_low: true, .. } if matches!(without_unit, "off" | "-inf" | "-∞") => {
                Ok(low)
            }
            ParameterKind::Float { .. } => self.check(self.number(&lower).ok_or_else(wrong)?),
            ParameterKind::Int { .. } => match self.number(&lower) {
                Some(number) if number.fract() == 0.0 => self.check(number),
                _ => Err(wrong()),
            },
        }
    }

    /// As [`parse`](Self::parse), but a value outside the range becomes the nearest one inside; also returns whether it
    /// did.
    ///
    /// # Errors
    /// If the text is not a value of this parameter.
    pub fn parse_nearest(&self, text: &str) -> Result<(f64, bool), Error> {
        match (self.parse(text), self.number(&text.trim().to_lowercase())) {
            (Err(Error::OutOfRange { .. }), Some(number)) => Ok((self.snap(number), true)),
            (parsed, _) => parsed.map(|plain| (plain, false)),
        }
    }

    /// A finite number in this parameter's unit, from lower-case text in that unit, in a multiple of it, or without a
    /// unit.
    fn number(&self, text: &str) -> Option<f64> {
        let multiples: &[(&str, f64)] = match self.unit {
            "Hz" => &[("khz", 1e3), ("k", 1e3)],
            "ms" => &[("s", 1e3)],
            "s" => &[("ms", 1e-3)],
            "m" => &[("cm", 1e-2), ("km", 1e3)],
            _ => &[],
        };
        let own = self.unit.to_lowercase();
        [(own.as_str(), 1.0)].iter().chain(multiples).chain(&[("", 1.0)]).find_map(|(unit, factor)| {
            let digits = text.strip_suffix(unit)?.trim_end();
            let number: f64 = digits.parse().or_else(|_| digits.replacen(',', ".", 1).parse()).ok()?;
            number.is_finite().then_some(number * factor)
        })
    }

    /// The error for a value of the wrong kind.
    pub(crate) fn wrong_kind(&self, found: String) -> Error {
        let (expected, example) = match self.kind {
            ParameterKind::Float { off_at_low, .. } => {
                let unit = if self.unit.is_empty() { String::new() } else { format!(" in {}", self.unit) };
                let off = if off_at_low { " or \"off\"" } else { "" };
                (format!("a number{unit}{off}"), format!("{}", self.default_value()))
            }
            ParameterKind::Int { .. } => ("a whole number".to_owned(), format!("{}", self.default_value())),
            ParameterKind::Choice { names, default } => {
                (format!("one of \"{}\"", names.join("\", \"")), format!("\"{}\"", names[default]))
            }
            ParameterKind::Toggle { default } => ("true or false".to_owned(), default.to_string()),
        };
        Error::WrongKind { id: self.id, found, expected, example }
    }
}
