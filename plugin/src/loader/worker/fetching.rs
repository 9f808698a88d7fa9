//! From paths and sessions to recordings.

use std::sync::Arc;

use pyrophone_recording::{Cut, Recording};
use pyrophone_settings::{FactoryFire, PresetRecording, session};

use super::Worker;
use crate::loader::job::Job;
use crate::loader::slot::Pending;
use crate::loader::source::{self, Failure, Found};

impl Worker {
    /// Fetches the pending recordings.
    pub(super) fn fetch(&mut self, job: &Job) -> Result<(), Failure> {
        if self.slots.iter().all(|slot| slot.pending.is_none()) {
            return Ok(());
        }
        let mut words = Vec::new();
        for slot in self.order() {
            if let Some(pending) = self.slots[slot].pending.take() {
                let fetched = self.fetch_one(slot, &pending, job);
                if let Err(Failure::Cancelled) = fetched {
                    self.slots[slot].pending = Some(pending);
                    return Err(Failure::Cancelled);
                }
                words.extend(self.settle(slot, &pending, fetched));
                self.show_session();
            }
        }
        // Last, so that it is still shown.
        words.extend(self.motion.take_error());
        let words = (!words.is_empty()).then(|| words.join("\n"));
        self.status.update(|view| view.error = words);
        self.show_session();
        Ok(())
    }

    /// Takes over a fetched recording; returns a notice for the user.
    fn settle(&mut self, slot: usize, pending: &Pending, fetched: Result<Option<Found>, Failure>) -> Option<String> {
        let (recording, notice) = match fetched {
            Ok(Some(Found { recording, notice, .. })) => (Some(recording), notice),
            Ok(None) | Err(Failure::Cancelled) => (None, None),
            Err(Failure::Message(message)) => {
                if matches!(pending, Pending::Session) {
                    self.set_recording(slot, None);
                }
                self.status.fail(message.clone());
                return Some(message);
            }
        };
        self.set_recording(slot, recording);
        notice
    }

    fn fetch_one(&mut self, slot: usize, pending: &Pending, job: &Job) -> Result<Option<Found>, Failure> {
        match pending {
            Pending::File(path) => {
                let found = source::open(path, self.session.embed, job)?;
                // The old part means nothing in another recording; the same recording at a new path keeps it.
                let known = self.session.recording_in(slot);
                let is_known = known.is_some_and(|known| known.content_hash == found.reference.content_hash);
                let old = self.session.cut_in(slot);
                let cut = if is_known { old } else { session::Cut { region_s: None, ..old } };
                self.exchange(slot, &found, cut, job)?;
                // Factory fires have a list of their own.
                if let Some(recent) = self.recent.as_ref().filter(|_| !FactoryFire::is_meant_by(path)) {
                    let known = recent.add(&found.reference.path);
                    self.status.update(|view| view.recent = known);
                }
                Ok(Some(found))
            }
            Pending::Preset(PresetRecording { file, cut }) => {
                let found = source::open(file, self.session.embed, job);
                let exchanged = found.and_then(|found| self.exchange(slot, &found, *cut, job).map(|()| found));
                exchanged.map(Some).map_err(|failure| match failure {
                    Failure::Message(message) => Failure::Message(format!(
                        "The preset's recording cannot be loaded, so the present one stays. {message}"
                    )),
                    Failure::Cancelled => Failure::Cancelled,
                })
            }
            Pending::Session => match self.session.recording_in(slot).cloned() {
                None => Ok(None),
                Some(reference) => {
                    let located = source::locate(&reference, job)?;
                    // The dictionary comes first, because the sound depends on it; the display can wait until the
                    // recording is decoded.
                    self.recall(slot, &located.content_hash, job);
                    located.decode(&reference, job).map(Some)
                }
            },
        }
    }

    /// Exchanges a slot's recording for another, or for another part of it. The old one stays until the new one has its
    /// index.
    fn exchange(&mut self, slot: usize, found: &Found, cut: session::Cut, job: &Job) -> Result<(), Failure> {
        let session::Cut { region_s, gain_db, normalise } = cut;
        let part = Cut { region_s, gain_db, normalise };
        let dictionary = self.build(slot, &found.recording, &part, job)?;
        *self.session.recording_in_mut(slot) = Some(found.reference.clone());
        *self.session.cut_in_mut(slot) = cut;
        self.params.session.store(&self.session);
        self.slots[slot].dictionary = dictionary;
        // The engines still have the old one's, if any.
        self.slots[slot].is_sent = false;
        Ok(())
    }

    pub(super) fn set_recording(&mut self, slot: usize, recording: Option<Arc<Recording>>) {
        let place = &mut self.slots[slot];
        let is_empty = recording.is_none() && place.recording.is_none() && place.dictionary.is_none();
        let is_same = |known: &Arc<Recording>| recording.as_ref().is_some_and(|new| Arc::ptr_eq(new, known));
        if !place.recording.as_ref().is_some_and(is_same) {
            place.overview = None;
        }
        place.recording = recording;
        place.failed = None;
        let fits = self.has_fitting_dictionary(slot);
        let place = &mut self.slots[slot];
        // The engines need no update for a slot that was empty and still is.
        place.is_sent &= fits || is_empty;
        if place.recording.is_none() {
            place.dictionary = None;
        }
        if slot == self.shown {
            let overview = place.overview.clone();
            self.status.update(|view| view.overview = overview);
        }
        self.show_session();
        self.show_recording(slot);
    }
}
