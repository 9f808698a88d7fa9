//! Sizes that the whole index shares.

/// Windows of a leaf, and children of a node: as many as the widest vectors have lanes.
pub const LANES: usize = 16;
/// Largest number of coordinates stored per window: room for all 46 dimensions of a feature of the default size, and the
/// remainder.
pub const AXES_MAX: usize = 48;
