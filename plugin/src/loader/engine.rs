//! What the loader must know of the engines that run.

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::Channels;

/// The sample rate and structure of the engines that run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engine {
    /// Sample rate in Hz.
    pub sample_rate_hz: f64,
    /// Structure.
    pub structure: EngineConfig,
    /// Channels, for the latency of an engine to come.
    pub channels: Channels,
}
