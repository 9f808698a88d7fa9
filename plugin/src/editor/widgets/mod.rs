//! Widgets that set parameters.
//!
//! | module | content |
//! |---|---|
//! | [`turn`](mod@turn) | changes by pointer, wheel, keys and menu |
//! | [`knob`](mod@knob), [`fader`](mod@fader), [`slider`](mod@slider) | widgets for continuous values |
//! | [`value`](mod@value) | the value as text, and typing it |
//! | [`menu`](mod@menu) | the context menu |
//! | [`pick`] | choices and switches |
//! | [`keys`] | keys of the focused widget |
//! | [`section`](mod@section) | panels, and areas in them |
//! | [`baked`](mod@baked) | shapes that rarely change |

pub mod baked;
pub mod fader;
pub mod keys;
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
