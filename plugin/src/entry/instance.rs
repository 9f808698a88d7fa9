//! Shared parts of an effect that the framework creates inside its own object.

use std::cell::RefCell;
use std::sync::Arc;

use pyrophone_settings::{COUNT, PARAMETERS};

use crate::loader::LoaderHandle;
use crate::meters::Meters;
use crate::parameters::EffectParams;

/// The parts of an effect that are shared with its guard.
#[derive(Clone)]
pub struct Instance {
    /// Parameters and session.
    pub params: Arc<EffectParams>,
    /// Levels, sample rate and latency.
    pub meters: Arc<Meters>,
    /// The loader of recordings.
    pub loader: LoaderHandle,
}

thread_local! {
    /// The framework creates the effect by `Default` and keeps it private; it does so on the calling thread.
    static LAST_MADE: RefCell<Option<Instance>> = const { RefCell::new(None) };
}

/// Hands an effect just created to the guard on this thread.
pub fn announce(instance: Instance) {
    LAST_MADE.with(|last| last.replace(Some(instance)));
}

/// The effect created last on this thread, once.
pub fn take_announced() -> Option<Instance> {
    LAST_MADE.with(RefCell::take)
}

/// Numeric id of a parameter in both formats, as nice-plug derives it: a polynomial hash of its id, without the top
/// bit, which VST3 reserves for hosts.
pub const fn numeric_id(id: &str) -> u32 {
    let (bytes, mut hash, mut index) = (id.as_bytes(), 0u32, 0);
    while index < bytes.len() {
        hash = hash.wrapping_mul(31).wrapping_add(bytes[index] as u32);
        index += 1;
    }
    hash & !(1 << 31)
}

/// Numeric ids in the table's order, known beforehand so that the audio thread only compares.
pub static NUMERIC_IDS: [u32; COUNT] = {
    let (mut ids, mut index) = ([0; COUNT], 0);
    while index < COUNT {
        ids[index] = numeric_id(PARAMETERS[index].id);
        index += 1;
    }
    ids
};

/// Index in the table of the parameter with this numeric id; real-time safe.
pub fn index_of_numeric(id: u32) -> Option<usize> {
    NUMERIC_IDS.iter().position(|known| *known == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numeric_ids_are_unique_and_found() {
        for (index, parameter) in PARAMETERS.iter().enumerate() {
            assert_eq!(index_of_numeric(numeric_id(parameter.id)), Some(index), "{}", parameter.id);
        }
        assert_eq!(index_of_numeric(numeric_id("no such parameter")), None);
    }
}
