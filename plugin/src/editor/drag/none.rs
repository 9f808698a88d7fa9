//! No dragging out of the window: its event loop belongs to the window library, which has no access to it.

use std::path::{Path, PathBuf};

use raw_window_handle::HasWindowHandle;

use super::Outcome;

/// Source of sounds dragged out of a window; there is none.
pub enum DragSource {}

impl DragSource {
    /// None.
    pub fn of(_window: &impl HasWindowHandle) -> Option<Self> {
        None
    }

    /// True if a drag is under way.
    pub fn is_busy(&self) -> bool {
        match *self {}
    }

    /// Drags the file that `write` creates.
    pub fn start(
        &mut self,
        _path: PathBuf,
        _write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
        _end: impl FnOnce() + Send + 'static,
    ) {
        match *self {}
    }

    /// The outcome of the last drag, once.
    pub fn poll(&mut self) -> Option<Outcome> {
        match *self {}
    }
}
