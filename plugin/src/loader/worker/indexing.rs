//! From recordings to dictionaries.

use std::sync::Arc;

use pyrophone_recording::{Cut, Recording};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::{EngineConfig, chain};
use pyrophone_training::{DictionaryKey, Stage, build};

use super::Worker;
use crate::loader::cache::DICTIONARIES;
use crate::loader::engine::Engine;
use crate::loader::job::Job;
use crate::loader::source::Failure;

impl Worker {
    /// Builds the recordings' dictionaries for the desired structure, and informs the audio thread when everything is
    /// ready for that structure.
    pub(super) fn index(&mut self, job: &Job) -> Result<(), Failure> {
        let Some(engine) = self.engine else { return Ok(()) };
        for slot in self.order() {
            self.index_one(slot, &engine, job)?;
        }
        let next = Engine { structure: *job.wanted(), ..engine };
        if self.prepared != Some(next) {
            match chain::latency_samples(next.sample_rate_hz, &next.structure) {
                Ok(samples) => self.link.shared.set_prepared(&next.structure, samples as u32),
                Err(error) => self.status.fail(error.to_string()),
            }
            self.prepared = Some(next);
        }
        Ok(())
    }

    /// Builds the dictionary of one slot; fails only if cancelled.
    fn index_one(&mut self, slot: usize, engine: &Engine, job: &Job) -> Result<(), Failure> {
        let Some(recording) = self.slots[slot].recording.clone() else { return Ok(()) };
        let cut = self.cut(slot);
        let key = self.key(&recording, &cut, job.wanted(), engine.sample_rate_hz);
        let place = &self.slots[slot];
        let is_made = place.dictionary.as_ref().is_some_and(|(made, _)| *made == key);
        if is_made || place.failed.as_ref() == Some(&key) {
            return Ok(());
        }
        let built = self.build(slot, &recording, &cut, job);
        let place = &mut self.slots[slot];
        match built {
            Ok(dictionary) => place.dictionary = dictionary,
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            Err(Failure::Message(message)) => {
                place.failed = Some(key);
                place.dictionary = None;
                self.status.fail(message);
            }
        }
        place.is_sent = false;
        // The one that sounds does not wait for the others.
        self.send_slot(slot);
        Ok(())
    }

    pub(super) fn key(
        &self,
        recording: &Recording,
        cut: &Cut,
        structure: &EngineConfig,
        sample_rate_hz: f64,
    ) -> DictionaryKey {
        DictionaryKey::new(&recording.content_hash, cut, sample_rate_hz, structure)
    }

    /// The dictionary of a part of a recording for the desired structure; none until a sample rate is known.
    pub(super) fn build(
        &self,
        slot: usize,
        recording: &Recording,
        cut: &Cut,
        job: &Job,
    ) -> Result<Option<(DictionaryKey, Arc<RecordingDictionary>)>, Failure> {
        let Some(Engine { sample_rate_hz, .. }) = self.engine else { return Ok(None) };
        let key = self.key(recording, cut, job.wanted(), sample_rate_hz);
        let progress = |stage: Stage, done: f32| match stage {
            Stage::Resampling => job.report_indexing("Resampling", 0.2 + 0.2 * done),
            Stage::Indexing => job.report_indexing("Indexing", 0.4 + 0.6 * done),
        };
        let make = || build(recording, cut, sample_rate_hz, job.wanted(), &progress).map_err(Failure::from);
        let is_called_off = || !job.report_indexing("Waiting for another instance", 0.4);
        let read_or_make = || -> Result<RecordingDictionary, Failure> {
            if let Some(kept) = self.store.as_ref().and_then(|store| store.read(&key)) {
                return Ok(kept);
            }
            let made = make()?;
            self.slots[slot].is_unkept.set(true);
            Ok(made)
        };
        match DICTIONARIES.get_or_make(&key, is_called_off, read_or_make) {
            Some(made) => Ok(Some((key, made?))),
            None => Err(Failure::Cancelled),
        }
    }

    /// Stores the dictionaries on disk for the next session, now that nobody is waiting.
    pub(super) fn keep(&self) {
        let Some(store) = &self.store else { return };
        for slot in &self.slots {
            if let (true, Some((key, dictionary))) = (slot.is_unkept.take(), &slot.dictionary)
                && let Err(error) = store.write(key, dictionary)
            {
                nice_plug::prelude::nice_warn!("the dictionary cannot be kept for the next session: {error}");
            }
        }
    }

    /// Fetches the dictionary of a recording not yet decoded, from another instance or from the disk, and sends it.
    pub(super) fn recall(&mut self, slot: usize, content_hash: &str, job: &Job) {
        let (Some(engine), Some(store)) = (self.engine, &self.store) else { return };
        let key = DictionaryKey::new(content_hash, &self.cut(slot), engine.sample_rate_hz, job.wanted());
        let read = || store.read(&key).ok_or(());
        if engine.structure == *job.wanted()
            && let Some(Ok(dictionary)) = DICTIONARIES.get_or_make(&key, || job.is_called_off(), read)
        {
            self.slots[slot].dictionary = Some((key, dictionary.clone()));
            self.send_dictionary(slot, dictionary);
        }
    }

    /// True if the dictionary is that of the slot's recording for the running engine.
    pub(super) fn has_fitting_dictionary(&self, slot: usize) -> bool {
        let place = &self.slots[slot];
        let (Some(recording), Some(engine), Some((key, _))) = (&place.recording, self.engine, &place.dictionary) else {
            return false;
        };
        *key == self.key(recording, &self.cut(slot), &engine.structure, engine.sample_rate_hz)
    }
}
