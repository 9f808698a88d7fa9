//! An editor in a window of its own, for screenshots and for driving it with the mouse.

use std::thread;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    ConfigureWindowAux, ConnectionExt, CreateWindowAux, EventMask, PropMode, StackMode, Window, WindowClass,
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
        let mut opened = Self { connection, window, size };
        opened.fit(size).map_err(no_display)?;
        Ok(opened)
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

    /// Resizes editor and window to the size in pixels nearest to this that the editor takes.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when the editor keeps its size, or the display is gone.
    pub fn resize(&mut self, plugin: &mut dyn Plugin, size: (u32, u32)) -> Result<(), HostError> {
        let size = plugin.resize_editor(size)?;
        self.fit(size).map_err(no_display)
    }

    /// Tells the editor how many pixels a point has on this screen, as hosts do, and gives the window the size that it then has.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when the editor does not want to know, or the display is gone.
    pub fn scale(&mut self, plugin: &mut dyn Plugin, scale: f64) -> Result<(), HostError> {
        let size = plugin.scale_editor(scale)?;
        self.fit(size).map_err(no_display)
    }

    /// Gives the window the editor's size.
    fn fit(&mut self, size: (u32, u32)) -> Result<(), Box<dyn std::error::Error>> {
        let fit = ConfigureWindowAux::new().width(size.0).height(size.1);
        self.connection.configure_window(self.window, &fit)?;
        self.connection.sync()?;
        self.size = size;
        Ok(())
    }

    /// Lets the editor live for this long, running the plugin's callbacks and giving it the size that it asks for.
    pub fn run_for(&mut self, plugin: &mut dyn Plugin, duration: Duration) {
        let end = Instant::now() + duration;
        while Instant::now() < end {
            let _ = plugin.run_callbacks();
            if let Some(size) = plugin.take_wanted_editor_size() {
                // An editor that refuses what it asked for, or a display that is gone, leaves things as they are.
                let _ = self.resize(plugin, size);
            }
            while matches!(self.connection.poll_for_event(), Ok(Some(_))) {}
            thread::sleep(FRAME);
        }
    }

    /// Puts the window before all others.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when the display is gone.
    pub fn raise(&self) -> Result<(), HostError> {
        let above = ConfigureWindowAux::new().stack_mode(StackMode::ABOVE);
        self.connection.configure_window(self.window, &above).map_err(no_display)?;
        self.connection.sync().map_err(no_display)
    }

    /// Destroys the window under its editor, as a host may in the wrong order. The editor is still to be closed.
    ///
    /// # Errors
    /// [`HostError::Unsupported`] when the display is gone.
    pub fn destroy_window(&self) -> Result<(), HostError> {
        self.connection.destroy_window(self.window).map_err(no_display)?;
        self.connection.sync().map_err(no_display)
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
