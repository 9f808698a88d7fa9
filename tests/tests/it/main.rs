//! End-to-end tests in one program, so that it is linked once; those that measure a whole process have programs of their own.

#[path = "../../../recording/tests/files/mod.rs"]
mod files;

mod bad_recordings;
mod bad_states;
mod controllers;
mod editor;
mod editor_drag;
mod editor_menu;
mod editor_midi;
mod editor_slots;
mod equality;
mod golden;
mod imports;
mod latency;
mod layouts;
mod lifecycle;
mod links;
mod papers;
mod recordings;
mod sharing;
mod transport;
mod validator;
