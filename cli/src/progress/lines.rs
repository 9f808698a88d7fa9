//! Progress for logs: plain lines, few of them.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Shortest time between two lines; shorter work leaves none.
const APART: Duration = Duration::from_secs(2);
/// Percent between two lines, ...
const APART_PERCENT: u8 = 10;
/// ... unless this much time has passed, so that a long run is distinguishable from one that hangs.
const LONG: Duration = Duration::from_secs(60);

/// The lines of one stage of the work, whichever threads report its progress.
pub struct Lines {
    /// Text before and after the percentage.
    around: (&'static str, &'static str),
    last: Mutex<Last>,
}

/// The most recent line.
struct Last {
    time: Instant,
    percent: u8,
}

impl Lines {
    pub fn new(name: &'static str) -> Self {
        Self::around((name, " %"))
    }

    /// Lines in the format of Open Job Description, `openjd_progress: 42`.
    pub fn for_openjd() -> Self {
        Self::around(("openjd_progress", ""))
    }

    fn around(around: (&'static str, &'static str)) -> Self {
        Self { around, last: Mutex::new(Last { time: Instant::now(), percent: 0 }) }
    }

    /// Writes a line if one is due, for the finished share (0-1).
    pub fn report(&self, done: f32) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(percent) = last.due(Instant::now(), done) {
            let (name, unit) = self.around;
            eprintln!("{name}: {percent}{unit}");
        }
    }
}

impl Last {
    fn due(&mut self, now: Instant, done: f32) -> Option<u8> {
        let percent = (100.0 * done.clamp(0.0, 1.0)) as u8;
        let more = percent.saturating_sub(self.percent);
        let passed = now.saturating_duration_since(self.time);
        let is_due = passed >= APART && more >= APART_PERCENT || passed >= LONG && more > 0;
        is_due.then(|| {
            *self = Self { time: now, percent };
            percent
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Percents told at even progress over so many seconds, looked at a hundred times a second.
    fn percents(seconds: u32) -> Vec<u8> {
        let start = Instant::now();
        let mut last = Last { time: start, percent: 0 };
        let looks = 100 * seconds;
        let look = |n: u32| last.due(start + Duration::from_millis(10 * u64::from(n)), n as f32 / looks as f32);
        (1..=looks).filter_map(look).collect()
    }

    #[test]
    fn short_work_leaves_no_line_in_a_log() {
        assert!(percents(1).is_empty());
    }

    #[test]
    fn lines_are_two_seconds_and_ten_percent_apart() {
        assert_eq!(percents(10), [20, 40, 60, 80, 100]);
        assert_eq!(percents(200), [10, 20, 30, 40, 50, 60, 70, 80, 90, 100]);
    }

    #[test]
    fn long_work_is_reported_each_minute() {
        assert!((95..=100).contains(&percents(6000).len()), "one percent a minute");
        assert!((45..=100).contains(&percents(12_000).len()));
    }
}
