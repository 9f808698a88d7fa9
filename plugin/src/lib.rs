//! Pyrophone as a CLAP and VST3 effect.
//!
//! | module | content | thread |
//! |---|---|---|
//! | [`effect`] | the effect as called by hosts | whichever thread the host uses |
//! | [`entry`] | entry points for hosts, and guards around the framework | whichever thread the host uses |
//! | [`remote_pages`] | pages of parameters for controllers | at the start |
//! | [`parameters`] | the settings' table as host parameters | any thread |
//! | [`audio`] | the engines, and their ends of the rings | the audio thread |
//! | [`channels`] | channel counts of the buses | any thread |
//! | [`loader`] | recordings, dictionaries, learning | a separate thread, one per instance |
//! | [`persist`] | session data besides the parameters | any thread |
//! | [`controllers`] | MIDI controllers that move parameters | any thread |
//! | [`host_menu`] | the host's own entries in the menus of parameters | the host's main thread, the window's |
//! | [`takes`] | the takes that were tried | any thread |
//! | [`window_size`] | the window's size, which outlives it | any thread |
//! | [`meters`] | levels for the editor | any thread |
//! | [`frame_pace`] | frame rate of the window | the audio thread |
//! | [`probe`] | drive and output for the editor | from the audio thread to the window's |
//! | [`editor`] | the window | the host's window thread |
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod audio;
pub mod channels;
pub mod controllers;
pub mod drain_barrier;
#[allow(clippy::disallowed_methods, reason = "it is only drawn")]
pub mod editor;
pub mod effect;
pub mod entry;
pub mod frame_pace;
pub mod gas;
pub mod host_clock;
pub mod host_menu;
pub mod loader;
pub mod meters;
pub mod parameters;
pub mod persist;
pub mod probe;
pub mod remote_pages;
pub mod takes;
pub mod window_size;

pub use effect::Pyrophone;
