#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod bulk;
pub mod chain;
pub mod companding;
pub mod controls;
pub mod crackle;
pub mod drive;
pub mod dsp;
pub mod error;
pub mod extend;
pub mod fuel;
pub mod mix;
pub mod recording;
pub mod structure;
pub mod texture;
pub mod tone;
pub mod vortex;

pub use controls::Controls;
pub use error::Error;
pub use structure::EngineConfig;
