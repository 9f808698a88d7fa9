//! Synchronized texture synthesis (Chadwick & James 2011, §5).
//!
//! | module | does |
//! |---|---|
//! | [`shape`] | sizes and positions |
//! | [`pyramid`] | Gaussian pyramids, of a file and of a stream |
//! | [`feature`] | the neighbourhood that a window is matched by |
//! | [`dictionary`] | a recording, analysed and indexed |
//! | [`search`] | the nearest window |
//! | [`distribution`] | dynamic-range matching |
//! | [`schedule`] | which window is matched at which sample |
//! | [`gate`] | silence in, silence out |
//! | [`extents`] | how far the output's levels swing |
//! | [`buzz`] | repeats that are heard as tones |
//! | [`slots`] | several recordings, and which of them a window is of |
//! | `output` | what was synthesized of each |
//! | [`engine`] | all of it, as a stream |
//! | [`offline`] | all of it, on a whole signal |

pub mod buzz;
pub mod dictionary;
pub mod distribution;
pub mod engine;
pub mod extents;
pub mod feature;
pub mod gate;
pub mod offline;
mod output;
pub mod pyramid;
mod ring;
pub mod schedule;
pub mod search;
pub mod shape;
pub mod slots;

pub use dictionary::Dictionary;
pub use distribution::Distribution;
pub use engine::{Match, Texture};
pub use extents::Extent;
pub use shape::PyramidConfig;
