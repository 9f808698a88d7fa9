//! Monitoring of one sound while a window asks for it: the drive, the recording, or the output (always, if no window is
//! open).

use std::sync::Arc;

use crate::probe::Listen;

/// Length in seconds of the crossfade between sounds, and of the fades at a recording's ends.
const FADE_S: f32 = 0.01;

/// A recording at the engine's rate, channel by channel.
pub type AuditionClip = Arc<Vec<Vec<f32>>>;

/// The audio thread's part; nothing in it allocates except [`new`](Self::new).
#[derive(Debug)]
pub struct Audition {
    /// The drive over the latency, and the index of its next sample.
    past: Vec<f32>,
    next: usize,
    clip: Option<AuditionClip>,
    /// The clip's next sample.
    at: usize,
    /// Shares of the drive and of the recording; the output has the rest.
    shares: [f32; 2],
    step: f32,
    effects: Option<usize>,
}

impl Audition {
    /// For engines of this latency; `effects` is the output's channel of low-frequency effects, which stays without
    /// auditioned sound.
    pub fn new(sample_rate_hz: f64, latency_samples: usize, effects: Option<usize>) -> Self {
        Self {
            past: vec![0.0; latency_samples.max(1)],
            next: 0,
            clip: None,
            at: 0,
            shares: [0.0; 2],
            step: 1.0 / (FADE_S * sample_rate_hz as f32),
            effects,
        }
    }

    /// Exchanges the recording that can be listened to.
    pub fn swap_clip(&mut self, clip: Option<AuditionClip>) -> Option<AuditionClip> {
        self.at = 0;
        std::mem::replace(&mut self.clip, clip)
    }

    /// Restores the output alone.
    pub fn reset(&mut self) {
        self.past.fill(0.0);
        self.next = 0;
        self.at = 0;
        self.shares = [0.0; 2];
    }

    /// Replaces one block of the output by the monitored sound; `drive` is as long, and ahead of it by the latency.
    pub fn process(&mut self, listen: Listen, drive: &[f32], outputs: &mut [&mut [f32]]) {
        let targets = match listen {
            Listen::Output => [0.0, 0.0],
            Listen::Drive => [1.0, 0.0],
            Listen::Recording => [0.0, 1.0],
        };
        for (index, drive) in drive.iter().enumerate() {
            let drive = std::mem::replace(&mut self.past[self.next], *drive);
            self.next = (self.next + 1) % self.past.len();
            if targets == [0.0; 2] && self.shares == [0.0; 2] {
                self.at = 0;
                continue;
            }
            for (share, target) in self.shares.iter_mut().zip(targets) {
                *share += (target - *share).clamp(-self.step, self.step);
            }
            let rest = (1.0 - self.shares[0] - self.shares[1]).max(0.0);
            let edge = self.edge();
            for (channel, output) in outputs.iter_mut().enumerate() {
                let Some(sample) = output.get_mut(index) else { continue };
                let alone = if self.effects == Some(channel) {
                    0.0
                } else {
                    self.shares[0] * drive + self.shares[1] * edge * self.recorded(channel)
                };
                *sample = rest * *sample + alone;
            }
            self.turn();
        }
    }

    fn recorded(&self, channel: usize) -> f32 {
        let Some(clip) = &self.clip else { return 0.0 };
        let count = clip.len().max(1);
        clip.get(channel % count).and_then(|samples| samples.get(self.at)).copied().unwrap_or(0.0)
    }

    /// The level at the recording's position: it fades in and out.
    fn edge(&self) -> f32 {
        let length = self.clip.as_ref().and_then(|clip| clip.first()).map_or(0, Vec::len);
        let from_end = self.at.min(length.saturating_sub(self.at + 1));
        (from_end as f32 * self.step).min(1.0)
    }

    /// Advances to the recording's next sample, from its end to its start.
    fn turn(&mut self) {
        let length = self.clip.as_ref().and_then(|clip| clip.first()).map_or(0, Vec::len);
        self.at = if self.at + 1 < length { self.at + 1 } else { 0 };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The result for 3,000 samples in blocks of `block`. The drive counts up, the output is -1, the clip 0.25 and 0.5.
    fn heard(listen: Listen, block: usize, effects: Option<usize>) -> [Vec<f32>; 2] {
        let mut audition = Audition::new(1000.0, 100, effects);
        audition.swap_clip(Some(Arc::new(vec![vec![0.25; 700], vec![0.5; 700]])));
        let drive: Vec<f32> = (0..3000).map(|n| n as f32).collect();
        let mut outputs = [vec![-1.0; 3000], vec![-1.0; 3000]];
        let [left, right] = &mut outputs;
        for ((drive, left), right) in drive.chunks(block).zip(left.chunks_mut(block)).zip(right.chunks_mut(block)) {
            audition.process(listen, drive, &mut [left, right]);
        }
        outputs
    }

    #[test]
    fn monitored_sound_is_alone_after_a_fade() {
        for block in [1, 64, 3000] {
            assert_eq!(heard(Listen::Output, block, None), [vec![-1.0; 3000], vec![-1.0; 3000]]);
            let [left, right] = heard(Listen::Drive, block, None);
            // As late as the output is.
            let late = (10..3000).all(|n| (left[n] - (n as f32 - 100.0).max(0.0)).abs() < 1e-3);
            assert!(late && left == right);
            assert!((left[4] + 0.5).abs() < 1e-5, "half the fade: {}", left[4]);
            let [left, right] = heard(Listen::Recording, block, None);
            let inside = |n: &usize| (10..690).contains(&(n % 700));
            assert!((10..3000).filter(inside).all(|n| left[n] == 0.25 && right[n] == 0.5));
            assert!(left[700].abs() < 1e-6 && left[699].abs() < 0.05, "no click where it begins again");
            let steps = left[10..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
            assert!(steps < 0.03, "{steps}");
            assert_eq!(heard(Listen::Drive, block, Some(1))[1][2999], 0.0);
        }
    }

    #[test]
    fn without_a_recording_there_is_silence() {
        let mut audition = Audition::new(1000.0, 0, None);
        let mut output = vec![1.0; 100];
        audition.process(Listen::Recording, &[0.0; 100], &mut [&mut output]);
        assert_eq!(output[99], 0.0);
    }
}
