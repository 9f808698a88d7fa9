//! Times that the figures share.

/// Seconds over which figures are averaged.
pub(super) const MEMORY_S: f64 = 8.0;

/// Seconds of sound before a figure is given.
pub(super) const PATIENCE_S: f64 = 2.0;
