//! Notes to the user that do not end the work.
//!
//! A process runs one command, so there is one list of notes: they arise anywhere, and `--json` prints them all at the
//! end.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

static NOTES: Mutex<Vec<String>> = Mutex::new(Vec::new());
static IS_QUIET: AtomicBool = AtomicBool::new(false);

/// Silences notes on standard error from now on.
pub fn set_quiet() {
    IS_QUIET.store(true, Ordering::Relaxed);
}

/// True if only errors are printed.
pub fn is_quiet() -> bool {
    IS_QUIET.load(Ordering::Relaxed)
}

/// Prints something that the user should know, without ending the work.
pub fn note(message: &str) {
    if !is_quiet() {
        eprintln!("note: {message}");
    }
    NOTES.lock().unwrap_or_else(PoisonError::into_inner).push(message.to_owned());
}

/// Returns all notes so far and clears the list.
pub fn take_notes() -> Vec<String> {
    std::mem::take(&mut *NOTES.lock().unwrap_or_else(PoisonError::into_inner))
}
