//! A queue between the main thread and the one that plays.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// The queue's contents, even after a panic elsewhere: it is only pushed to and drained, so a panic leaves it intact.
pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
