//! What parameters are set with.
//!
//! | module | is |
//! |---|---|
//! | [`turn`](mod@turn) | what moves a parameter: pointer, wheel, keys, menu |
//! | [`knob`](mod@knob), [`fader`](mod@fader), [`slider`](mod@slider) | what is turned |
//! | [`value`](mod@value) | the value as text, to be typed |
//! | [`menu`](mod@menu) | what the right button offers |
//! | [`pick`] | choices and switches |
//! | [`section`](mod@section) | panels, and places in them |

pub mod fader;
mod keys;
pub mod knob;
pub mod menu;
pub mod pick;
pub mod section;
pub mod slider;
pub mod turn;
pub mod value;

pub use keys::notches;
pub use knob::{SIZE as KNOB, knob};
pub use pick::{WIDTH as PICK_WIDTH, choice, toggle};
