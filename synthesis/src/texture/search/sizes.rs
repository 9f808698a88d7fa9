//! Sizes that the whole index shares.

/// Windows of a leaf, and children of a node: as many as the widest vectors hold numbers.
pub const LANES: usize = 16;
/// Most numbers kept per window.
pub const AXES_MAX: usize = 48;
