//! No window: this host cannot create one on this system.

type EditorResult = Result<(), &'static str>;

const WHY: &str = "this host makes windows on Linux and Windows only";

/// A window that cannot be created.
pub(super) enum NativeWindow {}

impl NativeWindow {
    pub fn new(_: &str) -> Result<Self, &'static str> {
        Err(WHY)
    }

    pub const fn id(&self) -> u32 {
        match *self {}
    }

    pub fn fit(&self, _: (u32, u32)) -> EditorResult {
        match *self {}
    }

    pub fn handle_events(&self) {
        match *self {}
    }

    pub fn raise(&self) -> EditorResult {
        match *self {}
    }

    pub fn destroy(&self) -> EditorResult {
        match *self {}
    }
}
