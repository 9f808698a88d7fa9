//! Numbers in the names of frames, and the steps that they represent.

mod pattern;
pub(super) mod subframes;

pub use pattern::Pattern;

/// Largest number of sub-frames per frame that is recognised from digits.
const MOST_SUBFRAMES: i64 = 64;

/// Number of frames from which a stride is assumed: with two frames, it could be a gap.
const LEAST_STRIDDEN: usize = 3;

/// A frame number in a file name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Number {
    pub whole: i64,
    /// Digits after the point of a sub-frame, as written: `25` in `1.25`.
    pub fraction: String,
    /// True if a minus sign precedes it; the whole part of -0.5 does not show it.
    pub is_negative: bool,
}

impl Number {
    /// The digits after the point as a fraction of a frame, 0-1.
    fn share(&self) -> f64 {
        format!("0.{}", self.fraction).parse().unwrap_or(0.0)
    }

    /// True if the digits after the point, which may be rounded or truncated, can represent a multiple of 1/`parts`.
    fn fits(&self, parts: i64) -> bool {
        let share = self.share();
        if share == 0.0 {
            return true;
        }
        let places = i32::try_from(self.fraction.len()).unwrap_or(i32::MAX).min(15);
        let (scaled, tolerated) = (share * parts as f64, parts as f64 * maths::powi(10.0, -places));
        let nearest = scaled.round();
        (1.0..parts as f64).contains(&nearest) && (scaled - nearest).abs() <= tolerated
    }
}

/// The parts of a file name: before its number, the number, and after it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Name {
    pub before: String,
    pub number: Number,
    pub behind: String,
    /// The number as written, without its sign.
    digits: String,
}

impl Name {
    /// Splits a name (without its extension) at its last number. A minus belongs to the number unless it separates the
    /// number from a name: `fire.-5` is frame -5, `fire-5` frame 5.
    pub fn of_name(name: &str) -> Option<Self> {
        let end = name.rfind(|c: char| c.is_ascii_digit())? + 1;
        let (name, behind) = name.split_at(end);
        let unsigned = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let signed = unsigned.strip_suffix('-').filter(|before| !before.ends_with(char::is_alphanumeric));
        let before = signed.unwrap_or(unsigned);
        let whole = name.get(before.len()..)?.parse().ok()?;
        Some(Self {
            before: before.to_owned(),
            number: Number { whole, fraction: String::new(), is_negative: signed.is_some() },
            behind: behind.to_owned(),
            digits: name.get(unsigned.len()..)?.to_owned(),
        })
    }

    /// The same name read as that of a sub-frame (`fire.12.25` as frame 12.25), if possible.
    pub fn with_fraction(&self) -> Option<Self> {
        let before = self.before.strip_suffix('.').filter(|before| before.ends_with(|c: char| c.is_ascii_digit()))?;
        let whole = Self::of_name(before).filter(|_| !self.number.is_negative)?;
        let number = Number { fraction: self.digits.clone(), ..whole.number };
        Some(Self { number, behind: self.behind.clone(), ..whole })
    }

    /// Part of the name that all frames share.
    pub fn stem(&self) -> String {
        format!("{}{}", self.before, self.behind)
    }
}

/// Relation of the numbers in file names to the steps of a simulation.
///
/// Steps are consecutive integers. They equal the frame numbers if those are consecutive, too; with sub-frames there
/// are several steps per frame, and if only every second frame was written (on twos) there are fewer steps than frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbering {
    /// Frames from one step to the next.
    stride: i64,
    /// Steps per frame; 1 unless the stride is 1.
    subframes: i64,
    /// Number of step 0.
    rest: i64,
}

impl Default for Numbering {
    /// The numbering in which steps are frames.
    fn default() -> Self {
        Self { stride: 1, subframes: 1, rest: 0 }
    }
}

impl Numbering {
    /// The coarsest numbering in which every number is a step.
    pub(super) fn of_numbers<'a>(numbers: impl Iterator<Item = &'a Number> + Clone) -> Self {
        let fits = |parts: &i64| numbers.clone().all(|number| number.fits(*parts));
        let subframes = (1..=MOST_SUBFRAMES).find(fits).unwrap_or(MOST_SUBFRAMES);
        let plain = Self { stride: 1, subframes, rest: 0 };
        let mut steps: Vec<i64> = numbers.map(|number| plain.step(number)).collect();
        steps.sort_unstable();
        steps.dedup();
        let stride = steps.windows(2).fold(0, |stride, pair| gcd(stride, pair[1].abs_diff(pair[0])));
        match (i64::try_from(stride), steps.first()) {
            (Ok(stride @ 2..), Some(first)) if subframes == 1 && steps.len() >= LEAST_STRIDDEN => {
                Self { stride, subframes, rest: first.rem_euclid(stride) }
            }
            _ => plain,
        }
    }

    /// Frames from one step to the next, steps per frame, and the number of step 0: the values to store.
    pub fn parts(&self) -> [i64; 3] {
        [self.stride, self.subframes, self.rest]
    }

    /// Inverse of [`parts`](Self::parts); none if they make no sense.
    pub fn of_parts([stride, subframes, rest]: [i64; 3]) -> Option<Self> {
        let is_sane = stride >= 1 && (1..=MOST_SUBFRAMES).contains(&subframes) && (0..stride).contains(&rest);
        is_sane.then_some(Self { stride, subframes, rest })
    }

    /// The step of a number.
    pub(super) fn step(&self, number: &Number) -> i64 {
        let share = (number.share() * self.subframes as f64).round() as i64;
        let share = if number.is_negative { -share } else { share };
        number
            .whole
            .saturating_mul(self.subframes)
            .saturating_add(share)
            .saturating_sub(self.rest)
            .div_euclid(self.stride)
    }

    /// The first step at or after the start of a frame.
    pub fn step_from(&self, frame: i64) -> i64 {
        let from = frame.saturating_sub(self.rest);
        let is_between = i64::from(from.rem_euclid(self.stride) != 0);
        from.div_euclid(self.stride).saturating_add(is_between).saturating_mul(self.subframes)
    }

    /// The last step before the next frame starts.
    pub fn step_until(&self, frame: i64) -> i64 {
        self.step_from(frame.saturating_add(1)).saturating_sub(1)
    }

    /// The frame that a step belongs to.
    pub fn frame_of(&self, step: i64) -> i64 {
        step.saturating_mul(self.stride).saturating_add(self.rest).div_euclid(self.subframes)
    }

    /// The number of a step: 1001, 12.25.
    pub fn number(&self, step: i64) -> f64 {
        (step as f64 * self.stride as f64 + self.rest as f64) / self.subframes as f64
    }

    /// Steps per frame: 4 for quarter frames, 0.5 on twos.
    pub fn steps_per_frame(&self) -> f64 {
        self.subframes as f64 / self.stride as f64
    }

    /// True if steps are frames.
    pub fn is_plain(&self) -> bool {
        self.stride == 1 && self.subframes == 1
    }

    /// The number of a step as a file names it: `1001`, `12.25`.
    pub fn label(&self, step: i64) -> String {
        if self.subframes == 1 {
            return step.saturating_mul(self.stride).saturating_add(self.rest).to_string();
        }
        let number = format!("{:.4}", step as f64 / self.subframes as f64);
        number.trim_end_matches('0').trim_end_matches('.').to_owned()
    }
}

impl std::fmt::Display for Numbering {
    /// Describes a numbering that is not plain: `4 steps per frame`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.stride, self.subframes) {
            (1, 1) => write!(f, "one step per frame"),
            (1, parts) => write!(f, "{parts} steps per frame"),
            (stride, _) => write!(f, "one step every {stride} frames"),
        }
    }
}

fn gcd(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn number(text: &str) -> Number {
        let (whole, fraction) = text.split_once('.').unwrap_or((text, ""));
        Number { whole: whole.parse().unwrap(), fraction: fraction.into(), is_negative: text.starts_with('-') }
    }

    fn steps(numbers: &[&str]) -> (Numbering, Vec<i64>, Vec<String>) {
        let numbers: Vec<Number> = numbers.iter().map(|text| number(text)).collect();
        let numbering = Numbering::of_numbers(numbers.iter());
        let steps: Vec<i64> = numbers.iter().map(|number| numbering.step(number)).collect();
        let labels = steps.iter().map(|step| numbering.label(*step)).collect();
        (numbering, steps, labels)
    }

    #[test]
    fn names_are_parted_from_their_numbers() {
        for (name, expected) in [
            ("fire.0007", Some(("fire.", 7, ""))),
            ("fire.-5", Some(("fire.", -5, ""))),
            ("fire-5", Some(("fire-", 5, ""))),
            ("-5", Some(("", -5, ""))),
            ("fire.0001_cache", Some(("fire.", 1, "_cache"))),
            ("fire_v002.0010", Some(("fire_v002.", 10, ""))),
            ("fire.-", None),
            ("fire", None),
            ("a_99999999999999999999", None),
        ] {
            let found = Name::of_name(name);
            let found = found.as_ref().map(|name| (name.before.as_str(), name.number.whole, name.behind.as_str()));
            assert_eq!(found, expected, "{name}");
        }
    }

    #[test]
    fn subframes_are_told_from_their_digits() {
        let (numbering, found, labels) = steps(&["1", "1.25", "1.5", "1.75", "2"]);
        assert_eq!((numbering.steps_per_frame(), found), (4.0, vec![4, 5, 6, 7, 8]));
        assert_eq!(labels, ["1", "1.25", "1.5", "1.75", "2"]);
        assert_eq!((numbering.step_from(1), numbering.step_until(1)), (4, 7));
        assert_eq!(steps(&["1.333", "1.667", "2.000"]).1, [4, 5, 6], "rounded");
        assert_eq!(steps(&["1.33", "1.66", "2.00"]).1, [4, 5, 6], "cut off");
        assert_eq!(steps(&["-1.5", "-1", "-0.5", "0"]).1, [-3, -2, -1, 0]);
    }

    #[test]
    fn a_constant_stride_is_one_step() {
        let (numbering, found, labels) = steps(&["1001", "1003", "1007"]);
        assert_eq!((numbering.steps_per_frame(), found), (0.5, vec![500, 501, 503]));
        assert_eq!(labels, ["1001", "1003", "1007"]);
        assert_eq!((numbering.step_from(1002), numbering.step_until(1004)), (501, 501));
        assert_eq!(steps(&["1", "3"]).1, [1, 3], "of two frames nobody can tell");
        assert_eq!(steps(&["-5", "-3", "-1"]).2, ["-5", "-3", "-1"]);
        assert!(steps(&["1", "2", "4"]).0.is_plain());
    }
}
