//! Errors of configurations and signals for the engines.

/// Reason why an engine could not be created, or a signal could not be processed.
///
/// Every message names the value found and the value allowed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A setting lies outside its range.
    #[error("{what} is {found}, but must lie between {low} and {high}; choose a value in that range")]
    OutOfRange {
        /// The setting, in the user's words.
        what: &'static str,
        /// The value found.
        found: f64,
        /// The smallest value allowed.
        low: f64,
        /// The largest value allowed.
        high: f64,
    },
    /// A signal is too short for what is asked of it.
    #[error("{what} has {found} samples, but at least {least} are needed; use a longer sound or {remedy}")]
    TooShort {
        /// The signal.
        what: &'static str,
        /// Its length in samples.
        found: usize,
        /// The least length in samples.
        least: usize,
        /// An alternative remedy.
        remedy: &'static str,
    },
    /// A signal contains a NaN or an infinity.
    #[error("{what} has a value that is not finite at sample {at}; repair or re-export the file")]
    NotFinite {
        /// The signal.
        what: &'static str,
        /// Index of the first bad sample.
        at: usize,
    },
    /// Channels of one signal differ in length.
    #[error(
        "{what}: channel {channel} has {found} samples, channel 0 has {expected}; all channels must be equally long"
    )]
    UnequalChannels {
        /// The signal.
        what: &'static str,
        /// The channel that differs.
        channel: usize,
        /// Its length in samples.
        found: usize,
        /// The length of channel 0 in samples.
        expected: usize,
    },
    /// A built-in flame cannot be read: the build is damaged.
    #[error("the factory drive `{scene}` cannot be read: {reason}; write it again with `cargo xtask drives`")]
    FactoryDrive {
        /// The scene.
        scene: &'static str,
        /// The fault in its file.
        reason: String,
    },
    /// A vortex-sound texture cannot be used.
    #[error("the vortex texture cannot be used: {reason}; write it again with `pyrophone vortex-texture`")]
    VortexTexture {
        /// The fault found.
        reason: String,
    },
    /// A speed field cannot be used.
    #[error("the speed field cannot be used: {reason}; export it again")]
    SpeedField {
        /// The fault found.
        reason: String,
    },
    /// Work was called off by its progress callback.
    #[error("cancelled")]
    Cancelled,
}

/// Fails unless `low <= found <= high`; NaN fails too.
pub(crate) fn in_range(what: &'static str, found: f64, low: f64, high: f64) -> Result<(), Error> {
    if found >= low && found <= high { Ok(()) } else { Err(Error::OutOfRange { what, found, low, high }) }
}

/// `value` limited to `low..=high`; a NaN becomes `low`, which `clamp` would let through.
pub(crate) fn within(value: f64, low: f64, high: f64) -> f64 {
    value.max(low).min(high)
}
