//! What the user has done, to be undone: only that, so that undoing never takes back what the host has automated.

use std::collections::VecDeque;
use std::sync::Arc;

use pyrophone_settings::{COUNT, Preset, Values};

use std::path::PathBuf;

/// Steps that can be undone.
const STEPS: usize = 200;

/// A preset that can be chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    /// What it holds.
    pub preset: Preset,
    /// Its file; none for those that come with Pyrophone.
    pub path: Option<PathBuf>,
}

/// The preset that was chosen last, if any.
pub type Chosen = Option<Arc<Entry>>;

/// One parameter that the user has changed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// Place in the table.
    pub index: usize,
    /// Plain value before.
    pub before: f64,
    /// Plain value after.
    pub after: f64,
}

/// One of the two settings to compare, while the other one sounds.
pub type Beside = Option<(Values, Chosen)>;

/// What can be undone at once.
#[derive(Debug, Clone)]
pub enum Step {
    /// Parameters were changed, and maybe another preset chosen.
    Changes {
        /// What was changed.
        changes: Vec<Change>,
        /// The chosen preset before and after.
        chosen: [Chosen; 2],
    },
    /// A and B were exchanged.
    Exchange,
    /// What sounds was copied over what does not, which is kept here.
    Copy(Box<Beside>),
}

/// The steps, and the settings that are kept beside those that sound.
#[derive(Debug, Default)]
pub struct UndoHistory {
    past: VecDeque<Step>,
    future: Vec<Step>,
    /// Before the gesture under way, and what it has made so far.
    pub(super) gesture: Option<(Values, Values)>,
    /// A and B; the one that sounds is in the parameters.
    pub(super) beside: Beside,
    pub(super) is_b: bool,
    /// The preset that was chosen last.
    pub chosen: Chosen,
}

impl UndoHistory {
    /// Whether there is something to undo.
    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether there is something to redo.
    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Whether B sounds.
    pub fn is_b(&self) -> bool {
        self.is_b
    }

    /// Keeps a step that was just taken.
    pub(super) fn record(&mut self, step: Step) {
        self.remember(step);
        self.future.clear();
    }

    /// The step that was taken last; it can be redone once it was given to [`foresee`](Self::foresee).
    pub(super) fn take_past(&mut self) -> Option<Step> {
        self.past.pop_back()
    }

    /// The step that was undone last.
    pub(super) fn take_future(&mut self) -> Option<Step> {
        self.future.pop()
    }

    /// Keeps a step that was undone.
    pub(super) fn foresee(&mut self, step: Step) {
        self.future.push(step);
    }

    /// Keeps a step that was redone.
    pub(super) fn remember(&mut self, step: Step) {
        self.past.push_back(step);
        if self.past.len() > STEPS {
            self.past.pop_front();
        }
    }
}

/// What differs between two sets of values.
pub fn changes(before: &Values, after: &Values) -> Vec<Change> {
    let (old, new) = (before.as_slice(), after.as_slice());
    (0..COUNT)
        .filter(|index| old[*index] != new[*index])
        .map(|index| Change { index, before: old[index], after: new[index] })
        .collect()
}
