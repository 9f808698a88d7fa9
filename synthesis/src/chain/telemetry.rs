//! What the engines leave to be seen while they work.

use crate::texture::{Extent, Match};
use crate::vortex::SeenSource;

/// One thing that an engine has done.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Telemetry {
    /// A window of extension has found its noise factor beta (§4, Algorithm 1).
    Beta(f32),
    /// A window of texture was matched on the level below the top (§5.2).
    Match(Match),
    /// A level of texture's output pyramid has swung so far for a sixtieth of a second.
    Extent(Extent),
    /// So many sources of vortex sound are there; each follows.
    Sources(usize),
    /// A source of vortex sound.
    Source(SeenSource),
}
