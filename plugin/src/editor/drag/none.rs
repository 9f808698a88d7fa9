//! No dragging out of the window: its event loop belongs to the window library, which has no access to it.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use raw_window_handle::HasWindowHandle;

use super::Outcome;

/// A window to drag from; there is none.
pub enum Native {}

impl Native {
    /// None.
    pub fn of(_window: &impl HasWindowHandle) -> Option<Self> {
        None
    }

    /// What drags an existing file.
    pub fn drag(&self, _path: PathBuf, _is_called_off: Arc<AtomicBool>) -> fn() -> Outcome {
        match *self {}
    }
}
