//! Values that a host has set on its main thread and no block has carried yet.
//!
//! During playback, a VST3 host reports a change twice: to the controller at once, and to the processor with the next
//! block. Between the two the engines rightly use the old value, but the value that the host reads and saves is the new
//! one. Values reported by the effect itself come back as well; no block carries those.

use std::sync::atomic::{AtomicU8, AtomicU32, AtomicU64, Ordering};

use atomic_float::AtomicF32;
use pyrophone_settings::PARAMETERS;

/// Bits of no normalised value: not a number.
const NONE: u64 = u64::MAX;
/// Blocks with changes of a parameter after which the value set on the main thread is obsolete, whatever it was.
const BLOCKS: u8 = 2;

/// Reported values remembered for each parameter: hosts return them with delay.
const REPORTED: usize = 32;

struct Slot {
    bits: AtomicU64,
    blocks: AtomicU8,
    /// The latest values reported to the host, as 32-bit floats, and their count.
    reported: [AtomicF32; REPORTED],
    reported_count: AtomicU32,
}

impl Slot {
    fn new() -> Self {
        Self {
            bits: AtomicU64::new(NONE),
            blocks: AtomicU8::new(0),
            reported: std::array::from_fn(|_| AtomicF32::new(f32::NAN)),
            reported_count: AtomicU32::new(0),
        }
    }
}

/// One slot for each parameter.
pub struct PendingValues(Vec<Slot>);

impl Default for PendingValues {
    fn default() -> Self {
        Self(PARAMETERS.iter().map(|_| Slot::new()).collect())
    }
}

impl PendingValues {
    /// Notes a normalised value for the parameter at `index` of the table.
    pub fn set(&self, index: usize, normalised: f64) {
        self.0[index].blocks.store(0, Ordering::Relaxed);
        self.0[index].bits.store(normalised.clamp(0.0, 1.0).to_bits(), Ordering::Release);
    }

    /// The normalised value that no block has carried yet.
    pub fn get(&self, index: usize) -> Option<f64> {
        let bits = self.0[index].bits.load(Ordering::Acquire);
        (bits != NONE).then(|| f64::from_bits(bits))
    }

    /// Remembers a value reported to the host, which replaces any pending one; real-time safe.
    pub fn report(&self, index: usize, normalised: f64) {
        let slot = &self.0[index];
        let place = slot.reported_count.fetch_add(1, Ordering::Relaxed) as usize % REPORTED;
        slot.reported[place].store(normalised as f32, Ordering::Relaxed);
        slot.bits.store(NONE, Ordering::Release);
    }

    /// True if a value set by the host is one that was reported to it recently.
    pub fn is_echo(&self, index: usize, normalised: f64) -> bool {
        let is_it = |value: &AtomicF32| (f64::from(value.load(Ordering::Relaxed)) - normalised).abs() < 1e-6;
        self.0[index].reported.iter().any(is_it)
    }

    /// A block carries changes of the parameter, the last of them to `normalised`; real-time safe.
    pub fn pass(&self, index: usize, normalised: f64) {
        let slot = &self.0[index];
        let bits = slot.bits.load(Ordering::Acquire);
        if bits == NONE {
            return;
        }
        let blocks = slot.blocks.fetch_add(1, Ordering::Relaxed) + 1;
        // Hosts sometimes pass values on as 32-bit floats.
        let is_it = (f64::from_bits(bits) - normalised).abs() < 1e-6;
        if is_it || blocks >= BLOCKS {
            // A value that the host has set meanwhile stays.
            let _ = slot.bits.compare_exchange(bits, NONE, Ordering::AcqRel, Ordering::Relaxed);
        }
    }

    /// Removes and returns all values, by index in the table.
    pub fn take_all(&self) -> Vec<(usize, f64)> {
        let take = |(index, slot): (usize, &Slot)| {
            let bits = slot.bits.swap(NONE, Ordering::AcqRel);
            (bits != NONE).then(|| (index, f64::from_bits(bits)))
        };
        self.0.iter().enumerate().filter_map(take).collect()
    }

    /// All values, by index in the table; they stay.
    pub fn all(&self) -> Vec<(usize, f64)> {
        (0..self.0.len()).filter_map(|index| Some((index, self.get(index)?))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_pending_until_a_block_carries_it() {
        let pending = PendingValues::default();
        assert_eq!(pending.get(2), None);
        pending.set(2, 0.75);
        assert_eq!(pending.get(2), Some(0.75));
        pending.pass(3, 0.75);
        assert_eq!(pending.get(2), Some(0.75), "another parameter's change is no matter");
        pending.pass(2, f64::from(0.75f32));
        assert_eq!(pending.get(2), None);
    }

    #[test]
    fn automation_over_a_pending_value_wins_in_the_end() {
        let pending = PendingValues::default();
        pending.set(2, 0.75);
        pending.pass(2, 0.1);
        assert_eq!(pending.get(2), Some(0.75), "that block was on its way already");
        pending.pass(2, 0.2);
        assert_eq!(pending.get(2), None);
    }

    #[test]
    fn echo_of_a_reported_value_is_not_pending() {
        let pending = PendingValues::default();
        assert!(!pending.is_echo(2, 0.0), "nothing was told");
        pending.set(2, 0.75);
        pending.report(2, 1.0 / 127.0);
        assert_eq!(pending.get(2), None, "the controller came later");
        assert!(
            pending.is_echo(2, f64::from(1.0f32 / 127.0))
                && !pending.is_echo(2, 0.5)
                && !pending.is_echo(3, 1.0 / 127.0)
        );
        (0..REPORTED).for_each(|_| pending.report(2, 0.5));
        assert!(!pending.is_echo(2, 1.0 / 127.0), "long ago");
    }

    #[test]
    fn pending_values_are_taken_once() {
        let pending = PendingValues::default();
        pending.set(0, 2.0);
        pending.set(5, 0.5);
        assert_eq!(pending.all(), [(0, 1.0), (5, 0.5)]);
        assert_eq!(pending.take_all(), [(0, 1.0), (5, 0.5)]);
        assert!(pending.take_all().is_empty());
    }
}
