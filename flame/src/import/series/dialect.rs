//! Dialects of tables: separators, number formats, units.

/// Separator of a row's columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Delimiter {
    Comma,
    Tab,
    Semicolon,
    Space,
    /// A single column.
    None,
}

impl Delimiter {
    /// The delimiter of a row of numbers.
    pub fn of_row(row: &str) -> Self {
        match row {
            row if row.contains('\t') => Self::Tab,
            row if row.contains(';') => Self::Semicolon,
            row if row.contains(',') => Self::Comma,
            row if row.trim().contains(char::is_whitespace) => Self::Space,
            _ => Self::None,
        }
    }

    /// The cells of a row, without quotation marks.
    pub fn split(self, row: &str) -> Vec<&str> {
        match self {
            Self::Comma => row.split(',').map(clean).collect(),
            Self::Tab => row.split('\t').map(clean).collect(),
            Self::Semicolon => row.split(';').map(clean).collect(),
            Self::Space => row.split_whitespace().map(clean).collect(),
            Self::None => vec![clean(row)],
        }
    }

    /// The number in a cell. Commas may be decimal unless they separate columns.
    pub fn number(self, cell: &str) -> Option<f64> {
        let has_decimal_comma = self != Self::Comma && cell.matches(',').count() == 1 && !cell.contains('.');
        let number = if has_decimal_comma { cell.replace(',', ".").parse() } else { cell.parse() };
        number.ok().filter(|number: &f64| number.is_finite())
    }
}

fn clean(cell: &str) -> &str {
    cell.trim().trim_matches('"').trim()
}

/// True for a row of numbers, valid or not: its first non-empty cell is one.
pub(super) fn is_numeric(row: &str) -> bool {
    let delimiter = Delimiter::of_row(row);
    let cells = delimiter.split(row);
    let first = cells.into_iter().find(|cell| !cell.is_empty());
    first.is_some_and(|cell| cell.parse::<f64>().is_ok() || delimiter.number(cell).is_some())
}

/// A column's name without the unit in brackets after it, and the unit.
pub(super) fn name_and_unit(cell: &str) -> (&str, Option<&str>) {
    match cell.find(['[', '(']) {
        Some(at) => (cell[..at].trim(), Some(cell[at + 1..].trim_end_matches([']', ')', ' ']).trim())),
        None => (cell, None),
    }
}

/// Seconds in a unit of time; none if the unit is unknown.
pub(super) fn seconds(unit: &str) -> Option<f64> {
    match unit.trim_matches(['[', ']', '(', ')', ' ']).to_ascii_lowercase().as_str() {
        "s" | "sec" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "millisecond" | "milliseconds" => Some(1e-3),
        "us" | "\u{b5}s" | "\u{3bc}s" | "microseconds" => Some(1e-6),
        "min" | "minute" | "minutes" => Some(60.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_are_decimal_where_they_part_nothing() {
        assert_eq!(Delimiter::Semicolon.number("1,5"), Some(1.5));
        assert_eq!(Delimiter::Tab.number("-1,5e-3"), Some(-1.5e-3));
        assert_eq!(Delimiter::Comma.number("1,5"), None);
        assert_eq!(Delimiter::Semicolon.number("1.000,5"), None);
        assert_eq!(Delimiter::of_row("1,5;2,5"), Delimiter::Semicolon);
    }

    #[test]
    fn units_stand_in_brackets() {
        assert_eq!(name_and_unit("time [ms]"), ("time", Some("ms")));
        assert_eq!(name_and_unit("HRR (kW)"), ("HRR", Some("kW")));
        assert_eq!(name_and_unit("flux"), ("flux", None));
        assert_eq!(seconds("[ms]"), Some(1e-3));
        assert_eq!(seconds("kW"), None);
    }
}
