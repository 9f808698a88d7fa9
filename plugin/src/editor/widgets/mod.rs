//! What parameters are set with.

mod knob;
mod pick;

pub use knob::{SIZE as KNOB, knob};
pub use pick::{WIDTH as PICK_WIDTH, choice, toggle};
