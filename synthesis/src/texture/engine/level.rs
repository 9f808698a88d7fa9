//! Synthesis of one level below the top.

use crate::dsp::Ring;

/// Samples of a level, and its next window.
#[derive(Debug, Clone)]
pub struct Level {
    /// Synthesized samples: the mean of the channels.
    pub samples: Ring,
    /// Next window to match, and when.
    pub next_window: i64,
    pub due: i64,
    /// True if the gate skipped the last window.
    pub closed: bool,
    /// Sample (of level 0) before which this level ignores everything.
    pub floor: i64,
    /// Array size, for a signal of known length.
    pub size: i64,
    /// Slot and window of the last match.
    pub last_match: Option<(usize, usize)>,
    /// Windows in a row that followed one another in the recording.
    pub run: usize,
}

impl Level {
    /// A level that keeps its last `life` samples.
    pub fn new(life: usize) -> Self {
        Self {
            samples: Ring::new(life),
            next_window: 0,
            due: 0,
            closed: true,
            floor: 0,
            size: i64::MAX,
            last_match: None,
            run: 0,
        }
    }

    /// Restarts at sample `origin` of level 0, which is `first` of this one, in an array of `size`.
    pub fn reset(&mut self, origin: i64, first: i64, size: i64) {
        self.samples.reset(first);
        self.closed = true;
        self.floor = origin;
        self.size = size;
        self.last_match = None;
        self.run = 0;
    }
}
