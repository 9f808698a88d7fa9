//! Gate: silence in, silence out.
//!
//! Nothing is near to silence: the search would return the recording's quietest window. Time is therefore divided into
//! frames of one top-level window; a frame is silent if the top level has been below the threshold for longer than the
//! look-ahead and is not about to rise.

/// Frames whose verdict is remembered. The finest level asks for it up to 2 (F + 1) + 2 frames late: 16 for the longest
/// feature, F = 6.
const FRAMES: usize = 64;

/// Verdicts on frames, by frame number.
#[derive(Debug, Clone)]
pub struct Gate {
    open: Vec<bool>,
    /// Latest frame decided on.
    decided: Option<i64>,
    /// Latest top-level sample at or above the threshold.
    last_loud: Option<i64>,
    /// Top-level samples for which it stays open.
    hold: i64,
}

impl Gate {
    /// A gate that closes after `hold` top-level samples below the threshold.
    pub fn new(hold: usize) -> Self {
        Self { open: vec![false; FRAMES], decided: None, last_loud: None, hold: hold as i64 }
    }

    /// Resets as if silence had lasted for ever.
    pub fn reset(&mut self) {
        self.open.fill(false);
        self.decided = None;
        self.last_loud = None;
    }

    /// Adds top-level sample `index`; a `threshold` of 0 is always exceeded.
    pub fn push(&mut self, index: i64, magnitude: f64, threshold: f64) {
        if magnitude >= threshold {
            self.last_loud = Some(index);
        }
    }

    /// Decides on `frame`, which begins at top-level sample `start`, from everything known now; a frame is decided on
    /// once.
    pub fn decide(&mut self, frame: i64, start: i64, threshold: f64) {
        if self.decided == Some(frame) {
            return;
        }
        self.decided = Some(frame);
        let open = threshold <= 0.0 || self.last_loud.is_some_and(|loud| loud >= start - self.hold);
        self.open[frame.rem_euclid(FRAMES as i64) as usize] = open;
    }

    /// The verdict on a recent frame.
    pub fn is_open(&self, frame: i64) -> bool {
        self.open[frame.rem_euclid(FRAMES as i64) as usize]
    }
}
