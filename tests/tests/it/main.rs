//! End-to-end tests in one program, so that it is linked once. Those that open a window set variables of the process, and those that
//! measure a whole process want it for themselves: they have programs of their own.

#[path = "../../../recording/tests/files/mod.rs"]
mod files;

mod bad_recordings;
mod bad_states;
mod controllers;
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
