//! What the running engine gets.

use std::sync::Arc;

use pyrophone_synthesis::recording::RecordingDictionary;

use super::Worker;
use crate::loader::link::Update;

impl Worker {
    pub(super) fn send_dictionary(&mut self, slot: usize, dictionary: Arc<RecordingDictionary>) {
        self.slots[slot].is_sent = self.link.send(Update::Dictionary(slot, Some(dictionary)));
        if slot == self.shown {
            self.show_dictionary();
        }
    }

    /// Sends the data of a slot that the running engine lacks. A dictionary for a structure not running yet waits until
    /// it does.
    pub(super) fn send_slot(&mut self, slot: usize) {
        if self.engine.is_none() || self.slots[slot].is_sent {
            return;
        }
        match &self.slots[slot].dictionary {
            Some((_, dictionary)) if self.has_fitting_dictionary(slot) => {
                let dictionary = dictionary.clone();
                self.send_dictionary(slot, dictionary);
            }
            Some(_) => {}
            None => {
                self.slots[slot].is_sent = self.link.send(Update::Dictionary(slot, None));
                if slot == self.shown {
                    self.show_dictionary();
                }
            }
        }
    }

    /// Sends all data that the running engine lacks.
    pub(super) fn send(&mut self) {
        let Some(engine) = self.engine else { return };
        for slot in self.order() {
            self.send_slot(slot);
        }
        self.learner.send(&mut self.link, &self.session, &engine, &self.status);
        self.motion.send(&mut self.link);
        self.clip_loader.send(&mut self.link, &self.status);
    }
}
