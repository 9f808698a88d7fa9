//! Undo history: only the user's own actions, so that undoing never reverts the host's automation.

use std::collections::VecDeque;
use std::sync::Arc;

use pyrophone_settings::session::Slot;
use pyrophone_settings::{COUNT, Preset, PresetRecording, Values};

use std::path::PathBuf;

/// Steps that can be undone; the manual states this number.
const STEPS: usize = 200;

/// A preset that can be chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// Its content.
    pub preset: Preset,
    /// Its file; none for factory presets.
    pub path: Option<PathBuf>,
}

/// The preset chosen last, if any.
pub type Chosen = Option<Arc<Entry>>;

/// One parameter that the user has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Index in the table.
    pub index: usize,
    /// Plain value before.
    pub before: f64,
    /// Plain value after.
    pub after: f64,
}

/// A recording that a preset brought.
#[derive(Debug, Clone, PartialEq)]
pub struct Exchanged {
    /// The slot that it was loaded into.
    pub slot: usize,
    /// Content of the slot before.
    pub before: Slot,
    /// The preset's recording.
    pub after: PresetRecording,
}

/// One of the two settings to compare, while the other one sounds.
pub type Beside = Option<(Values, Chosen)>;

/// Undoable step.
#[derive(Debug, Clone)]
pub enum Step {
    /// Parameters were changed, and maybe another preset chosen.
    Changes {
        /// Changed parameters.
        changes: Vec<Change>,
        /// The chosen preset before and after.
        chosen: [Chosen; 2],
        /// The recording that the preset brought, and the one before it.
        recording: Option<Box<Exchanged>>,
    },
    /// A and B were exchanged.
    Exchange,
    /// The active settings were copied over the inactive ones, which are kept here.
    Copy(Box<Beside>),
}

/// The steps, and the inactive settings of the A/B pair.
#[derive(Debug, Default)]
pub struct UndoHistory {
    past: VecDeque<Step>,
    future: Vec<Step>,
    /// Values before the current gesture, and those it has set so far.
    pub(super) gesture: Option<(Values, Values)>,
    /// A and B; the one that sounds is in the parameters.
    pub(super) beside: Beside,
    pub(super) is_b: bool,
    /// The preset that was chosen last.
    pub chosen: Chosen,
}

impl UndoHistory {
    /// True if there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// True if there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// True if B is active.
    pub fn is_b(&self) -> bool {
        self.is_b
    }

    /// Adds a step that was just made.
    pub(super) fn record(&mut self, step: Step) {
        self.remember(step);
        self.future.clear();
    }

    /// The last step; it can be redone once it was given to [`foresee`](Self::foresee).
    pub(super) fn take_past(&mut self) -> Option<Step> {
        self.past.pop_back()
    }

    /// The step that was undone last.
    pub(super) fn take_future(&mut self) -> Option<Step> {
        self.future.pop()
    }

    /// Stores an undone step for redo.
    pub(super) fn foresee(&mut self, step: Step) {
        self.future.push(step);
    }

    /// Stores a redone step for undo.
    pub(super) fn remember(&mut self, step: Step) {
        self.past.push_back(step);
        if self.past.len() > STEPS {
            self.past.pop_front();
        }
    }
}

/// The differences between two sets of values.
pub fn changes(before: &Values, after: &Values) -> Vec<Change> {
    let (old, new) = (before.as_slice(), after.as_slice());
    (0..COUNT)
        .filter(|index| old[*index] != new[*index])
        .map(|index| Change { index, before: old[index], after: new[index] })
        .collect()
}
