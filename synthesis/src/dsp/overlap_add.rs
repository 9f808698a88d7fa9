//! Sums of overlapping pieces.

/// A sum of overlapping pieces, read in order.
#[derive(Debug)]
pub(crate) struct OverlapAdd {
    ring: Vec<f64>,
    /// Position of the next sample to read.
    front: i64,
}

impl OverlapAdd {
    /// A sum whose pieces may reach `span` samples past the next one to read.
    pub fn new(span: usize) -> Self {
        Self { ring: vec![0.0; span], front: 0 }
    }

    /// Clears the sum; the next sample to read is at `position`.
    pub fn reset(&mut self, position: i64) {
        self.ring.fill(0.0);
        self.front = position;
    }

    /// Adds a piece whose first sample is at `start`; samples that come too late are dropped.
    pub fn add(&mut self, start: i64, piece: impl ExactSizeIterator<Item = f64>) {
        let skip = (self.front - start).max(0) as usize;
        let room = (self.front - start + self.ring.len() as i64).max(0) as usize - skip;
        let mut at = self.index(start + skip as i64);
        for value in piece.skip(skip).take(room) {
            self.ring[at] += value;
            at += 1;
            if at == self.ring.len() {
                at = 0;
            }
        }
    }

    /// Reads the next samples.
    pub fn read(&mut self, out: &mut [f64]) {
        let mut at = self.index(self.front);
        for sample in out.iter_mut() {
            *sample = std::mem::take(&mut self.ring[at]);
            at += 1;
            if at == self.ring.len() {
                at = 0;
            }
        }
        self.front += out.len() as i64;
    }

    fn index(&self, position: i64) -> usize {
        position.rem_euclid(self.ring.len() as i64) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overlap_sums_and_drops_what_is_late() {
        let mut overlap = OverlapAdd::new(8);
        overlap.reset(-3);
        overlap.add(-5, [1.0, 1.0, 1.0, 1.0].into_iter());
        overlap.add(-2, [2.0; 7].into_iter());
        let mut out = [0.0; 6];
        overlap.read(&mut out);
        assert_eq!(out, [1.0, 3.0, 2.0, 2.0, 2.0, 2.0]);
        overlap.read(&mut out);
        assert_eq!(out, [2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
