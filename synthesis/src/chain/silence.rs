//! Duration of the sound after the input has fallen silent.

/// Silence of input and output, and the tail after it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Silence {
    /// Samples for which input and output have been silent.
    samples: usize,
    /// Samples that may still sound after the input has fallen silent.
    pub tail_samples: usize,
    /// True if it also sounds over silence: a flame burns, or texture's gate is off.
    pub is_endless: bool,
    /// True if it sounds without any input.
    pub burns: bool,
}

impl Silence {
    /// Counts a block of input by its largest magnitude.
    pub fn add_input(&mut self, peak: f32) {
        self.samples = if peak == 0.0 { self.samples } else { 0 };
    }

    /// Counts `samples` of output by their largest magnitude.
    pub fn add_output(&mut self, peak: f64, samples: usize) {
        self.samples = if peak == 0.0 { self.samples.saturating_add(samples) } else { 0 };
    }

    /// True if input and output have been silent for longer than the tail, and only an input can change that.
    pub fn is_over(&self) -> bool {
        !self.burns && self.samples > self.tail_samples
    }
}
