//! Progress on a terminal, and Ctrl-C.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use indicatif::{ProgressBar, ProgressStyle};

use crate::error::Error;

/// Steps of a bar.
const STEPS: u64 = 1000;

/// The running command, as its user sees and stops it.
pub struct Work {
    stopped: Arc<AtomicBool>,
}

impl Work {
    /// Begins to listen for Ctrl-C; from now on it stops the work at the next step instead of
    /// killing the process, so that no half-written file is left.
    pub fn start() -> Result<Self, Error> {
        let stopped = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&stopped);
        ctrlc::set_handler(move || flag.store(true, Ordering::Relaxed))?;
        Ok(Self { stopped })
    }

    /// A named part of the work. Shows a bar where standard error is a terminal, nothing elsewhere.
    pub fn stage(&self, name: &'static str) -> Stage<'_> {
        let bar = ProgressBar::new(STEPS);
        if let Ok(style) = ProgressStyle::with_template("{msg:>12} {wide_bar} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        bar.set_message(name);
        Stage { bar, work: self }
    }

    /// Fails where Ctrl-C was pressed.
    pub fn check(&self) -> Result<(), Error> {
        if self.stopped.load(Ordering::Relaxed) { Err(Error::Cancelled) } else { Ok(()) }
    }
}

/// One bar; it goes away with its part of the work.
pub struct Stage<'a> {
    bar: ProgressBar,
    work: &'a Work,
}

impl Stage<'_> {
    /// Shows how much is done (0-1); answers whether to go on.
    pub fn at(&self, done: f32) -> bool {
        self.bar.set_position((f64::from(done.clamp(0.0, 1.0)) * STEPS as f64) as u64);
        self.work.check().is_ok()
    }
}

impl Drop for Stage<'_> {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Says something that the user should know but that does not end the work.
pub fn note(message: &str) {
    eprintln!("note: {message}");
}
