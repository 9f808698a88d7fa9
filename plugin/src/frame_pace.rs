//! Frame rate of the window: high while something sounds, low once nothing has for long.

/// Frames a second while something sounds or the host plays, and while it rests.
const LIVELY_HZ: f32 = 30.0;
const RESTING_HZ: f32 = 4.0;
/// Seconds of silence before the low rate: the time span of the pictures.
const REST_AFTER_S: f32 = 9.0;

/// Counter of samples until the next frame.
#[derive(Debug, Clone, Default)]
pub struct FramePace {
    since_frame: f32,
    quiet_samples: u64,
}

impl FramePace {
    /// Advances by a block at `sample_rate_hz`, `is_lively` if something sounded or played; returns true if a frame is
    /// due. Real-time safe.
    pub fn process(&mut self, samples: usize, is_lively: bool, sample_rate_hz: f32) -> bool {
        self.since_frame += samples as f32;
        self.quiet_samples = if is_lively { 0 } else { self.quiet_samples.saturating_add(samples as u64) };
        let is_resting = self.quiet_samples as f32 >= REST_AFTER_S * sample_rate_hz;
        let frames_hz = if is_resting { RESTING_HZ } else { LIVELY_HZ };
        let is_due = self.since_frame * frames_hz >= sample_rate_hz;
        if is_due {
            self.since_frame = 0.0;
        }
        is_due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_few_once_nothing_sounds() {
        let mut pace = FramePace::default();
        let mut frames_in = |seconds: usize, is_lively: bool| {
            let blocks = seconds * 48_000 / 480;
            (0..blocks).filter(|_| pace.process(480, is_lively, 48_000.0)).count()
        };
        assert!((24..=30).contains(&frames_in(1, true)));
        assert!(frames_in(8, false) > 180, "what was heard is still to be seen");
        frames_in(2, false);
        assert!((3..=5).contains(&frames_in(1, false)), "stopped and unchanged");
        assert!(frames_in(1, true) >= 24, "at once when it sounds again");
    }
}
