//! Bursts that notes light within a block.

/// Most bursts that one block may start; more would make no audible difference.
const MOST: usize = 16;

/// Samples of a block at which a burst starts, and its level, 0-1.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoteBursts {
    bursts: [(usize, f32); MOST],
    count: usize,
}

impl NoteBursts {
    /// Lights one at a sample of the block; real-time safe.
    pub fn push(&mut self, sample: usize, level: f32) {
        if let Some(light) = self.bursts.get_mut(self.count) {
            *light = (sample, level);
            self.count += 1;
        }
    }

    /// The level of the last burst that starts at `sample`, if any does.
    pub fn level_at(&self, sample: usize) -> Option<f32> {
        self.bursts[..self.count].iter().rev().find(|(at, _)| *at == sample).map(|(_, level)| *level)
    }

    /// The first sample after `sample` at which a burst starts, if any does.
    pub fn next_after(&self, sample: usize) -> Option<usize> {
        self.bursts[..self.count].iter().map(|(at, _)| *at).filter(|at| *at > sample).min()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bursts_are_ordered_by_sample_and_surplus_ones_dropped() {
        let mut bursts = NoteBursts::default();
        assert_eq!((bursts.level_at(0), bursts.next_after(0)), (None, None));
        for (sample, level) in [(7, 0.5), (0, 0.25), (7, 0.75)] {
            bursts.push(sample, level);
        }
        assert_eq!((bursts.level_at(0), bursts.level_at(7), bursts.level_at(8)), (Some(0.25), Some(0.75), None));
        assert_eq!((bursts.next_after(0), bursts.next_after(7)), (Some(7), None));
        (0..100).for_each(|n| bursts.push(n, 1.0));
        assert_eq!(bursts.next_after(50), None, "beyond the most that a block starts");
    }
}
