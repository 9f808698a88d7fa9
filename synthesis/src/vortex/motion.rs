//! Motion of sources that do not all follow one envelope.

use super::field::{Moment, SourceState, SpeedField};
use super::live::Live;
use crate::controls::Flow;

/// Origin of the speeds and positions of single sources. Both may be present at once: sources that change from one to
/// the other still sound by the one that they had.
#[derive(Clone, Copy)]
pub(super) struct Motion<'a> {
    /// A field, and its steps around the hop's start and end.
    pub field: Option<(&'a SpeedField, [Moment; 2])>,
    /// A simulation that runs alongside.
    pub live: Option<&'a Live>,
}

impl Motion<'_> {
    /// A source of a flow at the hop's start, or at its end.
    pub fn state_at(&self, flow: Flow, source: usize, end: bool) -> Option<SourceState> {
        match (flow, self.field, self.live) {
            (Flow::Field, Some((field, places)), _) if source < field.sources() => {
                Some(field.state_at(source, places[usize::from(end)]))
            }
            (Flow::Live, _, Some(live)) if source < live.sources() => Some(live.state_at(source, end)),
            _ => None,
        }
    }
}
