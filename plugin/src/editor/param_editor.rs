//! The user's changes to parameters: each goes through the host as a gesture, and can be undone.

use nice_plug::prelude::ParamSetter;
use pyrophone_settings::session::Slot;
use pyrophone_settings::{Id, PresetRecording, Values};

use super::history::{Change, Chosen, Exchanged, Step, UndoHistory, changes};
use super::inert::Reasons;
use crate::entry::indication::Automation;
use crate::loader::LoaderHandle;
use crate::parameters::EffectParams;
use crate::persist;

/// Access of the widgets to the parameters.
pub struct ParamEditor<'a> {
    /// The parameters.
    pub params: &'a EffectParams,
    /// Connection to the host.
    pub setter: &'a ParamSetter<'a>,
    /// The loader of recordings.
    pub loader: &'a LoaderHandle,
    /// Undo history.
    pub history: &'a mut UndoHistory,
    /// Parameters without effect, and the reasons.
    pub inert: &'a Reasons,
}

impl ParamEditor<'_> {
    /// The present values, with the changes of the current gesture: hosts respond with delay.
    pub fn values(&self) -> Values {
        self.history.gesture.map_or_else(|| self.params.values(), |(_, now)| now)
    }

    /// Returns whether a controller is mapped to a parameter, here or in the host, and its automation state in the
    /// host.
    pub fn indication(&self, index: usize) -> (bool, Automation) {
        let indications = &self.params.indications;
        let is_mapped = indications.is_mapped(index) || self.params.controllers.number(index).is_some();
        (is_mapped, indications.automation(index))
    }

    /// The reason why a parameter has no effect at present; none where it has one.
    pub fn inert(&self, index: usize) -> Option<&'static str> {
        self.inert.get(index).copied().flatten()
    }

    /// The present value of one parameter.
    pub fn value(&self, index: usize) -> f64 {
        self.history.gesture.as_ref().map_or_else(|| self.params.value(index), |(_, now)| now.as_slice()[index])
    }

    /// The present value of one parameter, by its id.
    pub fn get(&self, id: Id) -> f64 {
        self.value(id as usize)
    }

    /// Begins a gesture on a parameter.
    pub fn begin(&mut self, index: usize) {
        if self.history.gesture.is_none() {
            let values = self.params.values();
            self.history.gesture = Some((values, values));
        }
        self.params.slot(index).begin(self.setter);
    }

    /// Moves a parameter within a gesture.
    pub fn set(&mut self, index: usize, plain: f64) {
        if let Some((_, now)) = &mut self.history.gesture {
            now.set_nearest(index, plain);
        }
        self.params.slot(index).set(self.setter, plain);
    }

    /// Ends a gesture on a parameter.
    pub fn end(&mut self, index: usize) {
        self.params.slot(index).end(self.setter);
        if let Some((before, now)) = self.history.gesture.take() {
            self.record(changes(&before, &now));
        }
    }

    /// Sets a parameter in one gesture.
    pub fn set_once(&mut self, index: usize, plain: f64) {
        self.begin(index);
        self.set(index, plain);
        self.end(index);
    }

    /// Sets all parameters, as one step.
    pub fn set_all(&mut self, next: &Values) {
        let made = changes(&self.params.values(), next);
        self.send(&made, |change| change.after);
        self.record(made);
    }

    /// Sets all parameters to those of a preset and loads its recording if it names one, as one step; undoing it restores
    /// the previous preset's name too.
    pub fn choose(&mut self, chosen: Chosen) {
        let Some(entry) = chosen.clone() else { return };
        let now = self.params.values();
        let made = changes(&now, &entry.preset.values.chosen_over(&now));
        self.send(&made, |change| change.after);
        let recording = entry.preset.recording.as_ref().and_then(|recording| self.load(recording)).map(Box::new);
        let before = std::mem::replace(&mut self.history.chosen, chosen.clone());
        if !made.is_empty() || before != chosen || recording.is_some() {
            self.history.record(Step::Changes { changes: made, chosen: [before, chosen], recording });
        }
    }

    /// The active slot, and its recording as the session names it.
    pub fn slot(&self) -> (usize, Slot) {
        let slot = self.get(Id::RecordingSlot) as usize;
        // A session that cannot be read is reported by the loader, and has no recordings.
        let session = persist::decode(&self.params.session.field()).unwrap_or_default();
        (slot, Slot { recording: session.recording_in(slot).cloned(), cut: session.cut_in(slot) })
    }

    /// Loads a preset's recording into the active slot; none if it is there already.
    fn load(&self, recording: &PresetRecording) -> Option<Exchanged> {
        let (slot, before) = self.slot();
        let is_at = |path: &str| recording.file.as_os_str() == path;
        if before.cut == recording.cut && before.recording.as_ref().is_some_and(|known| is_at(&known.path)) {
            return None;
        }
        self.loader.load_preset(slot, recording.clone());
        Some(Exchanged { slot, before, after: recording.clone() })
    }

    /// Undoes the last step.
    pub fn undo(&mut self) {
        let Some(step) = self.history.take_past() else { return };
        let undone = match step {
            Step::Changes { changes, chosen, recording } => {
                self.send(&changes, |change| change.before);
                self.history.chosen.clone_from(&chosen[0]);
                if let Some(exchanged) = &recording {
                    self.loader.restore(exchanged.slot, exchanged.before.clone());
                }
                Step::Changes { changes, chosen, recording }
            }
            step => self.turn_over(step),
        };
        self.history.foresee(undone);
    }

    /// Redoes the step undone last.
    pub fn redo(&mut self) {
        let Some(step) = self.history.take_future() else { return };
        let redone = match step {
            Step::Changes { changes, chosen, recording } => {
                self.send(&changes, |change| change.after);
                self.history.chosen.clone_from(&chosen[1]);
                if let Some(exchanged) = &recording {
                    self.loader.load_preset(exchanged.slot, exchanged.after.clone());
                }
                Step::Changes { changes, chosen, recording }
            }
            step => self.turn_over(step),
        };
        self.history.remember(redone);
    }

    /// Exchanges A and B, as one step; at first they are equal.
    pub fn exchange(&mut self) {
        self.swap();
        self.history.record(Step::Exchange);
    }

    /// Copies the active settings over the inactive ones, as one step.
    pub fn copy(&mut self) {
        let now = (self.params.values(), self.history.chosen.clone());
        let before = self.history.beside.replace(now);
        self.history.record(Step::Copy(Box::new(before)));
    }

    /// Undoes or redoes a step that is its own opposite.
    fn turn_over(&mut self, step: Step) -> Step {
        match step {
            Step::Copy(mut kept) => {
                std::mem::swap(&mut *kept, &mut self.history.beside);
                Step::Copy(kept)
            }
            step => {
                self.swap();
                step
            }
        }
    }

    fn swap(&mut self) {
        let now = (self.params.values(), self.history.chosen.clone());
        let (values, chosen) = self.history.beside.replace(now.clone()).unwrap_or(now);
        let made = changes(&self.params.values(), &values);
        self.send(&made, |change| change.after);
        self.history.chosen = chosen;
        self.history.is_b = !self.history.is_b;
    }

    fn record(&mut self, made: Vec<Change>) {
        if !made.is_empty() {
            let chosen = self.history.chosen.clone();
            let chosen = [chosen.clone(), chosen];
            self.history.record(Step::Changes { changes: made, chosen, recording: None });
        }
    }

    fn send(&self, changes: &[Change], value: impl Fn(&Change) -> f64) {
        for change in changes {
            let slot = self.params.slot(change.index);
            slot.begin(self.setter);
            slot.set(self.setter, value(change));
            slot.end(self.setter);
        }
    }
}
