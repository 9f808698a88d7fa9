//! Data about the engine's work, for displays.

use super::extents::{Extent, Extents};

/// Largest number of stored matches; later ones are lost.
const MATCH_CAPACITY: usize = 512;
/// Largest number of top-level samples that one call may leave; longer calls keep the first.
const TOP_CAPACITY: usize = 8192;

/// A match of a window of the level below the top.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Match {
    /// Centre of the recording's window, in seconds from the recording's start.
    pub place_s: f32,
    /// Mean magnitude of the drive about the window, and the factor that took it into the recording's range (§5.3, eq. 17).
    pub magnitude: f32,
    /// See `magnitude`; 1 without mapping.
    pub factor: f32,
}

/// Magnitudes, matches and extents since they were last returned.
#[derive(Debug)]
pub(super) struct Traces {
    /// Top-level magnitudes that arose in the last call of `process`.
    pub top_magnitudes: Vec<f64>,
    /// Matches of the level below the top.
    matches: Vec<Match>,
    /// Extents of all levels.
    pub extents: Extents,
}

impl Traces {
    /// Empty, for so many levels.
    pub fn new(levels: usize, sample_rate_hz: f64) -> Self {
        Self {
            top_magnitudes: Vec::with_capacity(TOP_CAPACITY),
            matches: Vec::with_capacity(MATCH_CAPACITY),
            extents: Extents::new(levels, sample_rate_hz),
        }
    }

    /// Forgets everything; the next sample is at `origin`.
    pub fn reset(&mut self, origin: i64) {
        self.top_magnitudes.clear();
        self.matches.clear();
        self.extents.reset(origin);
    }

    /// Adds a top-level magnitude.
    pub fn add_magnitude(&mut self, magnitude: f64) {
        if self.top_magnitudes.len() < TOP_CAPACITY {
            self.top_magnitudes.push(magnitude);
        }
    }

    /// Adds a match.
    pub fn add_match(&mut self, found: Match) {
        if self.matches.len() < MATCH_CAPACITY {
            self.matches.push(found);
        }
    }

    /// Returns matches and extents, and forgets them.
    pub fn drain(&mut self) -> (std::vec::Drain<'_, Match>, std::vec::Drain<'_, Extent>) {
        (self.matches.drain(..), self.extents.drain())
    }
}
