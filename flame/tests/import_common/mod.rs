//! Helpers shared by the tests of reading.
#![allow(dead_code)]

pub mod trees;
pub mod vdb;

/// Draws as tests want them.
pub struct Random(pyrophone_flame::solver::Random);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(pyrophone_flame::solver::Random::new(seed))
    }

    pub fn next(&mut self) -> u64 {
        self.0.bits()
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.0.below(end as u64) as usize
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.0.uniform() > 1.0 - probability
    }

    pub fn pick<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())].clone()
    }
}
