//! Fixed delays.

/// Delays one channel by a fixed number of samples.
#[derive(Debug, Clone)]
pub struct Delay<T> {
    buffer: Vec<T>,
    at: usize,
}

impl<T: Copy + Default> Delay<T> {
    /// A delay of `samples`, 0 or more.
    pub fn new(samples: usize) -> Self {
        Self { buffer: vec![T::default(); samples], at: 0 }
    }

    /// Resets everything to zero.
    pub fn reset(&mut self) {
        self.buffer.fill(T::default());
        self.at = 0;
    }

    /// Delays `block` in place.
    pub fn process(&mut self, mut block: &mut [T]) {
        let length = self.buffer.len();
        while length > 0 && !block.is_empty() {
            let run = block.len().min(length - self.at);
            let (now, later) = block.split_at_mut(run);
            now.swap_with_slice(&mut self.buffer[self.at..self.at + run]);
            self.at = (self.at + run) % length;
            block = later;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_by_its_length_and_resets() {
        for samples in [0, 1, 7] {
            let mut delay = Delay::new(samples);
            let mut block: Vec<i32> = (1..=20).collect();
            delay.process(&mut block[..3]);
            delay.process(&mut block[3..]);
            let expected: Vec<i32> = (1..=20).map(|x| (x - samples as i32).max(0)).collect();
            assert_eq!(block, expected);
            delay.reset();
            let mut zeros = vec![0; 10];
            delay.process(&mut zeros);
            assert_eq!(zeros, [0; 10]);
        }
    }
}
