//! Telemetry of the engines, for display.

use crate::texture::{Extent, Match};
use crate::vortex::SeenSource;

/// One event in an engine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Telemetry {
    /// The noise factor beta found by a window of extension (§4, Algorithm 1).
    Beta(f32),
    /// A match of a window of texture on the level below the top (§5.2).
    Match(Match),
    /// Extent of a level of texture's output pyramid over a sixtieth of a second.
    Extent(Extent),
    /// Number of sources of vortex sound; each of them follows.
    Sources(usize),
    /// A source of vortex sound.
    Source(SeenSource),
}
