#![doc = include_str!("../README.md")]
#![cfg_attr(not(test), deny(clippy::disallowed_methods))]

mod play;
mod source;

pub use source::{Source, read};

/// Reason why a recording's bytes are not to be had.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be read; or reading was cancelled.
    #[error(transparent)]
    Recording(#[from] pyrophone_recording::Error),
    /// There is no such factory fire.
    #[error(transparent)]
    Settings(#[from] pyrophone_settings::Error),
    /// The engines rejected a factory fire's settings.
    #[error("the factory fire {name} cannot be played: {source}")]
    Engines {
        /// The fire.
        name: &'static str,
        /// The engines' error.
        source: pyrophone_synthesis::Error,
    },
}
