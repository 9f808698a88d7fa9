//! The recording for monitoring: the part used for learning, at the engine's rate.

use std::sync::Arc;

use pyrophone_recording::{Cut, Recording};

use super::job::Job;
use super::link::{LoaderLink, Update};
use super::source::Failure;
use super::status::Status;
use crate::audio::audition;

/// Origin of a clip: the recording's hash, the part, the rate in Hz.
type Key = (String, Cut, u32);

/// The clip, while monitoring is wanted, and whether the engine has it.
#[derive(Default)]
pub struct ClipLoader {
    is_wanted: bool,
    made: Option<(Key, audition::AuditionClip)>,
    is_sent: bool,
}

impl ClipLoader {
    /// Sets whether monitoring is wanted.
    pub fn want(&mut self, wanted: bool) {
        self.is_sent &= self.is_wanted == wanted;
        self.is_wanted = wanted;
    }

    /// Has it sent again.
    pub fn resend(&mut self) {
        self.is_sent = false;
    }

    /// Creates the clip if it is wanted and missing.
    pub fn make(&mut self, of: Option<(&Recording, &Cut)>, rate_hz: u32, job: &Job) -> Result<(), Failure> {
        let Some((recording, cut)) = of.filter(|_| self.is_wanted) else {
            self.is_sent &= self.made.take().is_none();
            return Ok(());
        };
        let key = (recording.content_hash.clone(), *cut, rate_hz);
        if self.made.as_ref().is_none_or(|(made, _)| *made != key) {
            let part = cut.apply(recording)?;
            let progress = |done: f32| job.report("Preparing playback", done);
            let resampled = pyrophone_recording::resample(&part, rate_hz, &progress)?;
            self.made = Some((key, Arc::new(resampled.channels)));
            self.is_sent = false;
        }
        Ok(())
    }

    /// Sends it to the engine, if that lacks it.
    pub fn send(&mut self, link: &mut LoaderLink, status: &Status) {
        if self.is_sent {
            return;
        }
        let clip = self.made.as_ref().map(|(_, clip)| clip.clone());
        let has_clip = clip.is_some();
        self.is_sent = link.send(Update::Clip(clip));
        status.update(|view| view.has_clip = has_clip);
    }
}
