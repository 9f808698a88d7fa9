//! Dragging a sound out of the window, onto another program's timeline or into a folder.
//!
//! | module | contents |
//! |---|---|
//! | `x11` | a source on a separate connection and thread, on Linux, and its protocol `xdnd` |
//! | `win32` | a source in the window's own event loop, on Windows |
//! | `none` | other systems: sounds are saved, and dragged from the system's file browser |

#[cfg(not(any(target_os = "linux", target_os = "windows")))]
#[path = "none.rs"]
mod native;
#[cfg(target_os = "windows")]
#[path = "win32.rs"]
mod native;
#[cfg(target_os = "linux")]
#[path = "x11.rs"]
mod native;
#[cfg(target_os = "linux")]
mod xdnd;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use native::Native;
use raw_window_handle::HasWindowHandle;

use super::task::Task;

#[cfg(target_os = "windows")]
pub use native::is_dragged_from;

/// Source of sounds dragged out of a window.
pub struct DragSource {
    native: Native,
    is_called_off: Arc<AtomicBool>,
    task: Option<Task<Outcome>>,
}

impl DragSource {
    /// A source for this window; none where dragging is not possible. To be called on the window's thread.
    pub fn of(window: &impl HasWindowHandle) -> Option<Self> {
        Some(Self { native: Native::of(window)?, is_called_off: Arc::default(), task: None })
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
        self.is_called_off = Arc::default();
        let drag = self.native.drag(path.clone(), self.is_called_off.clone());
        let work = move || match write(&path) {
            Ok(()) => drag(),
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

impl Outcome {
    #[cfg_attr(not(any(target_os = "linux", target_os = "windows")), expect(dead_code, reason = "nothing is dragged"))]
    fn of(is_taken: bool, path: PathBuf) -> Self {
        if is_taken { Self::Taken(path) } else { Self::Dropped }
    }
}
