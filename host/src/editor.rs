//! An editor in a window of its own, for screenshots and for driving it with the mouse.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    ConfigureWindowAux, ConnectionExt, CreateWindowAux, EventMask, PropMode, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

use crate::{HostError, Plugin};

/// Between two rounds of callbacks: about as often as a screen draws.
const FRAME: Duration = Duration::from_millis(16);

/// A plugin's editor, embedded in an X11 window. Close it before the plugin goes.
pub struct EditorWindow {
    connection: RustConnection,
    window: Window,
    size: (u32, u32),
}

impl EditorWindow {
    /// Opens a window with this title on the display that `DISPLAY` names, and the plugin's editor in it.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when there is no display or the plugin has no editor for it.
    pub fn open(plugin: &mut dyn Plugin, title: &str) -> Result<Self, HostError> {
        let (connection, screen) = x11rb::connect(None).map_err(no_display)?;
        let window = create_window(&connection, screen, title).map_err(no_display)?;
        let size = plugin.open_editor(window)?;
        let fit = ConfigureWindowAux::new().width(size.0).height(size.1);
        connection.configure_window(window, &fit).map_err(no_display)?;
        connection.sync().map_err(no_display)?;
        Ok(Self { connection, window, size })
    }

    /// The X11 id of the window, as `import -window` and `xdotool` take it.
    #[must_use]
    pub const fn id(&self) -> u32 {
        self.window
    }

    /// Width and height in pixels.
    #[must_use]
    pub const fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Lets the editor live for this long, running the plugin's callbacks.
    pub fn run_for(&self, plugin: &mut dyn Plugin, duration: Duration) {
        let end = Instant::now() + duration;
        while Instant::now() < end {
            let _ = plugin.run_callbacks();
            while matches!(self.connection.poll_for_event(), Ok(Some(_))) {}
            thread::sleep(FRAME);
        }
    }

    /// Closes editor and window.
    pub fn close(self, plugin: &mut dyn Plugin) {
        plugin.close_editor();
        // The connection ends with `self`, and the server then removes what is left.
        let _ = self.connection.destroy_window(self.window);
        let _ = self.connection.flush();
    }
}

fn create_window(
    connection: &RustConnection,
    screen: usize,
    title: &str,
) -> Result<Window, Box<dyn std::error::Error>> {
    let screen = &connection.setup().roots[screen];
    let window = connection.generate_id()?;
    connection.create_window(
        x11rb::COPY_DEPTH_FROM_PARENT,
        window,
        screen.root,
        0,
        0,
        800,
        600,
        0,
        WindowClass::INPUT_OUTPUT,
        0,
        &CreateWindowAux::new().background_pixel(screen.black_pixel).event_mask(EventMask::STRUCTURE_NOTIFY),
    )?;
    connection.change_property8(
        PropMode::REPLACE,
        window,
        x11rb::protocol::xproto::AtomEnum::WM_NAME,
        x11rb::protocol::xproto::AtomEnum::STRING,
        title.as_bytes(),
    )?;
    connection.map_window(window)?;
    connection.sync()?;
    Ok(window)
}

fn no_display(error: impl std::fmt::Display) -> HostError {
    HostError::Unsupported(format!("no X11 window can be opened: {error}"))
}
