//! What goes into one call of the effect: channels, and what the host says of its timeline.

/// Samples that are processed at once.
pub(super) const CHUNK: usize = 256;

/// Channels of the effect's buses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channels {
    /// Channels of the main input, 1-10.
    pub input: usize,
    /// Channels of the sidechain, 0-10; 0 = not connected.
    pub sidechain: usize,
    /// Channels of the output, 1-10, at least as many as of the input; [`SpeakerLayout`](crate::vortex::SpeakerLayout) tells their loudspeakers. That of
    /// low-frequency effects passes the input's own.
    pub output: usize,
}

/// What the host says of its timeline for one call of [`Chain::process`](super::Chain::process).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Transport {
    /// Whether the host plays.
    pub playing: bool,
    /// Position of the call's first sample on the host's timeline, in samples; may be negative.
    pub position: Option<i64>,
}
