//! Source of crackles: one of the recordings, or a fuel if it has none.

use super::event::Crackles;
use crate::controls::{CrackleControls, SLOTS};

/// All crackles that may be played.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// Crackles of the recordings, by slot, if they have any, with their gain factors.
    pub recordings: [Option<&'a Crackles>; SLOTS],
    /// See `recordings`.
    pub gains: [f64; SLOTS],
    /// Factor on those of fuels.
    pub fuel_gain: f64,
    /// Crackles of the fuels that burn, in their order (`Fuel::burning_index`); may be empty.
    pub fuels: &'a [Crackles],
}

/// Origin of a crackle's wave.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum CrackleSource {
    /// Slot of a recording.
    Recording(usize),
    /// Index among the fuels.
    Fuel(usize),
}

impl Default for CrackleSource {
    fn default() -> Self {
        Self::Recording(0)
    }
}

impl Default for Sources<'_> {
    fn default() -> Self {
        Self { recordings: [None; SLOTS], gains: [1.0; SLOTS], fuel_gain: 1.0, fuels: &[] }
    }
}

impl<'a> Sources<'a> {
    /// Crackles of a recording in the first slot only.
    pub fn of_recording(recording: &'a Crackles) -> Self {
        let mut sources = Self::default();
        sources.recordings[0] = Some(recording);
        sources
    }

    /// The source that crackles: the chosen recording if it has crackles, otherwise the fuel.
    pub(super) fn choose(&self, controls: &CrackleControls) -> Option<(CrackleSource, &'a Crackles)> {
        [Some(CrackleSource::Recording(controls.slot)), controls.fuel.burning_index().map(CrackleSource::Fuel)]
            .into_iter()
            .flatten()
            .find_map(|source| self.crackles(source).map(|crackles| (source, crackles)))
    }

    /// The crackles of `source`, if there are any.
    pub(super) fn crackles(&self, source: CrackleSource) -> Option<&'a Crackles> {
        let found = match source {
            CrackleSource::Recording(slot) => self.recordings.get(slot).copied().flatten(),
            CrackleSource::Fuel(place) => self.fuels.get(place),
        };
        found.filter(|crackles| !crackles.events().is_empty())
    }

    /// Factor on the crackles of `source`.
    pub(super) fn gain(&self, source: CrackleSource) -> f64 {
        match source {
            CrackleSource::Recording(slot) => self.gains.get(slot).copied().unwrap_or(1.0),
            CrackleSource::Fuel(_) => self.fuel_gain,
        }
    }
}
