//! Dragging a sound out of the window under X11: a source of XDND 5 on a separate connection and thread. The window
//! itself holds the pointer grab, so pointer and buttons are polled instead.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use x11rb::protocol::xproto::Window;

use super::Outcome;
use super::xdnd::Drag;
use crate::editor::task::Task;

/// Source of sounds dragged out of a window.
pub struct DragSource {
    editor: Window,
    is_called_off: Arc<AtomicBool>,
    task: Option<Task<Outcome>>,
}

impl DragSource {
    /// A source for this window; none where dragging is not possible.
    pub fn of(window: &impl HasWindowHandle) -> Option<Self> {
        let editor = match window.window_handle().ok()?.as_raw() {
            RawWindowHandle::Xlib(handle) => u32::try_from(handle.window).ok()?,
            RawWindowHandle::Xcb(handle) => handle.window.get(),
            _ => return None,
        };
        Some(Self { editor, is_called_off: Arc::default(), task: None })
    }

    /// True if a drag is under way.
    pub fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    /// Drags the file that `write` creates, as long as the primary button is held; `end` is called when the drag is
    /// over.
    pub fn start(
        &mut self,
        path: PathBuf,
        write: impl FnOnce(&Path) -> Result<(), String> + Send + 'static,
        end: impl FnOnce() + Send + 'static,
    ) {
        let (editor, is_called_off) = (self.editor, Arc::new(AtomicBool::new(false)));
        self.is_called_off = is_called_off.clone();
        let work = move || match write(&path) {
            Ok(()) => Drag::begin(editor, &path)
                .and_then(|mut drag| drag.run(&is_called_off))
                .map_or_else(|error| Outcome::Failed(error.to_string()), |is_taken| Outcome::of(is_taken, path)),
            Err(message) => Outcome::Failed(message),
        };
        self.task = Task::start("pyrophone-drag", work, end);
    }

    /// The outcome of the last drag, once.
    pub fn poll(&mut self) -> Option<Outcome> {
        let outcome = self.task.as_mut()?.poll()?;
        self.task = None;
        Some(outcome)
    }
}

impl Drop for DragSource {
    fn drop(&mut self) {
        // The task is waited for.
        self.is_called_off.store(true, Ordering::Relaxed);
    }
}
