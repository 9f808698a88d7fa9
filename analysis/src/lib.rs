#![doc = include_str!("../README.md")]

pub mod analyser;
pub mod bands;
pub mod fidelity;
pub mod range;
pub mod recording_overview;
pub mod spectrogram;
pub mod spectrum;
pub mod welch;

pub use analyser::Analyser;
pub use bands::{BANDS, FLOOR_DB};
pub use fidelity::{Character, Fidelity, Figures};
pub use recording_overview::RecordingOverview;
pub use spectrogram::Spectrogram;
pub use spectrum::Spectrum;
