//! Analysis of sounds for the window: spectra, spectrograms, outlines.
//!
//! | module | content |
//! |---|---|
//! | [`bands`] | the frequencies of all plots |
//! | [`analyser`] | a running spectrum |
//! | [`fidelity`] | likeness of the output to the recording, and how well it follows the drive |
//! | [`recording_overview`] | a whole recording at a glance |
//! | [`range`] | likelihood that matching two ranges of amplitudes buzzes |

pub mod analyser;
pub mod bands;
pub mod fidelity;
pub mod range;
pub mod recording_overview;

pub use analyser::Analyser;
pub use bands::{BANDS, FLOOR_DB};
pub use fidelity::{Character, Fidelity, Figures};
pub use recording_overview::Portrait;
