//! Choice of the recordings that texture and crackle are made from.

/// Number of recordings that are kept ready side by side.
pub const SLOTS: usize = 4;

/// The recordings that texture and crackle are made from. A slot beyond the last is the last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RecordingControls {
    /// Slot of the recording.
    pub slot: usize,
    /// Slot of a second one; without a recording in it, or equal to the first, there is none.
    pub second: usize,
    /// Share of the second one, 0-1.
    pub blend: f64,
}

impl Default for RecordingControls {
    fn default() -> Self {
        Self { slot: 0, second: 1, blend: 0.0 }
    }
}

impl RecordingControls {
    /// Slot of the recording, within range.
    pub fn first(&self) -> usize {
        self.slot.min(SLOTS - 1)
    }

    /// Slot and share of the second recording, if it has a share; `is_there` returns whether a slot's recording is
    /// loaded.
    pub(crate) fn other(&self, is_there: impl Fn(usize) -> bool) -> Option<(usize, f64)> {
        let (slot, share) = (self.second.min(SLOTS - 1), crate::error::within(self.blend, 0.0, 1.0));
        (share > 0.0 && slot != self.first() && is_there(slot)).then_some((slot, share))
    }
}
