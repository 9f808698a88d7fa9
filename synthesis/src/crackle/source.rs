//! What crackles: a recording, or where it has no crackles a fuel.

use super::event::Crackles;
use crate::controls::Fuel;

/// All crackles that may be played.
#[derive(Debug, Clone, Copy, Default)]
pub struct Sources<'a> {
    /// Those of the recording, if it has any.
    pub recording: Option<&'a Crackles>,
    /// Those of the fuels that burn, in their order ([`Fuel::place`]); may be empty.
    pub fuels: &'a [Crackles],
}

/// Where a crackle's wave is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Source {
    #[default]
    Recording,
    /// Place among the fuels.
    Fuel(usize),
}

impl<'a> Sources<'a> {
    /// The recording's alone.
    pub fn of_recording(recording: &'a Crackles) -> Self {
        Self { recording: Some(recording), fuels: &[] }
    }

    /// What crackles while `fuel` is chosen: the recording where it has crackles, else the fuel.
    pub(super) fn choose(&self, fuel: Fuel) -> Option<(Source, &'a Crackles)> {
        [Some(Source::Recording), fuel.place().map(Source::Fuel)]
            .into_iter()
            .flatten()
            .find_map(|source| self.crackles(source).map(|crackles| (source, crackles)))
    }

    /// The crackles of `source`, if there are any.
    pub(super) fn crackles(&self, source: Source) -> Option<&'a Crackles> {
        let found = match source {
            Source::Recording => self.recording,
            Source::Fuel(place) => self.fuels.get(place),
        };
        found.filter(|crackles| !crackles.events().is_empty())
    }
}
