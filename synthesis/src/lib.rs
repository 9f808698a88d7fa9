#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod bulk;
mod ceiling;
pub mod chain;
mod channels;
pub mod companding;
pub mod controls;
pub mod crackle;
pub mod drive;
pub mod error;
pub mod extend;
pub mod fft;
mod filter;
pub mod fuel;
mod loudness;
pub mod mix;
pub mod noise;
mod recording;
mod smoothed;
pub mod structure;
pub mod texture;
pub mod timeline;
pub mod tone;
pub mod vortex;

pub use controls::Controls;
pub use error::Error;
pub use structure::EngineConfig;
