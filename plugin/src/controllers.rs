//! Assignment of MIDI controllers to parameters, and MIDI learn.
//!
//! Everything is atomic: the audio thread looks controllers up and learns them, the window assigns and shows them. Accesses
//! are relaxed, because each assignment is a single number. A controller counts on every MIDI channel and may move several
//! parameters; a parameter follows one controller.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU8, AtomicU32, Ordering};

use pyrophone_settings::controller_file::{Assignments, CONTROLLERS, is_assignable};
use pyrophone_settings::{PARAMETERS, index_of};

/// Number of no controller.
const NONE: u8 = u8::MAX;
/// Value for no parameter.
const NOBODY: u32 = u32::MAX;

/// Assignments of one instance.
#[derive(Debug)]
pub struct Controllers {
    /// By the parameter's index in the table.
    numbers: Vec<AtomicU8>,
    /// Index of the parameter that is assigned the next controller to move.
    learner: AtomicU32,
}

impl Default for Controllers {
    fn default() -> Self {
        Self { numbers: PARAMETERS.iter().map(|_| AtomicU8::new(NONE)).collect(), learner: AtomicU32::new(NOBODY) }
    }
}

impl Controllers {
    /// The controller assigned to the parameter at `index` of the table.
    pub fn number(&self, index: usize) -> Option<u8> {
        let number = self.numbers[index].load(Ordering::Relaxed);
        (number != NONE).then_some(number)
    }

    /// Assigns a controller, or none, to the parameter at `index` of the table.
    pub fn assign(&self, index: usize, number: Option<u8>) {
        self.numbers[index].store(number.unwrap_or(NONE), Ordering::Relaxed);
    }

    /// Starts MIDI learn for the parameter at `index`; it replaces any other that was waiting.
    pub fn learn(&self, index: usize) {
        self.learner.store(index as u32, Ordering::Relaxed);
    }

    /// Cancels [`learn`](Self::learn).
    pub fn stop_learning(&self) {
        self.learner.store(NOBODY, Ordering::Relaxed);
    }

    /// Index of the parameter that waits for a controller.
    pub fn learner(&self) -> Option<usize> {
        let learner = self.learner.load(Ordering::Relaxed);
        (learner != NOBODY).then_some(learner as usize)
    }

    /// Notes that a controller has moved, which completes a pending MIDI learn; real-time safe.
    pub fn note_moved(&self, number: u8) {
        if number >= CONTROLLERS {
            return;
        }
        let learner = self.learner.swap(NOBODY, Ordering::Relaxed);
        if let Some(slot) = self.numbers.get(learner as usize) {
            slot.store(number, Ordering::Relaxed);
        }
    }

    /// Places of the parameters that a controller moves; real-time safe.
    pub fn targets(&self, number: u8) -> impl Iterator<Item = usize> {
        let is_moved = move |slot: &AtomicU8| number < CONTROLLERS && slot.load(Ordering::Relaxed) == number;
        self.numbers.iter().enumerate().filter(move |(_, slot)| is_moved(slot)).map(|(index, _)| index)
    }

    /// Replaces all assignments; parameters without one follow no controller.
    pub fn set_all(&self, assignments: &Assignments) {
        for (parameter, slot) in PARAMETERS.iter().zip(&self.numbers) {
            slot.store(assignments.get(parameter.id).copied().unwrap_or(NONE), Ordering::Relaxed);
        }
    }

    /// The assignments as stored in a session.
    pub fn to_json(&self) -> String {
        let assigned = (0..PARAMETERS.len()).filter_map(|index| Some((PARAMETERS[index].id, self.number(index)?)));
        serde_json::to_string(&assigned.collect::<BTreeMap<&str, u8>>()).unwrap_or_default()
    }

    /// Restores the assignments stored in a session. Text in another format changes nothing, and impossible assignments
    /// are left out.
    pub fn read_json(&self, text: &str) {
        if let Ok(mut assignments) = serde_json::from_str::<Assignments>(text) {
            assignments.retain(|id, number| is_assignable(id, *number));
            self.set_all(&assignments);
        }
    }
}

/// The normalised value of the parameter at `index` with its controller at `share` (0-1); real-time safe.
pub fn value_at(index: usize, share: f64) -> f64 {
    let parameter = &PARAMETERS[index];
    parameter.to_normalised(parameter.from_normalised(share))
}

/// Index of the parameter `id` where it may follow a controller.
pub fn assignable(id: &str) -> Option<usize> {
    index_of(id).ok().filter(|index| PARAMETERS[*index].automatable)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn index_of_id(id: &str) -> usize {
        assignable(id).expect("a parameter that can be automated")
    }

    #[test]
    fn a_waiting_parameter_takes_the_next_controller() {
        let controllers = Controllers::default();
        controllers.note_moved(7);
        controllers.learn(index_of_id("alpha"));
        controllers.learn(index_of_id("macro_size"));
        assert_eq!(controllers.learner(), Some(index_of_id("macro_size")));
        controllers.note_moved(CONTROLLERS);
        assert_eq!(controllers.number(index_of_id("macro_size")), None, "a channel mode message is no controller");
        controllers.note_moved(21);
        controllers.note_moved(22);
        assert_eq!((controllers.number(index_of_id("macro_size")), controllers.learner()), (Some(21), None));
        assert_eq!(controllers.number(index_of_id("alpha")), None);
        controllers.learn(index_of_id("alpha"));
        controllers.stop_learning();
        controllers.note_moved(23);
        assert_eq!(controllers.number(index_of_id("alpha")), None);
    }

    #[test]
    fn a_controller_moves_all_that_follow_it() {
        let controllers = Controllers::default();
        assert_eq!(controllers.targets(NONE).count(), 0, "what follows none follows no controller of that number");
        for id in ["alpha", "macro_size"] {
            controllers.assign(index_of_id(id), Some(1));
        }
        controllers.assign(index_of_id("cutoff"), Some(2));
        assert_eq!(controllers.targets(1).collect::<Vec<_>>(), [index_of_id("alpha"), index_of_id("macro_size")]);
        controllers.assign(index_of_id("alpha"), None);
        assert_eq!(controllers.targets(1).collect::<Vec<_>>(), [index_of_id("macro_size")]);
    }

    #[test]
    fn sessions_keep_assignments_and_garbage_changes_nothing() {
        let controllers = Controllers::default();
        controllers.assign(index_of_id("macro_size"), Some(21));
        let other = Controllers::default();
        other.assign(index_of_id("alpha"), Some(3));
        other.read_json(&controllers.to_json());
        assert_eq!(other.to_json(), r#"{"macro_size":21}"#);
        for garbage in ["", "[]", "null", r#"{"macro_size":-1}"#, r#"{"macro_size":300}"#] {
            other.read_json(garbage);
            assert_eq!(other.to_json(), r#"{"macro_size":21}"#, "{garbage}");
        }
        other.read_json(r#"{"levels":1,"no_such":2,"macro_fury":120,"macro_hiss":119}"#);
        assert_eq!(other.to_json(), r#"{"macro_hiss":119}"#);
    }

    #[test]
    fn steps_are_whole_at_any_position() {
        let choice = index_of_id("drive_mode");
        let steps: std::collections::BTreeSet<u64> =
            (0..=127).map(|position| value_at(choice, f64::from(position) / 127.0).to_bits()).collect();
        assert_eq!(steps.len(), PARAMETERS[choice].high() as usize + 1);
        assert_eq!((value_at(choice, 0.0), value_at(choice, 1.0)), (0.0, 1.0));
    }
}
