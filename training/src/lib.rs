#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

pub mod build;
pub mod key;
pub mod store;

pub use build::{Error, Stage, build};
pub use key::DictionaryKey;
pub use store::Store;

/// Advice about a recording whose dictionary [is impulsive](pyrophone_synthesis::recording::RecordingDictionary::is_impulsive).
pub const IMPULSIVE: &str = "the recording crackles too sharply for the paper's mode, in which one window may repeat as a buzz; \
    choose dynamics mode companded, or turn on scaling auto";
