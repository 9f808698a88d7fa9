//! An engine's synthesized sound that has not been read yet, by recording: the recordings are processed separately from
//! here on.

use std::ops::Range;

use crate::controls::SLOTS;
use crate::dsp::Ring;

/// Level 0 of every output channel, by slot.
#[derive(Debug)]
pub struct Outputs {
    rings: Vec<Vec<Ring>>,
    /// One past the last sample that something was added to, by slot.
    ends: [i64; SLOTS],
    /// Index of the first sample after reset.
    origin: i64,
}

impl Outputs {
    /// Rings for `channels`, with a memory of `samples`.
    pub fn new(channels: usize, samples: usize) -> Self {
        let rings = vec![vec![Ring::new(samples); channels]; SLOTS];
        Self { rings, ends: [i64::MIN; SLOTS], origin: 0 }
    }

    /// Silent from sample `origin` on.
    pub fn reset(&mut self, origin: i64) {
        self.rings.iter_mut().flatten().for_each(|ring| ring.reset(origin));
        self.ends = [i64::MIN; SLOTS];
        self.origin = origin;
    }

    /// Prepares the samples before `end` for addition.
    pub fn prepare(&mut self, end: i64) {
        self.rings.iter_mut().flatten().for_each(|ring| ring.prepare(end));
    }

    /// The channels of a slot, prepared for additions to the samples before `end`.
    pub fn channels_mut(&mut self, slot: usize, end: i64) -> &mut [Ring] {
        self.ends[slot] = self.ends[slot].max(end);
        &mut self.rings[slot]
    }

    /// Channels of each slot.
    pub fn channels(&self) -> usize {
        self.rings.first().map_or(0, Vec::len)
    }

    /// Writes the samples of a slot from `ready` on to the `range` of every channel; zeros if there are none.
    pub fn copy(&self, slot: usize, ready: i64, range: Range<usize>, channels: &mut [&mut [f64]]) {
        for (channel, ring) in channels.iter_mut().zip(&self.rings[slot]) {
            let part = &mut channel[range.clone()];
            if self.ends[slot] > ready {
                ring.copy(ready, self.origin, part);
            } else {
                part.fill(0.0);
            }
        }
    }

    /// Adds the samples of all slots from `ready` on up, in the `range` of every channel.
    pub fn sum(&self, ready: i64, range: Range<usize>, channels: &mut [&mut [f64]]) {
        let mut sounding = (0..SLOTS).filter(|slot| self.ends[*slot] > ready);
        self.copy(sounding.next().unwrap_or(0), ready, range.clone(), channels);
        for slot in sounding {
            for (channel, ring) in channels.iter_mut().zip(&self.rings[slot]) {
                for (index, sample) in (ready..).zip(&mut channel[range.clone()]) {
                    *sample += if index < self.origin { 0.0 } else { ring.get(index) };
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slots_are_kept_apart_and_add_up() {
        let mut outputs = Outputs::new(1, 64);
        outputs.reset(10);
        outputs.prepare(30);
        for slot in [1, 3] {
            outputs.channels_mut(slot, 25)[0].add_products(20, &[1.0], &[1.0 + slot as f64]);
        }
        let (mut one, mut all) = ([9.0; 8], [9.0; 8]);
        outputs.copy(3, 18, 1..7, &mut [&mut one]);
        outputs.sum(18, 1..7, &mut [&mut all]);
        assert_eq!((one, all), ([9., 0., 0., 4., 0., 0., 0., 9.], [9., 0., 0., 6., 0., 0., 0., 9.]));
        outputs.copy(0, 18, 0..8, &mut [&mut one]);
        assert_eq!(one, [0.0; 8]);
    }
}
