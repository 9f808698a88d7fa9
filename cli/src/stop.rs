//! Signals that stop the work.
//!
//! The handler only records the signal's number, so that the work ends at its next step and leaves no half-written
//! file. The process then ends by that signal after all: a shell loop stops only if its child was killed by the signal,
//! not if it exited.

use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::error::Error;

/// The signal that Ctrl-C sends.
#[cfg(not(unix))]
const INTERRUPT: usize = 2;

/// The signal that has arrived, if any.
#[derive(Clone)]
pub struct Stop {
    /// Its number; 0 for none.
    signal: Arc<AtomicUsize>,
}

impl Stop {
    /// Starts listening: for Ctrl-C, for the signals of `kill` and batch systems, and for a terminal that closes.
    pub fn listen() -> Result<Self, Error> {
        let signal = Arc::new(AtomicUsize::new(0));
        #[cfg(unix)]
        {
            use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
            let hang_up = Some(SIGHUP).filter(|_| !is_ignored(SIGHUP));
            for number in [SIGINT, SIGTERM].into_iter().chain(hang_up) {
                signal_hook::flag::register_usize(number, Arc::clone(&signal), number as usize)?;
            }
        }
        #[cfg(not(unix))]
        {
            let signal = Arc::clone(&signal);
            ctrlc::set_handler(move || signal.store(INTERRUPT, Ordering::Relaxed)).map_err(std::io::Error::other)?;
        }
        Ok(Self { signal })
    }

    /// True if a signal has arrived.
    pub fn has_come(&self) -> bool {
        self.number() != 0
    }

    /// Ends the process as the signal would have, if one has arrived; otherwise does nothing.
    pub fn end_by_signal(&self) -> Option<ExitCode> {
        let number = u8::try_from(self.number()).ok().filter(|number| *number != 0)?;
        #[cfg(unix)]
        let _ = signal_hook::low_level::emulate_default_handler(i32::from(number));
        // Systems without signals have the number alone, as shells report it.
        Some(ExitCode::from(128 + number))
    }

    fn number(&self) -> usize {
        self.signal.load(Ordering::Relaxed)
    }
}

/// True if the program was started with a signal ignored, as by `nohup` for work that should outlive its terminal.
/// Detectable on Linux only.
#[cfg(unix)]
fn is_ignored(number: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.is_some_and(|mask| mask >> (number - 1) & 1 == 1)
}
