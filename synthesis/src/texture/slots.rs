//! The recordings of an engine, and the choice between them for each window.
//!
//! Synthesis uses one scale, that of the first recording that is not silent: windows of another one are brought to it
//! by the ratio of the two matched signals, and are output separately.

use std::sync::Arc;

use crate::controls::{RecordingControls, SLOTS};
use crate::dsp::White;

/// Seconds over which one recording replaces another, window by window.
pub const CROSSFADE_S: f64 = 0.05;

/// Noise streams that no other stage uses: for the choice of a window's recording, and for the time at which it follows
/// the controls.
const BLEND_STREAM: u32 = 0x424C_4E44;
const LATE_STREAM: u32 = 0x4C41_5445;

/// Recordings by slot.
#[derive(Debug)]
pub struct Slots<T> {
    recordings: [Option<Arc<T>>; SLOTS],
    /// Root mean square of each recording's matched signal; 0 for an empty slot.
    matched_rms: [f64; SLOTS],
    /// Factor from the scale that is matched on to a recording's own.
    scales: [f64; SLOTS],
    /// Slot of the recording whose scale it is.
    reference: Option<usize>,
}

impl<T> Default for Slots<T> {
    fn default() -> Self {
        Self { recordings: Default::default(), matched_rms: [0.0; SLOTS], scales: [1.0; SLOTS], reference: None }
    }
}

impl<T> Slots<T> {
    /// Exchanges the recording of a slot; `matched_rms` is that of the new one's matched signal, 0 without one.
    pub fn swap(&mut self, slot: usize, recording: Option<Arc<T>>, matched_rms: f64) -> Option<Arc<T>> {
        let old = std::mem::replace(&mut self.recordings[slot], recording);
        self.matched_rms[slot] = matched_rms;
        let is_audible = |slot: &usize| self.matched_rms[*slot] > 0.0;
        let is_there = |slot: &usize| self.recordings[*slot].is_some();
        self.reference = (0..SLOTS).find(is_audible).or_else(|| (0..SLOTS).find(is_there));
        let reference = self.reference.map_or(0.0, |slot| self.matched_rms[slot]);
        self.scales = self.matched_rms.map(|own| if own > 0.0 && reference > 0.0 { own / reference } else { 1.0 });
        old
    }

    /// Takes a recording out temporarily, so that the engine can be changed meanwhile.
    pub fn take_out(&mut self, slot: usize) -> Option<Arc<T>> {
        self.recordings[slot].take()
    }

    /// Puts back the result of [`take_out`](Self::take_out).
    pub fn put_back(&mut self, slot: usize, recording: Arc<T>) {
        self.recordings[slot] = Some(recording);
    }

    /// The recording of a slot.
    pub fn get(&self, slot: usize) -> Option<&T> {
        self.recordings.get(slot)?.as_deref()
    }

    /// Slot of the recording on whose scale windows are matched.
    pub fn reference(&self) -> Option<usize> {
        self.reference
    }

    /// Factor from the scale that is matched on to that of a slot's recording.
    pub fn scale(&self, slot: usize) -> f64 {
        self.scales[slot]
    }

    /// The slot of the windows at `index` among the coarsest.
    pub fn choose(&self, recordings: &RecordingControls, seed: u32, index: i64) -> usize {
        match recordings.other(|slot| self.get(slot).is_some()) {
            Some((slot, share)) if draw(seed, BLEND_STREAM, index) < share => slot,
            _ => recordings.first(),
        }
    }
}

/// Share of the crossfade, 0-1, after which the windows at `index` among the coarsest follow another choice of
/// recordings.
pub fn lateness(seed: u32, index: i64) -> f64 {
    draw(seed, LATE_STREAM, index)
}

fn draw(seed: u32, stream: u32, index: i64) -> f64 {
    0.5 + 0.5 * White::new(seed, stream).unit(index)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_even_and_do_not_depend_on_one_another() {
        let count = 20_000;
        let draws = |stream: u32| (0..count).map(|index| draw(7, stream, index)).collect::<Vec<f64>>();
        let (blend, late) = (draws(BLEND_STREAM), draws(LATE_STREAM));
        for share in [0.1, 0.5, 0.9] {
            let part = |draws: &[f64]| draws.iter().filter(|draw| **draw < share).count() as f64 / count as f64;
            assert!((part(&blend) - share).abs() < 0.01 && (part(&late) - share).abs() < 0.01, "{share}");
        }
        let both = blend.iter().zip(&late).filter(|(a, b)| **a < 0.5 && **b < 0.5).count() as f64 / count as f64;
        assert!((both - 0.25).abs() < 0.01, "{both}");
        assert!(blend.iter().all(|draw| (0.0..1.0).contains(draw) || *draw == 1.0));
    }

    #[test]
    fn the_first_that_is_not_silent_sets_the_scale() {
        let mut slots = Slots::default();
        for (slot, matched_rms) in [(1, 0.0), (2, 0.5), (3, 2.0)] {
            slots.swap(slot, Some(Arc::new(())), matched_rms);
        }
        assert_eq!((slots.reference(), slots.scale(1), slots.scale(2), slots.scale(3)), (Some(2), 1.0, 1.0, 4.0));
        slots.swap(2, None, 0.0);
        assert_eq!((slots.reference(), slots.scale(3)), (Some(3), 1.0));
        slots.swap(3, None, 0.0);
        assert_eq!(slots.reference(), Some(1), "silent, but there");
    }

    #[test]
    fn empty_slots_have_no_share() {
        let slots = Slots::<()>::default();
        let recordings = RecordingControls { slot: 1, second: 2, blend: 1.0 };
        assert!((0..100).all(|index| slots.choose(&recordings, 0, index) == 1));
        assert_eq!(slots.choose(&RecordingControls { slot: 99, ..recordings }, 0, 0), SLOTS - 1);
        assert_eq!(slots.reference(), None);
    }
}
