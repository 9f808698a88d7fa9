//! Pictures of sound.

pub mod course;
pub mod outline;
pub mod spectrum;
