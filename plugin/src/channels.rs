//! Channel counts of the buses.

/// Most channels of a bus.
pub const MAX_CHANNELS: usize = 6;
