//! What moves the sources that do not all follow one envelope.

use super::field::{SpeedField, Told};
use super::live::Live;

/// What tells speeds and places of single sources.
#[derive(Clone, Copy)]
pub(super) enum Motion<'a> {
    /// Nothing does.
    None,
    /// A field, and its steps around the hop's start and end.
    Field(&'a SpeedField, [(usize, usize, f64); 2]),
    /// A simulation that goes on meanwhile.
    Live(&'a Live),
}

impl Motion<'_> {
    /// Number of sources; none where nothing tells of them.
    pub fn sources(&self) -> usize {
        match self {
            Self::None => 0,
            Self::Field(field, _) => field.sources(),
            Self::Live(live) => live.sources(),
        }
    }

    /// A source at the hop's start, or at its end.
    pub fn at(&self, source: usize, end: bool) -> Option<Told> {
        match self {
            Self::Field(field, places) if source < field.sources() => Some(field.at(source, places[usize::from(end)])),
            Self::Live(live) if source < live.sources() => Some(live.at(source, end)),
            _ => None,
        }
    }
}
