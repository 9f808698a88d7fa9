//! What the window is shown.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use pyrophone_analysis::RecordingOverview;
use pyrophone_settings::Id;
use pyrophone_synthesis::controls::SLOTS;
use pyrophone_training::IMPULSIVE;

use super::Worker;
use crate::loader::learner::shown_amplitudes;

impl Worker {
    /// Switches the displayed slot when the parameter changes.
    pub(super) fn follow_shown(&mut self) {
        let shown = (self.params.value(Id::RecordingSlot as usize) as usize).min(SLOTS - 1);
        if shown == self.shown {
            return;
        }
        self.shown = shown;
        self.slots[shown].overview_is_due = true;
        let overview = self.slots[shown].overview.clone();
        self.status.update(|view| view.overview = overview);
        self.show_session();
        self.show_dictionary();
        self.show_cut();
    }

    pub(super) fn show_session(&self) {
        let path = self.path(self.shown).map(str::to_owned);
        let recordings: [Option<String>; SLOTS] =
            std::array::from_fn(|slot| self.slots[slot].description(self.path(slot)));
        let is_named = std::array::from_fn(|slot| self.path(slot).is_some());
        self.status.update(|view| {
            view.slot = self.shown;
            view.path = path;
            view.recording = recordings[self.shown].clone();
            view.slots = recordings;
            view.is_named = is_named;
            view.embed = self.session.embed;
        });
    }

    /// Shows the part used for learning, and has the recording redrawn.
    pub(super) fn show_recording(&mut self, slot: usize) {
        self.slots[slot].overview_is_due = true;
        self.show_cut();
    }

    fn show_cut(&self) {
        self.status.update(|view| view.cut = self.session.cut_in(self.shown));
    }

    /// Draws the active slot's recording, once its sound is ready, and only for an open window: a session of fifty
    /// instances opens none.
    pub(super) fn draw(&mut self) {
        let cut = self.cut(self.shown);
        let place = &mut self.slots[self.shown];
        if !place.overview_is_due || !self.link.shared.is_watched.load(Ordering::Relaxed) {
            return;
        }
        place.overview_is_due = false;
        let known = place.overview.take();
        place.overview = place.recording.as_deref().map(|recording| {
            Arc::new(match known {
                Some(known) => known.with_cut(recording, &cut),
                None => RecordingOverview::of_recording(recording, &cut),
            })
        });
        let overview = place.overview.clone();
        self.status.update(|view| view.overview = overview);
    }

    /// Shows the properties of the active slot's dictionary.
    pub(super) fn show_dictionary(&self) {
        let dictionary = self.slots[self.shown].dictionary.as_ref().map(|(_, dictionary)| dictionary);
        let amplitudes = dictionary.and_then(|dictionary| shown_amplitudes(dictionary.windows().distribution()));
        let crackles = dictionary.and_then(|dictionary| dictionary.crackles());
        let crackles_per_s = crackles.map(|crackles| crackles.summary().per_second as f32);
        let warning = dictionary.filter(|dictionary| dictionary.is_impulsive()).map(|_| IMPULSIVE.to_owned());
        self.status.update(|view| {
            view.amplitudes[0] = amplitudes;
            view.crackles_per_s = crackles_per_s;
            view.notice = warning.or_else(|| view.notice.take());
        });
    }
}
