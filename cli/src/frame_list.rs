//! Lists of frames in the notation of render farms: `7`, `1-100`, `-5--1`, `1-8x2`, `1,5-9`.

use pyrophone_flame::import::Numbering;

/// A range of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Range {
    first: i64,
    last: i64,
    /// Stride in frames.
    every: u64,
}

/// Requested frames, by the numbers in their file names; a frame includes its sub-frames.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameList {
    ranges: Vec<Range>,
    text: String,
}

impl FrameList {
    /// Reads a list; the error says what is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        let ranges: Result<Vec<Range>, String> = text.split(',').map(range).collect();
        Ok(Self { ranges: ranges?, text: text.trim().to_owned() })
    }

    /// True if a step is requested.
    pub fn holds(&self, step: i64, numbering: &Numbering) -> bool {
        self.ranges.iter().any(|range| range.holds(step, numbering))
    }
}

impl std::fmt::Display for FrameList {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl Range {
    fn holds(self, step: i64, numbering: &Numbering) -> bool {
        if !(numbering.step_from(self.first)..=numbering.step_until(self.last)).contains(&step) {
            return false;
        }
        numbering.frame_of(step).abs_diff(self.first).is_multiple_of(self.every)
    }
}

fn range(text: &str) -> Result<Range, String> {
    let (text, every) = match text.split_once('x') {
        Some((range, every)) => (range, every.trim().parse().ok().filter(|every| *every > 0)),
        None => (text, Some(1)),
    };
    let every = every.ok_or_else(|| format!("'{text}x...' needs a whole number above 0 after the x, as in 1-8x2"))?;
    // The first minus sign separates the two numbers, unless it begins the first one.
    let parting = text.trim().char_indices().skip(1).find(|(_, c)| *c == '-');
    let text = text.trim();
    let (first, last) = parting.map_or((text, text), |(at, _)| (&text[..at], &text[at + 1..]));
    let number = |text: &str| text.trim().parse::<i64>().map_err(|_| format!("'{text}' is not a frame number"));
    match (number(first)?, number(last)?) {
        (first, last) if first <= last => Ok(Range { first, last, every }),
        _ => Err("the first frame must not come after the last".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frame_lists_are_read_as_farms_write_them() {
        let held = |text: &str| {
            let list = FrameList::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            (-9..12).filter(|step| list.holds(*step, &Numbering::default())).collect::<Vec<_>>()
        };
        assert_eq!(held("7"), [7]);
        assert_eq!(held("1-3"), [1, 2, 3]);
        assert_eq!(held("-5--3"), [-5, -4, -3]);
        assert_eq!(held("-1-1"), [-1, 0, 1]);
        assert_eq!(held("1-8x2"), [1, 3, 5, 7]);
        assert_eq!(held("1, 5-7"), [1, 5, 6, 7]);
        assert_eq!(held("-8--2x3,9"), [-8, -5, -2, 9]);
        for (text, says) in [("x", "'"), ("1-8x0", "1-8x2"), ("9-3", "first frame"), ("1,,2", "''"), ("a-b", "'a'")] {
            let error = FrameList::parse(text).unwrap_err();
            assert!(error.contains(says), "{text}: {error}");
        }
    }
}
