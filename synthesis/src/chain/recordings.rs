//! The recordings of a voice.

use std::sync::Arc;

use crate::companding::Profile;
use crate::controls::SLOTS;
use crate::crackle::Crackles;
use crate::recording::RecordingDictionary;

/// Recordings by slot.
#[derive(Debug, Default)]
pub(super) struct Recordings {
    slots: [Option<Arc<RecordingDictionary>>; SLOTS],
    /// Slot of the recording on whose scale windows are matched.
    reference: Option<usize>,
}

impl Recordings {
    /// Exchanges the recording of a slot, which must exist; `reference` is the slot on whose scale windows are then
    /// matched.
    pub fn swap(
        &mut self,
        slot: usize,
        recording: Option<Arc<RecordingDictionary>>,
        reference: Option<usize>,
    ) -> Option<Arc<RecordingDictionary>> {
        self.reference = reference;
        std::mem::replace(&mut self.slots[slot], recording)
    }

    /// True if there is a recording in a slot.
    pub fn has(&self, slot: usize) -> bool {
        self.get(slot).is_some()
    }

    /// The companding data of a slot's recording.
    pub fn profile(&self, slot: usize) -> Option<&Profile> {
        self.get(slot)?.profile()
    }

    /// The crackles of a slot's recording.
    pub fn crackles(&self, slot: usize) -> Option<&Crackles> {
        self.get(slot)?.crackles()
    }

    /// Companding data of the recording on whose scale windows are matched.
    pub fn reference_profile(&self) -> Option<&Profile> {
        self.profile(self.reference?)
    }

    /// Crackles of that recording.
    pub fn reference_crackles(&self) -> Option<&Crackles> {
        self.crackles(self.reference?)
    }

    fn get(&self, slot: usize) -> Option<&RecordingDictionary> {
        self.slots.get(slot)?.as_deref()
    }
}
