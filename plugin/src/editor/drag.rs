//! Dragging a sound out of the window, onto another program's timeline or into a folder.
//!
//! Under X11 this is a source of XDND 5 on a separate connection and thread: the window itself holds the pointer grab,
//! so pointer and buttons are polled instead. Windows (`DoDragDrop`) and macOS (`NSDraggingSource`) need their source
//! in the window's own event loop, to which baseview 0.4.2 gives no access; there sounds are saved and dragged from the
//! system's file browser.

mod xdnd;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use raw_window_handle::{HasWindowHandle, RawWindowHandle};
use x11rb::protocol::xproto::Window;

use super::task::Task;
use xdnd::Drag;

/// Outcome of a drag.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// The target accepted the file.
    Taken(PathBuf),
    /// It was dropped where no target accepts it, or cancelled.
    Dropped,
    /// An error, in words.
    Failed(String),
}

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
                .map_or_else(|error| Outcome::Failed(error.to_string()), |taken| outcome(taken, path)),
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

fn outcome(is_taken: bool, path: PathBuf) -> Outcome {
    if is_taken { Outcome::Taken(path) } else { Outcome::Dropped }
}
