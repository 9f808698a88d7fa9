//! Reading what fluid simulators leave behind: OpenVDB files, NumPy arrays, and series of numbers.
//!
//! Whatever a file says is checked before anything is allocated or looped over: [`budget`] bounds what one file may
//! make of itself, every loop consumes bytes, and no input panics.

mod assemble;
pub mod budget;
pub mod description;
pub mod error;
mod listing;
mod names;
pub mod npy;
pub mod npz;
mod numbering;
pub mod sequence;
pub mod series;
pub mod vdb;

pub use description::{Description, GridInfo, Selected, Source};
pub use error::{Error, Fault};
pub use numbering::{Numbering, Pattern};
pub use sequence::{PlacementChoice, Selection, Sequence};
pub use series::{Series, Timing};
