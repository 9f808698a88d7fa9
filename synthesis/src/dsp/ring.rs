//! The recent past of a signal, by index.

/// Samples of a signal around the present, by their index. Samples never written are 0.
#[derive(Debug, Clone)]
pub struct Ring {
    data: Vec<f64>,
    mask: i64,
    /// One past the last sample that may be non-zero.
    ready: i64,
}

impl Ring {
    /// A ring that remembers at least `samples`.
    pub fn new(samples: usize) -> Self {
        let size = samples.next_power_of_two();
        Self { data: vec![0.0; size], mask: size as i64 - 1, ready: 0 }
    }

    /// Resets to zero; nothing before `index` will be requested.
    pub fn reset(&mut self, index: i64) {
        self.data.fill(0.0);
        self.ready = index;
    }

    /// Prepares the samples before `end` for writing, as zeros.
    pub fn prepare(&mut self, end: i64) {
        while self.ready < end {
            self.data[(self.ready & self.mask) as usize] = 0.0;
            self.ready += 1;
        }
    }

    /// Writes a sample.
    pub fn set(&mut self, index: i64, value: f64) {
        self.prepare(index + 1);
        self.data[(index & self.mask) as usize] = value;
    }

    /// Adds products to the samples from `first` on, which must be prepared and no more than its memory.
    pub fn add_products(&mut self, first: i64, factors: &[f64], samples: &[f64]) {
        let start = (first & self.mask) as usize;
        let whole = factors.len().min(self.data.len() - start);
        let add = |sums: &mut [f64], factors: &[f64], samples: &[f64]| {
            for ((sum, factor), sample) in sums.iter_mut().zip(factors).zip(samples) {
                *sum += factor * sample;
            }
        };
        add(&mut self.data[start..], &factors[..whole], samples);
        if whole < factors.len() {
            add(&mut self.data, &factors[whole..], &samples[whole..]);
        }
    }

    /// A sample of the recent past.
    #[inline]
    pub fn get(&self, index: i64) -> f64 {
        if index < self.ready { self.data[(index & self.mask) as usize] } else { 0.0 }
    }

    /// Copies the samples from `first` on; those before `floor` and from `ready` on read as 0.
    pub fn copy(&self, first: i64, floor: i64, out: &mut [f64]) {
        let end = first + out.len() as i64;
        let from = first.max(floor).min(end);
        let to = self.ready.clamp(from, end);
        let (before, rest) = out.split_at_mut((from - first) as usize);
        let (known, after) = rest.split_at_mut((to - from) as usize);
        before.fill(0.0);
        after.fill(0.0);
        let start = (from & self.mask) as usize;
        let whole = known.len().min(self.data.len() - start);
        let (head, wrapped) = known.split_at_mut(whole);
        head.copy_from_slice(&self.data[start..start + whole]);
        wrapped.copy_from_slice(&self.data[..wrapped.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_across_the_seam_with_zeros_outside() {
        let mut ring = Ring::new(16);
        ring.reset(5);
        for i in 5..30 {
            ring.set(i, i as f64);
        }
        let mut out = [9.0; 12];
        ring.copy(20, 22, &mut out);
        let expected = [0., 0., 22., 23., 24., 25., 26., 27., 28., 29., 0., 0.];
        assert_eq!(out, expected);
        ring.copy(40, 0, &mut out);
        assert_eq!(out, [0.0; 12]);
        ring.prepare(34);
        ring.add_products(30, &[1.0, 0.5, 3.0], &[2.0, 1.0, 0.5]);
        let mut sums = [9.0; 5];
        ring.copy(29, 0, &mut sums);
        assert_eq!(sums, [29.0, 2.0, 0.5, 1.5, 0.0], "from the last place on to the first");
    }
}
