//! The recent past of a signal, in one piece.

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
