//! Random draws from the seed.

use pyrophone_synthesis::dsp::White;

/// A sequence of draws.
#[derive(Debug)]
pub struct Order {
    noise: White,
    next: i64,
}

impl Order {
    /// The sequence of a seed.
    pub fn new(seed: u32) -> Self {
        Self { noise: White::new(seed, 0x4C49_5354), next: 0 }
    }

    fn draw(&mut self) -> f64 {
        self.next += 1;
        self.noise.sample_at(self.next)
    }

    /// Shuffles `items`.
    pub fn shuffle<T>(&mut self, items: &mut Vec<T>) {
        let mut keyed: Vec<(f64, T)> = items.drain(..).map(|item| (self.draw(), item)).collect();
        keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        items.extend(keyed.into_iter().map(|(_, item)| item));
    }

    /// A name without meaning: six hexadecimal digits.
    pub fn code(&mut self) -> String {
        format!("{:06x}", self.draw().to_bits() >> 12 & 0xFF_FFFF)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_has_its_own_order_and_every_item_stays() {
        let order = |seed: u32| {
            let mut items: Vec<u32> = (0..40).collect();
            Order::new(seed).shuffle(&mut items);
            items
        };
        assert_eq!(order(1), order(1));
        assert_ne!(order(1), order(2));
        let mut sorted = order(3);
        sorted.sort_unstable();
        assert_eq!(sorted, (0..40).collect::<Vec<_>>());
        let mut names = Order::new(1);
        let mut codes: Vec<String> = (0..50).map(|_| names.code()).collect();
        codes.sort();
        codes.dedup();
        assert_eq!(codes.len(), 50);
    }
}
