//! Files dropped on the window.
//!
//! | module | contents |
//! |---|---|
//! | `x11` | an invisible window that accepts them for the editor's, on Linux |
//! | `win32` | a target in place of the window library's, on Windows |
//! | `none` | other systems: dropped files never arrive |

#[cfg(not(any(target_os = "linux", target_os = "windows")))]
#[path = "none.rs"]
mod native;
#[cfg(target_os = "windows")]
#[path = "win32.rs"]
mod native;
#[cfg(target_os = "linux")]
#[path = "x11.rs"]
mod native;

pub use native::DropTarget;
