//! Pictures of sound.

pub mod beta;
pub mod dynamics;
pub mod heat;
pub mod outline;
pub mod pyramid;
pub mod space;
pub mod spectrogram;
pub mod spectrum;
pub mod trace;
