//! Film time in options: frame rates and timecode.

use crate::error::Error;

/// Ratio of television frame rates to the whole ones: 1000/1001.
const PULLED: f64 = 1000.0 / 1001.0;

/// Relative tolerance for recognising those rates: 23.976 and 23.98 are both 24000/1001.
const SAME_RATE: f64 = 2e-4;

/// Frames of film per second, as a fraction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FilmRate {
    frames: u32,
    seconds: u32,
}

impl FilmRate {
    /// Reads `24`, `24000/1001`, `23.976`; the error says what is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| format!("'{text}' is not a number"));
        let rate_hz = match text.split_once('/') {
            Some((frames, seconds)) => number(frames)? / number(seconds)?,
            None => number(text)?,
        };
        if !(1.0..=1000.0).contains(&rate_hz) {
            return Err(format!("a film rate of {rate_hz} frames per second is out of range; choose 1 to 1000"));
        }
        let whole = rate_hz.round();
        let pulled = (rate_hz / PULLED).round();
        match (whole == rate_hz, (pulled * PULLED / rate_hz - 1.0).abs() < SAME_RATE) {
            (true, _) => Ok(Self { frames: whole as u32, seconds: 1 }),
            (false, true) => Ok(Self { frames: 1000 * pulled as u32, seconds: 1001 }),
            (false, false) => {
                Err(format!("{rate_hz} is not a film or television rate; write it as a fraction, as in 24000/1001"))
            }
        }
    }

    /// Frames per second.
    pub fn hz(self) -> f64 {
        f64::from(self.frames) / f64::from(self.seconds)
    }

    /// Frames that timecode counts per second.
    fn nominal(self) -> u64 {
        u64::from(self.frames.div_ceil(self.seconds))
    }
}

impl std::fmt::Display for FilmRate {
    /// Formats as in iXML: `24000/1001`, `24/1`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.frames, self.seconds)
    }
}

/// A timecode, such as `01:02:03:04`; a semicolon before the frames marks drop-frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timecode {
    /// Hours, minutes, seconds, frames.
    parts: [u64; 4],
    /// True if frame numbers are dropped to keep up with the clock (30000/1001 and 60000/1001).
    pub is_drop: bool,
}

impl Timecode {
    /// Reads a timecode; the error says what is wrong.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is not a timecode such as 01:00:00:00");
        let parts: Option<Vec<u64>> = text.split([':', ';']).map(|part| part.parse().ok()).collect();
        let parts: [u64; 4] = parts.and_then(|parts| parts.try_into().ok()).ok_or_else(wrong)?;
        if parts[0] > 23 || parts[1] > 59 || parts[2] > 59 {
            return Err(wrong());
        }
        Ok(Self { parts, is_drop: text.contains(';') })
    }

    /// Seconds since midnight, in film that runs at `rate`.
    ///
    /// Fails if the rate has no such frame.
    pub fn seconds(self, rate: FilmRate) -> Result<f64, Error> {
        let [hours, minutes, seconds, frames] = self.parts;
        let nominal = rate.nominal();
        if frames >= nominal {
            let message = format!(
                "--timecode has frame {frames}, but at {rate} frames per second the highest is {}",
                nominal - 1
            );
            return Err(Error::Conflict(message));
        }
        if self.is_drop && !(rate.seconds == 1001 && nominal.is_multiple_of(30)) {
            let message = format!(
                "--timecode is drop-frame, which does not exist at {rate} frames per second; write a colon before the frames"
            );
            return Err(Error::Conflict(message));
        }
        let all_minutes = 60 * hours + minutes;
        // Two numbers (at 60, four) are left out every minute but every tenth.
        let dropped = if self.is_drop { nominal / 15 * (all_minutes - all_minutes / 10) } else { 0 };
        let count = (60 * all_minutes + seconds) * nominal + frames;
        Ok(count.saturating_sub(dropped) as f64 / rate.hz())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn film_rates_are_fractions() {
        for (text, expected) in [
            ("24", "24/1"),
            ("23.976", "24000/1001"),
            ("23.98", "24000/1001"),
            ("24000/1001", "24000/1001"),
            ("29.97", "30000/1001"),
        ] {
            assert_eq!(FilmRate::parse(text).unwrap().to_string(), expected, "{text}");
        }
        for text in ["0", "x", "24.5", "1/0", "nan"] {
            assert!(FilmRate::parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn timecode_counts_frames_since_midnight() {
        let seconds = |timecode: &str, rate: &str| {
            Timecode::parse(timecode)
                .unwrap()
                .seconds(FilmRate::parse(rate).unwrap())
                .map_err(|error| error.to_string())
        };
        assert_eq!(seconds("01:00:00:12", "24"), Ok(3600.5));
        assert!((seconds("01:00:00:00", "24000/1001").unwrap() - 3603.6).abs() < 1e-9);
        // Drop-frame timecode keeps up with the clock (SMPTE ST 12-1): an hour is off by 3.6 ms.
        assert!((seconds("01:00:00;00", "29.97").unwrap() - 3600.0).abs() < 0.004);
        assert!((seconds("00:01:00;02", "29.97").unwrap() - 1800.0 * 1001.0 / 30000.0).abs() < 1e-9);
        assert!(seconds("00:00:00:24", "24").unwrap_err().contains("23"));
        assert!(seconds("00:00:00;02", "24").unwrap_err().contains("colon"));
        for text in ["1:2:3", "24:00:00:00", "00:60:00:00", "a:b:c:d"] {
            assert!(Timecode::parse(text).is_err(), "{text}");
        }
    }
}
