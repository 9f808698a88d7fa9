//! Pictures of sound.

pub mod beta;
pub mod course;
pub mod dynamics;
pub mod heat;
pub mod outline;
pub mod pyramid;
pub mod space;
pub mod spectrum;
pub mod trace;
