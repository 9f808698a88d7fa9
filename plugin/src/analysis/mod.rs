//! What the window shows of sounds: their spectra, their course, their outline.
//!
//! | module | is |
//! |---|---|
//! | [`bands`] | the frequencies of all plots |
//! | [`analyser`] | a running spectrum |
//! | [`fidelity`] | how near the output is to the recording, and how well it follows the drive |
//! | [`recording_overview`] | a whole recording at a glance |
//! | [`range`] | whether matching two ranges of amplitudes is likely to buzz |

pub mod analyser;
pub mod bands;
pub mod fidelity;
pub mod range;
pub mod recording_overview;

pub use analyser::Analyser;
pub use bands::{BANDS, FLOOR_DB};
pub use fidelity::{Character, Fidelity, Figures};
pub use recording_overview::Portrait;
