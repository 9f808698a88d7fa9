//! What parameters are set with.

mod keys;
mod knob;
mod pick;

pub use keys::notches;
pub use knob::{SIZE as KNOB, knob};
pub use pick::{WIDTH as PICK_WIDTH, choice, toggle};
