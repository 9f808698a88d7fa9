//! Readers for the output of fluid simulators: OpenVDB files, NumPy arrays, and series of numbers.
//!
//! Everything that a file states is checked before anything is allocated or looped over: [`budget`] bounds the memory
//! that a file may use, every loop consumes bytes, and no input panics.

mod assemble;
mod blender;
pub mod budget;
mod buffers;
pub mod description;
pub mod error;
mod file;
mod format;
mod listing;
pub mod model;
mod names;
pub mod npy;
pub mod npz;
mod numbering;
pub mod sequence;
pub mod series;
pub mod vdb;
mod vocabulary;

pub use description::Description;
pub use error::{Error, FormatFault};
pub use model::{GridInfo, GridSource, PlacementChoice, Selected, Selection};
pub use numbering::{Numbering, Pattern};
pub use sequence::Sequence;
pub use series::{Series, Timing};
