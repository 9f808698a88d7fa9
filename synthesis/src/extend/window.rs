//! Windows, their grid, and the buffers that follow it.
//!
//! Window k is a triangle of half-width h centred at sample k h of the host's timeline (§4): the windows sum to 1, and
//! their positions do not depend on the start of playback.

/// Triangle of half-width `half_width`, peak 1 at index `half_width`; the first of its
/// 2 `half_width` values is 0.
pub fn triangle(half_width: usize) -> Vec<f64> {
    let h = half_width as f64;
    (0..2 * half_width).map(|i| 1.0 - (i as f64 - h).abs() / h).collect()
}

/// Samples from the latest position that is `offset` plus a multiple of `hop` to `position`.
pub(crate) fn into_hop(position: i64, offset: usize, hop: usize) -> usize {
    (position - offset as i64).rem_euclid(hop as i64) as usize
}

/// The latest samples of a signal, read by their position on the timeline.
#[derive(Debug)]
pub(crate) struct RingBuffer {
    data: Vec<f64>,
    /// Number of samples that must stay readable.
    keep: usize,
    len: usize,
    /// Position of the sample after the newest.
    end: i64,
}

impl RingBuffer {
    /// A buffer of at least the newest `keep` samples.
    pub fn new(keep: usize) -> Self {
        Self { data: vec![0.0; 3 * keep], keep, len: keep, end: 0 }
    }

    /// Zeros everywhere before `position`.
    pub fn reset(&mut self, position: i64) {
        self.data[..self.keep].fill(0.0);
        self.len = self.keep;
        self.end = position;
    }

    /// Appends at most `keep` samples.
    pub fn push(&mut self, samples: &[f64]) {
        if self.len + samples.len() > self.data.len() {
            self.data.copy_within(self.len - self.keep..self.len, 0);
            self.len = self.keep;
        }
        self.data[self.len..self.len + samples.len()].copy_from_slice(samples);
        self.len += samples.len();
        self.end += samples.len() as i64;
    }

    /// Position of the sample after the newest.
    pub fn end(&self) -> i64 {
        self.end
    }

    /// `count` samples from `start` on, which lie within the newest `keep`.
    pub fn slice(&self, start: i64, count: usize) -> &[f64] {
        let from = self.len - (self.end - start) as usize;
        &self.data[from..from + count]
    }
}

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
    pub fn take(&mut self, out: &mut [f64]) {
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
    fn triangles_sum_to_one() {
        for half_width in [1, 7, 500] {
            let window = triangle(half_width);
            for i in 0..half_width {
                assert!((window[i] + window[i + half_width] - 1.0).abs() < 1e-15);
            }
        }
    }

    #[test]
    fn the_grid_is_absolute() {
        assert_eq!(into_hop(0, 0, 10), 0);
        assert_eq!(into_hop(9, 0, 10), 9);
        assert_eq!(into_hop(-1, 0, 10), 9);
        assert_eq!(into_hop(-25, 3, 10), 2);
    }

    #[test]
    fn history_reads_what_was_pushed() {
        let mut history = RingBuffer::new(20);
        history.reset(-7);
        let mut next = 0.0;
        for step in 0..200 {
            let samples: Vec<f64> = (0..step % 21).map(|i| next + i as f64).collect();
            history.push(&samples);
            next += samples.len() as f64;
            let newest = history.slice(history.end() - 20, 20);
            for (i, value) in newest.iter().enumerate() {
                assert_eq!(*value, (next - 20.0 + i as f64).max(0.0), "step {step}");
            }
        }
    }

    #[test]
    fn overlap_sums_and_drops_what_is_late() {
        let mut overlap = OverlapAdd::new(8);
        overlap.reset(-3);
        overlap.add(-5, [1.0, 1.0, 1.0, 1.0].into_iter());
        overlap.add(-2, [2.0; 7].into_iter());
        let mut out = [0.0; 6];
        overlap.take(&mut out);
        assert_eq!(out, [1.0, 3.0, 2.0, 2.0, 2.0, 2.0]);
        overlap.take(&mut out);
        assert_eq!(out, [2.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
    }
}
