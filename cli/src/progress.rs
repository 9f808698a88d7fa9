//! Progress: a bar on a terminal, occasional lines elsewhere, nothing with `--quiet`.

mod lines;

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use self::lines::Lines;
use crate::args::Progress;
use crate::error::Error;
use crate::notes::is_quiet;
use crate::stop::Stop;

pub use crate::notes::note;

/// Resolution of a bar in steps.
const STEPS: u64 = 1000;

/// The running command, with its progress display and its stop signal.
pub struct Work {
    stop: Stop,
    progress: Progress,
}

impl Work {
    /// Creates work that stops when `stop` receives a signal.
    pub fn new(stop: Stop, progress: Progress) -> Self {
        Self { stop, progress }
    }

    /// Starts a named stage of the work.
    pub fn stage(&self, name: &'static str) -> Stage<'_> {
        let shown = match (is_quiet(), std::io::stderr().is_terminal()) {
            (false, _) if self.progress == Progress::Openjd => Shown::Lines(Lines::for_openjd()),
            (true, _) => Shown::Nothing,
            (false, true) => Shown::Bar(bar(name)),
            (false, false) => Shown::Lines(Lines::new(name)),
        };
        Stage { shown, work: self }
    }

    /// Fails if the user or the system has stopped the work.
    pub fn check(&self) -> Result<(), Error> {
        if self.stop.has_come() { Err(Error::Cancelled) } else { Ok(()) }
    }
}

fn bar(name: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(STEPS);
    if let Ok(style) = ProgressStyle::with_template("{msg:>12} {wide_bar} {percent:>3} % {eta:>4}") {
        bar.set_style(style);
    }
    bar.set_message(name);
    bar
}

/// A stage of the work; its bar disappears when it ends.
pub struct Stage<'a> {
    shown: Shown,
    work: &'a Work,
}

enum Shown {
    Bar(ProgressBar),
    Lines(Lines),
    Nothing,
}

impl Stage<'_> {
    /// Shows the finished share (0-1); returns whether to continue.
    pub fn report(&self, done: f32) -> bool {
        match &self.shown {
            Shown::Bar(bar) => bar.set_position((f64::from(done.clamp(0.0, 1.0)) * STEPS as f64) as u64),
            Shown::Lines(lines) => lines.report(done),
            Shown::Nothing => {}
        }
        self.work.check().is_ok()
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        if let Shown::Bar(bar) = &self.shown {
            bar.finish_and_clear();
        }
    }
}
