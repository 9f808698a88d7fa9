//! The integration tests of this crate in one program, so that it is linked once.

#[path = "../common/mod.rs"]
mod common;
#[path = "../common/playing.rs"]
mod playing;
#[path = "../common/screen.rs"]
mod screen;

mod access;
mod audio;
mod exchange;
mod gas;
mod loader;
mod page_controls;
mod pages;
mod parameters;
mod slots;
mod undo;
