//! Dragging a sound out of the window under X11: a source of XDND 5 on a separate connection and thread. The window
//! itself holds the pointer grab, so pointer and buttons are polled instead.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use x11rb::protocol::xproto::Window;

use super::Outcome;
use super::xdnd::Drag;

/// The window that is dragged from.
pub struct Native(Window);

impl Native {
    /// This window; none without an X server.
    pub fn of(window: &impl HasWindowHandle) -> Option<Self> {
        match window.window_handle().ok()?.as_raw() {
            RawWindowHandle::Xlib(handle) => Some(Self(u32::try_from(handle.window).ok()?)),
            RawWindowHandle::Xcb(handle) => Some(Self(handle.window.get())),
            _ => None,
        }
    }

    /// What drags an existing file, on any thread, until the button is released.
    pub fn drag(&self, path: PathBuf, is_called_off: Arc<AtomicBool>) -> impl FnOnce() -> Outcome + Send + use<> {
        let editor = self.0;
        move || {
            let taken = Drag::begin(editor, &path).and_then(|mut drag| drag.run(&is_called_off));
            taken.map_or_else(|error| Outcome::Failed(error.to_string()), |is_taken| Outcome::of(is_taken, path))
        }
    }
}
