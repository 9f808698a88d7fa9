//! The integration tests of this crate in one program, so that it is linked once.

mod automation;
mod macros;
mod manual;
mod parameters;
mod presets;
mod session;
mod takes;
