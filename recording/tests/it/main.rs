//! The integration tests of this crate in one program, so that it is linked once.

#[path = "../files/mod.rs"]
mod files;
#[path = "../../../tests/src/skip.rs"]
mod skip;

mod bad_recordings;
mod broadcast;
mod flac;
mod never_panics;
mod odd_inputs;
mod reference_inputs;
mod resample;
mod round_trip;
mod stream;
