//! Orders from the window and the host.

use std::path::Path;

use pyrophone_recording::{check_not_among, write_wav_f32};
use pyrophone_settings::{PresetRecording, session};
use pyrophone_synthesis::controls::SLOTS;

use super::Worker;
use crate::loader::mailbox::Order;
use crate::loader::slot::Pending;
use crate::loader::source;
use crate::persist;

impl Worker {
    pub(super) fn accept(&mut self, order: Order) {
        let shown = self.shown;
        match order {
            Order::Load(path) => self.slots[shown].pending = Some(Pending::File(path)),
            Order::LoadPreset(slot, recording) => {
                self.slots[slot.min(SLOTS - 1)].pending = Some(Pending::Preset(recording));
            }
            Order::Restore(slot, before) => self.restore(slot.min(SLOTS - 1), before),
            Order::Unload => {
                self.slots[shown].pending = None;
                *self.session.recording_in_mut(shown) = None;
                self.set_recording(shown, None);
                self.status.update(|view| view.error = None);
                self.params.session.store(&self.session);
            }
            Order::ReadSession => self.read_session(),
            Order::Engine(engine) => {
                self.engine = Some(engine);
                for slot in &mut self.slots {
                    slot.failed = None;
                    // New engines have no recordings, so empty slots need no update.
                    slot.is_sent = slot.recording.is_none() && slot.dictionary.is_none();
                }
                self.learner.resend();
                self.motion.resend();
                self.clip_loader.resend();
            }
            Order::Cancel => self.cancel(),
            Order::Cut(cut) => {
                *self.session.cut_in_mut(shown) = cut;
                self.slots[shown].failed = None;
                self.show_recording(shown);
                self.status.update(|view| view.error = None);
                self.params.session.store(&self.session);
            }
            Order::Audition(wanted) => self.clip_loader.want(wanted),
            Order::LearnFrom(path) => self.learner.learn_from(path),
            Order::SavePart(path) => self.save_part(&path),
            Order::Embed(embed) => self.set_embed(embed),
            Order::ForgetLearned => {
                self.session.learned = None;
                self.learner.resend();
                self.params.session.store(&self.session);
            }
            Order::LoadField(path) => match self.motion.load(&path, &mut self.session, &self.status) {
                Ok(()) => {
                    self.status.update(|view| view.error = None);
                    self.params.session.store(&self.session);
                }
                Err(message) => self.status.fail(message),
            },
            Order::UnloadField => {
                self.session.field = None;
                self.motion.read(&self.session, &self.status);
                self.params.session.store(&self.session);
            }
        }
    }

    /// Cancels the current work. Recordings not fetched are listed as if not found; dictionaries not built are not
    /// tried again until something changes.
    fn cancel(&mut self) {
        let Some(what) = self.cancel_fetching().or_else(|| self.cancel_learning()).or_else(|| self.cancel_indexing())
        else {
            return;
        };
        self.status.fail(format!("Cancelled: {what}. The previous sound continues; load it again at any time."));
    }

    fn cancel_fetching(&mut self) -> Option<String> {
        let slot = self.order().find(|slot| self.slots[*slot].pending.is_some())?;
        match self.slots[slot].pending.take()? {
            Pending::File(path) | Pending::Preset(PresetRecording { file: path, .. }) => {
                Some(path.display().to_string())
            }
            Pending::Session => {
                self.set_recording(slot, None);
                Some("the session's recording".to_owned())
            }
        }
    }

    fn cancel_learning(&mut self) -> Option<String> {
        self.learner.is_awaited().then(|| {
            self.learner.give_up();
            "learning from a file".to_owned()
        })
    }

    fn cancel_indexing(&mut self) -> Option<String> {
        let engine = self.engine?;
        let structure = self.params.values().structure();
        for slot in self.order() {
            let Some(recording) = self.slots[slot].recording.clone() else { continue };
            let key = self.key(&recording, &self.cut(slot), &structure, engine.sample_rate_hz);
            let place = &mut self.slots[slot];
            let is_made = place.dictionary.as_ref().is_some_and(|(made, _)| *made == key);
            if !is_made && place.failed.as_ref() != Some(&key) {
                place.failed = Some(key);
                return Some(recording.name.clone());
            }
        }
        None
    }

    fn save_part(&self, path: &Path) {
        let Some(recording) = self.slots[self.shown].recording.as_deref() else {
            return self.status.fail("there is no recording to be saved; load one first".to_owned());
        };
        let of = Path::new(self.path(self.shown).unwrap_or_default());
        let part = check_not_among(path, &[of]).and_then(|()| self.cut(self.shown).apply(recording));
        let saved = part.and_then(|part| write_wav_f32(path, &part.channels, part.sample_rate_hz));
        match saved {
            Ok(()) => self.status.update(|view| view.notice = Some(format!("Saved: {}", path.display()))),
            Err(error) => self.status.fail(error.to_string()),
        }
    }

    /// Puts back the recording that a slot had before, from its file or from the session itself.
    fn restore(&mut self, slot: usize, before: session::Slot) {
        *self.session.recording_in_mut(slot) = before.recording;
        *self.session.cut_in_mut(slot) = before.cut;
        self.slots[slot].pending = Some(Pending::Session);
        self.show_recording(slot);
        self.params.session.store(&self.session);
    }

    /// Takes over the session that the host has loaded. An unreadable one changes nothing; a later version's is kept
    /// for saving, a damaged one is not.
    fn read_session(&mut self) {
        let Some(field) = self.params.session.take_arrived() else { return };
        match persist::decode(&field) {
            Ok(session) => {
                self.session = session;
                self.slots.iter_mut().for_each(|slot| slot.pending = Some(Pending::Session));
                self.learner.resend();
                self.status.update(|view| view.error = None);
                self.motion.read(&self.session, &self.status);
            }
            Err(error) => {
                self.status.fail(error.to_string());
                if matches!(error, pyrophone_settings::Error::Session { .. }) {
                    self.params.session.store(&self.session);
                }
            }
        }
        self.show_session();
    }

    fn set_embed(&mut self, embed: bool) {
        self.session.embed = embed;
        for slot in 0..SLOTS {
            let Some(reference) = self.session.recording_in_mut(slot) else { continue };
            match (embed, reference.embedded.is_some()) {
                (true, false) => match source::pack(reference) {
                    Ok(packed) => reference.embedded = packed,
                    Err(message) => self.status.fail(message),
                },
                (false, true) => reference.embedded = None,
                _ => {}
            }
        }
        self.params.session.store(&self.session);
        self.show_session();
    }
}
