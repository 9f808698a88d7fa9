//! Pictures of sound.

pub mod course;
pub mod heat;
pub mod outline;
pub mod spectrum;
