//! Inputs of one call of the effect: channels, and the host's timeline.

/// Samples processed at a time. Hosts may send blocks of any length; buffers between the stages have this one, so that
/// they are allocated once.
pub(super) const CHUNK: usize = 256;

/// Channels of the effect's buses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Channels {
    /// Channels of the main input, 1-10.
    pub input: usize,
    /// Channels of the sidechain, 0-10; 0 = not connected.
    pub sidechain: usize,
    /// Channels of the output, 1-10, at least as many as of the input, with the loudspeakers of
    /// [`SpeakerLayout`](crate::vortex::SpeakerLayout). The LFE channel passes the input's LFE through.
    pub output: usize,
}

/// The host's timeline for one call of [`Chain::process`](super::Chain::process).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Transport {
    /// True while the host plays.
    pub playing: bool,
    /// Position of the call's first sample on the host's timeline, in samples; may be negative.
    pub position: Option<i64>,
}
