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

use std::path::PathBuf;

pub use native::DragSource;
#[cfg(target_os = "windows")]
pub use native::is_dragged_from;

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
