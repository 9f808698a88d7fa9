//! Properties of the running engines that the loader needs.

use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::Channels;

/// The sample rate and structure of the engines that run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Engine {
    /// Sample rate in Hz.
    pub sample_rate_hz: f64,
    /// Structure.
    pub structure: EngineConfig,
    /// Channels, for the latency of a future engine.
    pub channels: Channels,
}
