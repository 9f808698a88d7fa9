//! Boxes that a bounded search has postponed, to return to the nearest.

use super::tree::Child;

/// A box of one of the shells.
pub type TreePosition = (u8, Child);

/// Boxes with their bounds, in no order. Adding one costs next to nothing, and happens up to sixteen times as often as
/// removing the nearest, which searches all of them.
#[derive(Debug)]
pub struct Frontier {
    /// Bounds' bits: those of numbers that are not negative are in the numbers' order.
    bounds: Vec<u32>,
    positions: Vec<TreePosition>,
    /// Number of boxes stored.
    len: usize,
}

/// Number of bounds compared together.
const CHUNK: usize = 32;

impl Frontier {
    /// A frontier for `capacity` boxes; further ones are dropped.
    pub fn new(capacity: usize) -> Self {
        Self { bounds: vec![0; capacity], positions: vec![(0, Child::NONE); capacity], len: 0 }
    }

    /// Forgets all.
    #[inline(always)]
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Remembers a box; `bound` is not negative.
    #[inline(always)]
    pub fn push(&mut self, bound: f32, position: TreePosition) {
        if let (Some(room), Some(room_for_position)) = (self.bounds.get_mut(self.len), self.positions.get_mut(self.len))
        {
            (*room, *room_for_position) = (bound.to_bits(), position);
            self.len += 1;
        }
    }

    /// Removes the latest box whose bound is at most `limit`; those skipped on the way are dropped.
    #[inline(always)]
    pub fn pop_latest(&mut self, limit: f32) -> Option<(f32, TreePosition)> {
        while self.len > 0 {
            self.len -= 1;
            let bound = f32::from_bits(self.bounds[self.len]);
            if bound <= limit {
                return Some((bound, self.positions[self.len]));
            }
        }
        None
    }

    /// Removes the nearest box, if its bound is at most `limit`.
    #[inline(always)]
    pub fn pop_nearest(&mut self, limit: f32) -> Option<(f32, TreePosition)> {
        let bounds = &mut self.bounds[..self.len];
        let least = bounds.iter().copied().min().filter(|least| f32::from_bits(*least) <= limit)?;
        let mut at = 0;
        for chunk in bounds.chunks(CHUNK) {
            // Without early exit, so that a chunk is compared at once.
            if chunk.iter().fold(false, |found, bound| found | (*bound == least)) {
                at += chunk.iter().position(|bound| *bound == least).unwrap_or(0);
                break;
            }
            at += chunk.len();
        }
        self.len -= 1;
        bounds[at] = bounds[self.len];
        let position = self.positions[at];
        self.positions[at] = self.positions[self.len];
        Some((f32::from_bits(least), position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::texture::search::tree::NodeKind;

    #[test]
    fn the_nearest_comes_out_first() {
        let mut frontier = Frontier::new(100);
        let bound = |i: u32| (i * 37 % 101) as f32 * 0.5;
        (0..100).for_each(|i| frontier.push(bound(i), (1, Child::of_node(i as usize))));
        frontier.push(0.0, (1, Child::of_node(100)));
        let mut expected: Vec<f32> = (0..100).map(bound).collect();
        expected.sort_by(f32::total_cmp);
        for expected in expected {
            let (found, (_, child)) = frontier.pop_nearest(f32::INFINITY).unwrap();
            assert_eq!(found, expected);
            let NodeKind::Node(node) = child.kind() else { panic!("{child:?}") };
            assert_eq!(bound(node as u32), expected);
        }
        assert!(frontier.pop_nearest(f32::INFINITY).is_none());
    }

    #[test]
    fn boxes_beyond_the_limit_are_not_returned() {
        let mut frontier = Frontier::new(4);
        for (i, bound) in [3.0, 1.0, 2.0, 4.0].into_iter().enumerate() {
            frontier.push(bound, (0, Child::of_node(i)));
        }
        assert_eq!(frontier.pop_nearest(0.5), None);
        assert_eq!(frontier.pop_latest(2.5), Some((2.0, (0, Child::of_node(2)))));
        assert_eq!(frontier.pop_latest(2.5), Some((1.0, (0, Child::of_node(1)))));
        assert_eq!(frontier.pop_latest(2.5), None);
    }
}
