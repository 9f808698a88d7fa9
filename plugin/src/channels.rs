//! How many channels a bus has.

/// Most channels of a bus.
pub const MAX_CHANNELS: usize = 6;
