//! A hop as it has been decided at its first sample.

use super::field::Moment;
use super::moving::{HopControls, Pose};
use super::source::Identity;

/// Data common to all sources of a hop.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Hop {
    /// Position of its first sample.
    pub start: i64,
    pub before: HopControls,
    pub frame: HopControls,
    pub pose: Pose,
    pub identity: Identity,
    /// Steps of the speed field around its start and end.
    pub moments: Option<[Moment; 2]>,
    /// Number of sources that should sound by its end.
    pub wanted: usize,
    /// The envelope's speed in m/s.
    pub speed_m_s: f64,
    /// Logarithms of that and of the reference's gain.
    pub ln_speed: f32,
    pub ln_reference: f32,
    /// True if sources without external motion stay in place.
    pub stays: bool,
    /// True if it precedes the first audible hop.
    pub is_fresh: bool,
    /// Sources from here on are silent.
    pub sources: usize,
    /// Sources that have been summed.
    pub summed: usize,
}
