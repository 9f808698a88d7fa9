//! The audible voice, and the one that takes over after a jump.

use super::bus::Transport;
use super::voice::Voice;
use crate::Controls;

/// Hosts that derive their position from beats round it; this much is no jump.
const POSITION_TOLERANCE_SAMPLES: u64 = 1;

/// Two voices and the position that they play at.
pub(super) struct Voices {
    voices: [Voice; 2],
    /// Index of the audible voice.
    active: usize,
    /// Samples since a jump, until the voice that it started has taken over.
    takeover: Option<usize>,
    /// True if a jump came while another was in progress: restart as soon as that is over.
    restart_pending: bool,
    /// Position of the next sample, once anchored.
    position: Option<i64>,
    crossfade_samples: usize,
}

impl Voices {
    /// Two equal voices, before the first block.
    pub fn new(voices: [Voice; 2], crossfade_samples: usize) -> Self {
        Self { voices, active: 0, takeover: None, restart_pending: false, position: None, crossfade_samples }
    }

    /// Forgets the position; the voices themselves are reset once they start.
    pub fn reset(&mut self) {
        self.active = 0;
        self.takeover = None;
        self.restart_pending = false;
        self.position = None;
    }

    /// One of them: what depends on structure and recordings alone is the same in both.
    pub fn either(&self) -> &Voice {
        &self.voices[0]
    }

    /// Both, to be given what they share.
    pub fn both(&mut self) -> &mut [Voice; 2] {
        &mut self.voices
    }

    /// The audible one.
    pub fn audible(&self) -> &Voice {
        &self.voices[self.active]
    }

    /// The audible one, and the other.
    pub fn audible_and_other(&mut self) -> (&mut Voice, &mut Voice) {
        let [first, second] = &mut self.voices;
        if self.active == 0 { (first, second) } else { (second, first) }
    }

    /// Samples of the crossfade after a jump.
    pub fn crossfade_samples(&self) -> usize {
        self.crossfade_samples
    }

    /// Anchors the position, or notices a jump.
    pub fn follow_transport(&mut self, transport: Transport) {
        let Some(position) = self.position else {
            let position = transport.position.unwrap_or(0);
            self.voices[self.active].reset(position);
            self.position = Some(position);
            return;
        };
        if let (true, Some(reported)) = (transport.playing, transport.position)
            && reported.abs_diff(position) > POSITION_TOLERANCE_SAMPLES
        {
            self.position = Some(reported);
            if self.takeover.is_some() {
                self.restart_pending = true;
            } else {
                self.start_over();
            }
        }
    }

    /// Samples until a takeover in progress is complete.
    pub fn until_takeover(&self) -> Option<usize> {
        self.takeover.map(|age| self.takeover_samples() - age)
    }

    /// Processes one block, and crossfades in a takeover; returns the newest voice, which plays at the present position.
    pub fn process(&mut self, main: &[&[f64]], sidechain: &[&[f64]], controls: &Controls, samples: usize) -> &Voice {
        let (latency, fade) = (self.latency_samples(), self.crossfade_samples);
        let takeover = self.takeover;
        let (audible, next) = self.audible_and_other();
        audible.process(main, sidechain, controls, samples);
        if let Some(age) = takeover {
            next.process(main, sidechain, controls, samples);
            let ramp = |i: usize| ((age + i) as f64 - latency as f64 + 1.0) / fade as f64;
            audible.layers.fade_to(&next.layers, samples, ramp);
            self.takeover = Some(age + samples);
        }
        self.position = self.position.map(|position| position.wrapping_add(samples as i64));
        &self.voices[if takeover.is_some() { 1 - self.active } else { self.active }]
    }

    /// Lets the voice that a jump started take over, if it is time.
    pub fn finish_takeover(&mut self) {
        if self.takeover.is_some_and(|age| age >= self.takeover_samples()) {
            self.active = 1 - self.active;
            self.takeover = None;
            if self.restart_pending {
                self.start_over();
            }
        }
    }

    /// Starts the other voice at the present position.
    fn start_over(&mut self) {
        self.restart_pending = false;
        self.voices[1 - self.active].reset(self.position.unwrap_or(0));
        self.takeover = Some(0);
    }

    fn latency_samples(&self) -> usize {
        self.voices[0].latency_samples()
    }

    /// Samples from a jump until the voice that it started has taken over.
    fn takeover_samples(&self) -> usize {
        self.latency_samples() + self.crossfade_samples
    }
}
