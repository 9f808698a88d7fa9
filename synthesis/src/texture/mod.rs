//! Synchronized texture synthesis (Chadwick & James 2011, §5).
//!
//! | module | content |
//! |---|---|
//! | [`shape`] | sizes and positions |
//! | [`pyramid`] | Gaussian pyramids, of a file and of a stream |
//! | [`feature`] | the neighbourhood by which a window is matched |
//! | [`dictionary`] | a recording, analysed and indexed |
//! | `removed_loudness` | its slow loudness, where that was removed before, restored window by window |
//! | [`search`] | the nearest window |
//! | [`distribution`] | dynamic-range matching; `drive_range`: what it knows of the drive |
//! | [`schedule`] | the sample at which each window is matched |
//! | [`gate`] | silence in, silence out |
//! | [`extents`] | extents of the output's levels |
//! | [`buzz`] | repeats that are audible as tones |
//! | [`slots`] | several recordings, and the choice between them for each window |
//! | `output` | the synthesized sound of each |
//! | `window_feature`, `traces` | the engine's parts: the feature that is matched, and data for displays |
//! | [`engine`] | the whole process, on a stream |
//! | [`offline`] | the whole process, on a complete signal |

pub mod buzz;
pub mod dictionary;
pub mod distribution;
mod drive_range;
pub mod engine;
pub mod extents;
pub mod feature;
pub mod gate;
pub mod offline;
mod output;
pub mod pyramid;
mod removed_loudness;
pub mod schedule;
pub mod search;
pub mod shape;
pub mod slots;
mod traces;
mod window_feature;

pub use dictionary::Dictionary;
pub use distribution::Distribution;
pub use engine::Texture;
pub use extents::Extent;
pub use removed_loudness::RemovedLoudness;
pub use shape::PyramidConfig;
pub use traces::Match;
