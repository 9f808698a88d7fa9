//! Names with a placeholder for the frame number: `fire_v002.####.vdb`, `%04d`, `$F4`.

use super::{Name, Number};

/// A file name with a placeholder for the frame number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Pattern {
    before: String,
    behind: String,
}

impl Pattern {
    /// The pattern in a file name; none without a placeholder.
    pub fn of_file_name(file_name: &str) -> Option<Self> {
        let (start, end) = hashes(file_name).or_else(|| printf(file_name)).or_else(|| houdini(file_name))?;
        Some(Self { before: file_name.get(..start)?.to_owned(), behind: file_name.get(end..)?.to_owned() })
    }

    /// The name and number of a file that matches; padding is ignored.
    pub(in crate::import) fn name(&self, file_name: &str) -> Option<Name> {
        let number = file_name.strip_prefix(&self.before)?.strip_suffix(&self.behind)?;
        let unsigned = number.strip_prefix('-').unwrap_or(number);
        let (digits, fraction) = unsigned.split_once('.').unwrap_or((unsigned, ""));
        if ![digits, fraction].iter().all(|part| part.bytes().all(|byte| byte.is_ascii_digit())) {
            return None;
        }
        let is_negative = number.starts_with('-');
        let whole: i64 = digits.parse().ok()?;
        let whole = if is_negative { -whole } else { whole };
        let behind = self.behind.rsplit_once('.').map_or("", |(behind, _)| behind).to_owned();
        let number = Number { whole, fraction: fraction.to_owned(), is_negative };
        Some(Name { before: self.before.clone(), number, behind, digits: digits.to_owned() })
    }
}

/// Finds `####`, with one hash per digit.
fn hashes(name: &str) -> Option<(usize, usize)> {
    let start = name.find('#')?;
    let count = name.bytes().skip(start).take_while(|byte| *byte == b'#').count();
    Some((start, start + count))
}

/// Finds `%d`, `%04d`.
fn printf(name: &str) -> Option<(usize, usize)> {
    let start = name.find('%')?;
    let digits = name.bytes().skip(start + 1).take_while(u8::is_ascii_digit).count();
    let end = start + 1 + digits;
    (name.as_bytes().get(end) == Some(&b'd')).then_some((start, end + 1))
}

/// Finds `$F`, `$F4`, `${F4}`, and `$FF` for sub-frames.
fn houdini(name: &str) -> Option<(usize, usize)> {
    let (start, opening) = name.find("${F").map(|at| (at, 3)).or_else(|| name.find("$F").map(|at| (at, 2)))?;
    let rest = name.get(start + opening..)?;
    let rest = rest.strip_prefix('F').unwrap_or(rest);
    let rest = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    let rest = if opening == 3 { rest.strip_prefix('}')? } else { rest };
    Some((start, name.len() - rest.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_for_numbers_are_found() {
        for pattern in ["fire_v2.####.vdb", "fire_v2.#.vdb", "fire_v2.%04d.vdb", "fire_v2.%d.vdb", "fire_v2.$F4.vdb"]
            .into_iter()
            .chain(["fire_v2.$F.vdb", "fire_v2.${F4}.vdb", "fire_v2.$FF.vdb"])
        {
            let found = Pattern::of_file_name(pattern).unwrap_or_else(|| panic!("{pattern}"));
            assert_eq!((found.before.as_str(), found.behind.as_str()), ("fire_v2.", ".vdb"), "{pattern}");
            let number = |name: &str| found.name(name).map(|name| (name.number.whole, name.number.fraction));
            assert_eq!(number("fire_v2.0012.vdb"), Some((12, String::new())));
            assert_eq!(number("fire_v2.-3.5.vdb"), Some((-3, "5".into())));
            assert_eq!(number("fire_v3.0012.vdb"), None);
            assert_eq!(number("fire_v2.a.vdb"), None);
            assert_eq!(number("fire_v2..vdb"), None);
        }
        for name in ["fire.0001.vdb", "100%.vdb", "cash$.vdb", "${F.vdb"] {
            assert_eq!(Pattern::of_file_name(name), None, "{name}");
        }
    }
}
