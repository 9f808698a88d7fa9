//! No dropped files: the window library passes none on, and nothing here takes its place.

use std::path::PathBuf;

use nice_plug_egui::RepaintNotifier;
use raw_window_handle::HasWindowHandle;

/// Receiver of files dropped on a window; there is none.
pub enum DropTarget {}

impl DropTarget {
    /// None.
    pub fn open(_window: &impl HasWindowHandle, _notifier: RepaintNotifier) -> Option<Self> {
        None
    }

    /// True if a file is held over the window.
    pub fn is_hovered(&self) -> bool {
        match *self {}
    }

    /// A file that was dropped.
    pub fn poll(&mut self) -> Option<PathBuf> {
        match *self {}
    }
}
