//! Names of the arrays that state the position and time of a frame.

/// Edge of a voxel in world units, one number.
pub(super) const VOXEL_SIZE: &str = "voxel_size";
/// Centre of the first voxel in world units, three numbers.
pub(super) const ORIGIN: &str = "origin";
/// Time of the frame in seconds, one number.
pub(super) const TIME: &str = "time_s";
