//! Automation that travels beside the audio.

/// The recent past of a value that changes at known samples, so that a stage that works later can use the value that
/// was in force at the sample it works on.
///
/// Values are stored as runs; there is room for a change at every sample of the span, so nothing is ever lost and
/// nothing allocates after `new`.
#[derive(Debug, Clone)]
pub struct Timeline<T> {
    /// Ring of (first sample, value), oldest at `head`.
    runs: Vec<(u64, T)>,
    head: usize,
    len: usize,
    /// Samples pushed since reset.
    end: u64,
}

impl<T: Copy + PartialEq> Timeline<T> {
    /// A timeline that remembers the last `span_samples` samples; before the first push it reads
    /// `initial`.
    pub fn new(span_samples: usize, initial: T) -> Self {
        let runs = vec![(0, initial); span_samples.max(1) + 1];
        Self { runs, head: 0, len: 1, end: 0 }
    }

    /// Forgets everything; returns `initial` until the first push.
    pub fn reset(&mut self, initial: T) {
        self.head = 0;
        self.len = 1;
        self.end = 0;
        self.runs[0] = (0, initial);
    }

    /// Records that `value` applies to the next `samples` samples.
    pub fn push(&mut self, value: T, samples: usize) {
        if samples == 0 {
            return;
        }
        let capacity = self.runs.len();
        let last = (self.head + self.len - 1) % capacity;
        if self.runs[last].1 != value {
            if self.runs[last].0 == self.end {
                self.runs[last].1 = value;
            } else {
                if self.len == capacity {
                    self.head = (self.head + 1) % capacity;
                    self.len -= 1;
                }
                self.runs[(self.head + self.len) % capacity] = (self.end, value);
                self.len += 1;
            }
        }
        self.end += samples as u64;
    }

    /// The value at `sample` (0 = the first after reset): the oldest known value before the span, the newest one from
    /// the end on.
    pub fn value_at(&self, sample: u64) -> T {
        self.run_at(sample).0
    }

    /// The value at `sample`, and the sample up to which it is known to apply.
    pub fn run_at(&self, sample: u64) -> (T, u64) {
        // Not a remainder, because this is called several times per window.
        let run = |i: usize| {
            let at = self.head + i;
            self.runs[if at < self.runs.len() { at } else { at - self.runs.len() }]
        };
        let (mut low, mut high) = (0, self.len);
        while high - low > 1 {
            let middle = (low + high) / 2;
            if run(middle).0 <= sample { low = middle } else { high = middle }
        }
        let end = if high < self.len { run(high).0 } else { u64::MAX };
        (run(low).1, end)
    }

    /// Samples pushed since reset.
    pub fn end(&self) -> u64 {
        self.end
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_back_every_sample_of_the_span_whatever_the_pushes() {
        let mut timeline = Timeline::new(50, -1);
        let mut plain = Vec::new();
        for step in 0..400usize {
            let (value, samples) = ((step * step % 7) as i32, step * 5 % 4);
            timeline.push(value, samples);
            plain.extend(std::iter::repeat_n(value, samples));
            for (sample, expected) in plain.iter().enumerate().skip(plain.len().saturating_sub(50)) {
                let (value, end) = timeline.run_at(sample as u64);
                assert_eq!(value, *expected, "step {step} sample {sample}");
                let run = &plain[sample..plain.len().min(end as usize)];
                assert!(!run.is_empty() && run.iter().all(|x| x == expected));
            }
        }
        assert_eq!(timeline.end(), plain.len() as u64);
    }

    #[test]
    fn reset_is_fresh() {
        let mut timeline = Timeline::new(4, 0);
        timeline.push(3, 9);
        timeline.push(4, 1);
        timeline.reset(7);
        assert_eq!((timeline.value_at(0), timeline.value_at(99), timeline.end()), (7, 7, 0));
    }
}
