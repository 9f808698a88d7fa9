//! A window on the display that `DISPLAY` names.

use x11rb::connection::Connection;
use x11rb::protocol::xproto::{
    AtomEnum, ConfigureWindowAux, ConnectionExt, CreateWindowAux, EventMask, PropMode, StackMode, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

type EditorResult = Result<(), Box<dyn std::error::Error>>;

/// A window with nothing in it.
pub(super) struct NativeWindow {
    connection: RustConnection,
    window: Window,
}

impl NativeWindow {
    pub fn new(title: &str) -> Result<Self, Box<dyn std::error::Error>> {
        let (connection, screen) = x11rb::connect(None)?;
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
            AtomEnum::WM_NAME,
            AtomEnum::STRING,
            title.as_bytes(),
        )?;
        connection.map_window(window)?;
        connection.sync()?;
        Ok(Self { connection, window })
    }

    pub const fn id(&self) -> u32 {
        self.window
    }

    pub fn fit(&self, (width, height): (u32, u32)) -> EditorResult {
        let fit = ConfigureWindowAux::new().width(width).height(height);
        self.connection.configure_window(self.window, &fit)?;
        Ok(self.connection.sync()?)
    }

    pub fn handle_events(&self) {
        while matches!(self.connection.poll_for_event(), Ok(Some(_))) {}
    }

    pub fn raise(&self) -> EditorResult {
        let above = ConfigureWindowAux::new().stack_mode(StackMode::ABOVE);
        self.connection.configure_window(self.window, &above)?;
        Ok(self.connection.sync()?)
    }

    pub fn destroy(&self) -> EditorResult {
        self.connection.destroy_window(self.window)?;
        Ok(self.connection.sync()?)
    }
}
