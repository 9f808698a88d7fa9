#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod advection;
pub mod clusters;
pub mod error;
pub mod flux;
pub mod frame;
pub mod front;
pub mod grid;
pub mod import;
pub mod live;
pub mod pressure;
pub mod scenes;
pub mod seam;
pub mod solver;
pub mod speed_field;
pub mod upsample;
pub mod velocity;
pub mod vortex_texture;

pub use error::Error;
pub use flux::Flux;
pub use frame::Frame;
pub use front::Front;
