//! Pyrophone's sound engines, real-time safe.
//!
//! The modules read as the signal path:
//!
//! | module | does | source |
//! |---|---|---|
//! | [`drive`] | what the engines feed on: pressure, flux, a sidechain's envelope or a simulated flame, then the 30 Hz high-pass | Chadwick & James 2011, §3, §6 |
//! | [`extend`] | spectral bandwidth extension | Chadwick & James 2011, §4 |
//! | [`texture`] | synchronized texture synthesis | Chadwick & James 2011, §5 |
//! | [`vortex`] | the whoosh of turbulent flow | Dobashi, Yamamoto & Nishita 2004 |
//! | [`companding`] | texture in a world without slow loudness, the drive's put back | this project |
//! | [`crackle`] | the recording's crackles, split off and played as the drive burns | this project |
//! | [`fuel`] | crackle, hiss and body of a fuel, without a recording | this project |
//! | [`tone`] | a tilt and two shelves on the sum | |
//! | [`mix`] | layer levels, width, output level | |
//! | [`chain`] | all of these, aligned, with transport and automation: the whole effect | |
//!
//! Every stage has the same verbs: `new`, `latency_samples`, `reset`, `process`. `reset` brings it
//! to the state of a fresh instance. `process` never allocates, locks or frees, and its output
//! does not depend on how the input was cut into blocks.
//!
//! This crate knows nothing of plugins, windows or files.

mod bulk;
mod ceiling;
pub mod chain;
pub mod companding;
pub mod controls;
pub mod crackle;
pub mod drive;
pub mod error;
pub mod extend;
pub mod fft;
mod filter;
pub mod fuel;
mod loudness;
pub mod mix;
pub mod noise;
mod smoothed;
pub mod structure;
pub mod texture;
pub mod timeline;
pub mod tone;
pub mod vortex;

pub use controls::Controls;
pub use error::Error;
pub use structure::Structure;

/// A fingerprint of this build's source: what was kept by a build with another one is made again.
pub const BUILD: &str = env!("PYROPHONE_BUILD_FINGERPRINT");
