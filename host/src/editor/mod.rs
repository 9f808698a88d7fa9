//! An editor in its own window, for screenshots and for driving it with the mouse.
//!
//! | module | contents |
//! |---|---|
//! | `x11` | the window on Linux |
//! | `win32` | the window on Windows |
//! | `none` | other systems: no window yet |

#[cfg(target_os = "linux")]
#[path = "x11.rs"]
mod native;
#[cfg(target_os = "windows")]
#[path = "win32.rs"]
mod native;
#[cfg(not(any(target_os = "linux", target_os = "windows")))]
#[path = "none.rs"]
mod native;

use std::thread;
use std::time::{Duration, Instant};

use crate::{HostError, Plugin};
use native::NativeWindow;

/// Between two rounds of callbacks: about as often as a screen draws.
const FRAME: Duration = Duration::from_millis(16);

/// A plugin's editor, embedded in a window. Close it before the plugin goes.
pub struct EditorWindow {
    window: NativeWindow,
    size: (u32, u32),
}

impl EditorWindow {
    /// Opens a window with this title, on Linux on the display that `DISPLAY` names, and the plugin's editor in it.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when there is no display or the plugin has no editor for it.
    pub fn open(plugin: &mut dyn Plugin, title: &str) -> Result<Self, HostError> {
        let window = NativeWindow::new(title).map_err(no_window)?;
        let size = plugin.open_editor(window.id())?;
        let mut opened = Self { window, size };
        opened.fit(size)?;
        Ok(opened)
    }

    /// The system's number of the window, as used by `import -window` and `xdotool`.
    #[must_use]
    pub fn id(&self) -> u32 {
        self.window.id()
    }

    /// Width and height in pixels.
    #[must_use]
    pub const fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Resizes editor and window to the nearest size in pixels that the editor accepts.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if the editor does not resize, or the display is gone.
    pub fn resize(&mut self, plugin: &mut dyn Plugin, size: (u32, u32)) -> Result<(), HostError> {
        let size = plugin.resize_editor(size)?;
        self.fit(size)
    }

    /// Sets the number of pixels per point on this screen, as hosts do, and gives the window the editor's resulting
    /// size.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if the editor does not support it, or the display is gone.
    pub fn scale(&mut self, plugin: &mut dyn Plugin, scale: f64) -> Result<(), HostError> {
        let size = plugin.scale_editor(scale)?;
        self.fit(size)
    }

    /// Gives the window the editor's size.
    fn fit(&mut self, size: (u32, u32)) -> Result<(), HostError> {
        self.window.fit(size).map_err(no_window)?;
        self.size = size;
        Ok(())
    }

    /// Keeps the editor running for this long, with the plug-in's callbacks and the sizes that it requests.
    pub fn run_for(&mut self, plugin: &mut dyn Plugin, duration: Duration) {
        let end = Instant::now() + duration;
        while Instant::now() < end {
            let _ = plugin.run_callbacks();
            if let Some(size) = plugin.take_wanted_editor_size() {
                // If the editor rejects its own request, or the display is gone, nothing changes.
                let _ = self.resize(plugin, size);
            }
            self.window.handle_events();
            thread::sleep(FRAME);
        }
    }

    /// Raises the window above all others.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if the display is gone.
    pub fn raise(&self) -> Result<(), HostError> {
        self.window.raise().map_err(no_window)
    }

    /// Destroys the window under its editor, as a host may in the wrong order. The editor must still be closed.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] if the display is gone.
    pub fn destroy_window(&self) -> Result<(), HostError> {
        self.window.destroy().map_err(no_window)
    }

    /// Closes editor and window.
    pub fn close(self, plugin: &mut dyn Plugin) {
        plugin.close_editor();
        // Anything left disappears with the connection, or with the process.
        let _ = self.window.destroy();
    }
}

fn no_window(error: impl std::fmt::Display) -> HostError {
    HostError::Unsupported(format!("no window can be opened: {error}"))
}
