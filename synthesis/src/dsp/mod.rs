//! Tools of signal processing that know no engine.
//!
//! | tool | purpose |
//! |---|---|
//! | [`White`] | white noise as a function of seed and position |
//! | [`Timeline`] | control values beside the audio that they apply to |
//! | [`mitchell_netravali`] | interpolation between the steps of a simulation, and its slope |
//! | `Transform`, `ChirpZ` | Fourier transforms of one length, zero-phase filters; spectra of a part of the axis |
//! | `Svf` | low- and high-pass of order 2 |
//! | `Envelope`, `Smoothed` | followers: of a signal's magnitude, of a control |
//! | `Delay` | a fixed delay |
//! | `RingBuffer`, `Ring` | the recent past: in one piece, to be read as a slice; by index, with zeros where nothing was written |
//! | `OverlapAdd` | sums of overlapping pieces |
//! | `mean_of`, `integrated_lufs`, `mean_loudness`, `ceiling` | channels' mean, loudness, mean of loudnesses, the curve that keeps samples below full scale |
//!
//! Engines import this module; it imports none of them (`tests/tests/it/imports.rs`).

pub(crate) mod ceiling;
mod channels;
mod chirp_z;
mod delay;
mod envelope;
mod kernel;
mod loudness;
mod mean_loudness;
mod noise;
mod overlap_add;
mod ring;
mod ring_buffer;
mod smoothed;
mod svf;
mod timeline;
mod transform;

pub use kernel::mitchell_netravali;
pub use noise::White;
pub use timeline::Timeline;

pub(crate) use channels::mean_of;
pub(crate) use chirp_z::ChirpZ;
pub(crate) use delay::Delay;
pub(crate) use envelope::{Average, Envelope, Follow};
pub(crate) use loudness::integrated_lufs;
pub(crate) use mean_loudness::{MEAN_EXPONENT, mean_loudness};
pub(crate) use overlap_add::OverlapAdd;
pub(crate) use ring::Ring;
pub(crate) use ring_buffer::RingBuffer;
pub(crate) use smoothed::Smoothed;
pub(crate) use svf::{Bands, Coefficients, Section, Svf, section_gain};
pub(crate) use transform::{Transform, quick_len};
