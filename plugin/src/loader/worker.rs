//! The loader's thread: it brings the engines' data to the desired state.
//!
//! Desired are the recordings of the user or the session, by slot, for the running engine and for the structure given
//! by the parameters. After each order, and twenty times a second, the worker does the missing work, the active slot
//! first. The user's actions on a recording apply to this slot.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use pyrophone_recording::{Cut, Recording, check_not_among, write_wav_f32};
use pyrophone_settings::session::{self, Session};
use pyrophone_settings::{Id, Recent};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain;
use pyrophone_synthesis::controls::SLOTS;
use pyrophone_synthesis::texture::Dictionary;
use pyrophone_training::{DictionaryKey, IMPULSIVE, Stage, Store, build};

use super::cache::DICTIONARIES;
use super::engine::Engine;
use super::job::Job;
use super::learner::{Learner, shown_amplitudes};
use super::link::{LoaderLink, Update};
use super::mailbox::{Mailbox, Order};
use super::motion::Motion;
use super::slot::{Pending, Slot};
use super::source::{self, Failure, Found};
use super::status::Status;
use super::tape::ClipLoader;
use crate::parameters::EffectParams;
use crate::persist;
use pyrophone_analysis::Portrait;

/// Interval at which the worker polls parameters and rings when there are no orders.
const TICK: Duration = Duration::from_millis(50);

/// The thread's own state.
pub struct Worker {
    mailbox: Arc<Mailbox>,
    params: Arc<EffectParams>,
    status: Arc<Status>,
    link: LoaderLink,
    session: Session,
    slots: [Slot; SLOTS],
    /// The slot that is shown.
    shown: usize,
    engine: Option<Engine>,
    /// Folder of dictionaries that last from one session to the next.
    store: Option<Store>,
    prepared: Option<Engine>,
    learner: Learner,
    motion: Motion,
    tape: ClipLoader,
    recent: Option<Recent>,
}

impl Drop for Worker {
    /// However the thread ends, nobody may wait for it any longer.
    fn drop(&mut self) {
        self.mailbox.quit();
    }
}

impl Worker {
    /// A worker without a recording.
    pub fn new(
        mailbox: Arc<Mailbox>,
        params: Arc<EffectParams>,
        status: Arc<Status>,
        link: LoaderLink,
        recent: Option<Recent>,
    ) -> Self {
        Self {
            mailbox,
            params,
            status,
            link,
            session: Session::default(),
            slots: Default::default(),
            shown: 0,
            engine: None,
            store: Store::of_user(),
            prepared: None,
            learner: Learner::default(),
            motion: Motion::default(),
            tape: ClipLoader::default(),
            recent,
        }
    }

    /// Works until asked to end.
    pub fn run(mut self) {
        if let Some(recent) = &self.recent {
            let known = recent.list();
            self.status.update(|view| view.recent = known);
        }
        loop {
            let batch = self.mailbox.take(TICK);
            if batch.quit {
                return;
            }
            self.follow_shown();
            for order in batch.orders {
                self.accept(order);
            }
            self.link.free_retired();
            if self.learner.follow(&mut self.link, &mut self.session, self.engine.as_ref(), &self.status) {
                self.params.session.store(&self.session);
            }
            let job = Job::new(&self.mailbox, &self.status, &self.params, batch.epoch);
            let is_done = self.fetch(&job).and_then(|()| self.index(&job)).and_then(|()| self.attend(&job));
            job.end();
            self.send();
            self.draw();
            if is_done.is_ok() {
                self.mailbox.settle(batch.ticket);
                self.keep();
            }
        }
    }

    /// Switches the displayed slot when the parameter changes.
    fn follow_shown(&mut self) {
        let shown = (self.params.value(Id::RecordingSlot as usize) as usize).min(SLOTS - 1);
        if shown == self.shown {
            return;
        }
        self.shown = shown;
        self.slots[shown].portrait_is_due = true;
        let portrait = self.slots[shown].portrait.clone();
        self.status.update(|view| view.portrait = portrait);
        self.show_session();
        self.show_dictionary();
        self.show_cut();
    }

    /// Slots in order of priority.
    fn order(&self) -> impl Iterator<Item = usize> + use<> {
        let shown = self.shown;
        std::iter::once(shown).chain((0..SLOTS).filter(move |slot| *slot != shown))
    }

    fn accept(&mut self, order: Order) {
        let shown = self.shown;
        match order {
            Order::Load(path) => self.slots[shown].pending = Some(Pending::File(path)),
            Order::Unload => {
                self.slots[shown].pending = None;
                *self.session.recording_in_mut(shown) = None;
                self.set_recording(shown, None);
                self.status.update(|view| view.error = None);
                self.params.session.store(&self.session);
            }
            Order::ReadSession => self.read_session(),
            Order::Engine(engine) => {
                self.engine = Some(engine);
                for slot in &mut self.slots {
                    slot.failed = None;
                    // New engines have no recordings, so empty slots need no update.
                    slot.is_sent = slot.recording.is_none() && slot.dictionary.is_none();
                }
                self.learner.resend();
                self.motion.resend();
                self.tape.resend();
            }
            Order::Cancel => self.cancel(),
            Order::Cut(cut) => {
                *self.session.cut_in_mut(shown) = cut;
                self.slots[shown].failed = None;
                self.show_recording(shown);
                self.status.update(|view| view.error = None);
                self.params.session.store(&self.session);
            }
            Order::Audition(wanted) => self.tape.want(wanted),
            Order::LearnFrom(path) => self.learner.learn_from(path),
            Order::SavePart(path) => self.save_part(&path),
            Order::Embed(embed) => self.set_embed(embed),
            Order::ForgetLearned => {
                self.session.learned = None;
                self.learner.resend();
                self.params.session.store(&self.session);
            }
            Order::LoadField(path) => match self.motion.load(&path, &mut self.session, &self.status) {
                Ok(()) => {
                    self.status.update(|view| view.error = None);
                    self.params.session.store(&self.session);
                }
                Err(message) => self.status.fail(message),
            },
            Order::UnloadField => {
                self.session.field = None;
                self.motion.read(&self.session, &self.status);
                self.params.session.store(&self.session);
            }
        }
    }

    /// Cancels the current work. Recordings not fetched are listed as if not found; dictionaries not built are not
    /// tried again until something changes.
    fn cancel(&mut self) {
        let Some(what) =
            self.give_up_fetching().or_else(|| self.give_up_learning()).or_else(|| self.give_up_indexing())
        else {
            return;
        };
        self.status.fail(format!("Cancelled: {what}. The previous sound continues; load it again at any time."));
    }

    fn give_up_fetching(&mut self) -> Option<String> {
        let slot = self.order().find(|slot| self.slots[*slot].pending.is_some())?;
        match self.slots[slot].pending.take()? {
            Pending::File(path) => Some(path.display().to_string()),
            Pending::Session => {
                self.set_recording(slot, None);
                Some("the session's recording".to_owned())
            }
        }
    }

    fn give_up_learning(&mut self) -> Option<String> {
        self.learner.is_awaited().then(|| {
            self.learner.give_up();
            "learning from a file".to_owned()
        })
    }

    fn give_up_indexing(&mut self) -> Option<String> {
        let engine = self.engine?;
        let structure = self.params.values().structure();
        for slot in self.order() {
            let Some(recording) = self.slots[slot].recording.clone() else { continue };
            let key = self.key(&recording, &self.cut(slot), &structure, engine.sample_rate_hz);
            let place = &mut self.slots[slot];
            let is_made = place.dictionary.as_ref().is_some_and(|(made, _)| *made == key);
            if !is_made && place.failed.as_ref() != Some(&key) {
                place.failed = Some(key);
                return Some(recording.name.clone());
            }
        }
        None
    }

    fn save_part(&self, path: &Path) {
        let Some(recording) = self.slots[self.shown].recording.as_deref() else {
            return self.status.fail("there is no recording to be saved; load one first".to_owned());
        };
        let of = Path::new(self.path(self.shown).unwrap_or_default());
        let part = check_not_among(path, &[of]).and_then(|()| self.cut(self.shown).of(recording));
        let saved = part.and_then(|part| write_wav_f32(path, &part.channels, part.sample_rate_hz));
        match saved {
            Ok(()) => self.status.update(|view| view.notice = Some(format!("Saved: {}", path.display()))),
            Err(error) => self.status.fail(error.to_string()),
        }
    }

    /// The path of a slot's recording in the session.
    fn path(&self, slot: usize) -> Option<&str> {
        self.session.recording_in(slot).map(|reference| reference.path.as_str())
    }

    /// The part of a slot's recording used for learning.
    fn cut(&self, slot: usize) -> Cut {
        let session::Cut { region_s, gain_db, normalise } = self.session.cut_in(slot);
        Cut { region_s, gain_db, normalise }
    }

    /// Takes over the session that the host has loaded. An unreadable one changes nothing; a later version's is kept
    /// for saving, a damaged one is not.
    fn read_session(&mut self) {
        let Some(field) = self.params.session.take_arrived() else { return };
        match persist::decode(&field) {
            Ok(session) => {
                self.session = session;
                self.slots.iter_mut().for_each(|slot| slot.pending = Some(Pending::Session));
                self.learner.resend();
                self.status.update(|view| view.error = None);
                self.motion.read(&self.session, &self.status);
            }
            Err(error) => {
                self.status.fail(error.to_string());
                if matches!(error, pyrophone_settings::Error::Session { .. }) {
                    self.params.session.store(&self.session);
                }
            }
        }
        self.show_session();
    }

    fn set_embed(&mut self, embed: bool) {
        self.session.embed = embed;
        for slot in 0..SLOTS {
            let Some(reference) = self.session.recording_in_mut(slot) else { continue };
            match (embed, reference.embedded.is_some()) {
                (true, false) => match source::pack(reference) {
                    Ok(packed) => reference.embedded = Some(packed),
                    Err(message) => self.status.fail(message),
                },
                (false, true) => reference.embedded = None,
                _ => {}
            }
        }
        self.params.session.store(&self.session);
        self.show_session();
    }

    fn show_session(&self) {
        let path = self.path(self.shown).map(str::to_owned);
        let recordings: [Option<String>; SLOTS] =
            std::array::from_fn(|slot| self.slots[slot].description(self.path(slot)));
        let is_named = std::array::from_fn(|slot| self.path(slot).is_some());
        self.status.update(|view| {
            view.slot = self.shown;
            view.path = path;
            view.recording = recordings[self.shown].clone();
            view.slots = recordings;
            view.is_named = is_named;
            view.embed = self.session.embed;
        });
    }

    /// Fetches the pending recordings.
    fn fetch(&mut self, job: &Job) -> Result<(), Failure> {
        if self.slots.iter().all(|slot| slot.pending.is_none()) {
            return Ok(());
        }
        let mut words = Vec::new();
        for slot in self.order() {
            if let Some(pending) = self.slots[slot].pending.take() {
                let fetched = self.fetch_one(slot, &pending, job);
                if let Err(Failure::CalledOff) = fetched {
                    self.slots[slot].pending = Some(pending);
                    return Err(Failure::CalledOff);
                }
                words.extend(self.settle(slot, &pending, fetched));
                self.show_session();
            }
        }
        // Last, so that it is still shown.
        words.extend(self.motion.take_error());
        let words = (!words.is_empty()).then(|| words.join("\n"));
        self.status.update(|view| view.error = words);
        self.show_session();
        Ok(())
    }

    /// Takes over a fetched recording; returns a notice for the user.
    fn settle(&mut self, slot: usize, pending: &Pending, fetched: Result<Option<Found>, Failure>) -> Option<String> {
        let (recording, notice) = match fetched {
            Ok(Some(Found { recording, notice, .. })) => (Some(recording), notice),
            Ok(None) | Err(Failure::CalledOff) => (None, None),
            Err(Failure::Message(message)) => {
                if matches!(pending, Pending::Session) {
                    self.set_recording(slot, None);
                }
                self.status.fail(message.clone());
                return Some(message);
            }
        };
        self.set_recording(slot, recording);
        notice
    }

    fn fetch_one(&mut self, slot: usize, pending: &Pending, job: &Job) -> Result<Option<Found>, Failure> {
        match pending {
            Pending::File(path) => {
                let found = source::open(path, self.session.embed, job)?;
                // The old part means nothing in another recording; the same recording at a new path keeps it.
                let known = self.session.recording_in(slot);
                let is_known = known.is_some_and(|known| known.content_hash == found.reference.content_hash);
                let cut = if is_known { self.cut(slot) } else { Cut { region_s: None, ..self.cut(slot) } };
                // The old recording stays until the new one has its index.
                let dictionary = self.build(slot, &found.recording, &cut, job)?;
                *self.session.recording_in_mut(slot) = Some(found.reference.clone());
                self.session.cut_in_mut(slot).region_s = cut.region_s;
                self.params.session.store(&self.session);
                self.slots[slot].dictionary = dictionary;
                if let Some(recent) = &self.recent {
                    let known = recent.add(&found.reference.path);
                    self.status.update(|view| view.recent = known);
                }
                Ok(Some(found))
            }
            Pending::Session => match self.session.recording_in(slot).cloned() {
                None => Ok(None),
                Some(reference) => {
                    let located = source::locate(&reference)?;
                    // The dictionary comes first, because the sound depends on it; the display can wait until the
                    // recording is decoded.
                    self.recall(slot, &located.content_hash, job);
                    located.decode(&reference, job).map(Some)
                }
            },
        }
    }

    fn set_recording(&mut self, slot: usize, recording: Option<Arc<Recording>>) {
        let place = &mut self.slots[slot];
        let is_empty = recording.is_none() && place.recording.is_none() && place.dictionary.is_none();
        let is_same = |known: &Arc<Recording>| recording.as_ref().is_some_and(|new| Arc::ptr_eq(new, known));
        if !place.recording.as_ref().is_some_and(is_same) {
            place.portrait = None;
        }
        place.recording = recording;
        place.failed = None;
        let fits = self.has_fitting_dictionary(slot);
        let place = &mut self.slots[slot];
        // The engines need no update for a slot that was empty and still is.
        place.is_sent &= fits || is_empty;
        if place.recording.is_none() {
            place.dictionary = None;
        }
        if slot == self.shown {
            let portrait = place.portrait.clone();
            self.status.update(|view| view.portrait = portrait);
        }
        self.show_session();
        self.show_recording(slot);
    }

    /// Shows the part used for learning, and has the recording redrawn.
    fn show_recording(&mut self, slot: usize) {
        self.slots[slot].portrait_is_due = true;
        self.show_cut();
    }

    fn show_cut(&self) {
        self.status.update(|view| view.cut = self.session.cut_in(self.shown));
    }

    /// Draws the active slot's recording, once its sound is ready, and only for an open window: a session of fifty
    /// instances opens none.
    fn draw(&mut self) {
        let cut = self.cut(self.shown);
        let place = &mut self.slots[self.shown];
        if !place.portrait_is_due || !self.link.shared.is_watched.load(Ordering::Relaxed) {
            return;
        }
        place.portrait_is_due = false;
        let known = place.portrait.take();
        place.portrait = place.recording.as_deref().map(|recording| {
            Arc::new(match known {
                Some(known) => known.with_cut(recording, &cut),
                None => Portrait::of(recording, &cut),
            })
        });
        let portrait = place.portrait.clone();
        self.status.update(|view| view.portrait = portrait);
    }

    /// Builds the recordings' dictionaries for the desired structure, and tells the audio thread when everything is
    /// ready for that structure.
    fn index(&mut self, job: &Job) -> Result<(), Failure> {
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
            Err(Failure::CalledOff) => return Err(Failure::CalledOff),
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

    /// Work besides the engines' data: a file to learn from, a recording to monitor.
    fn attend(&mut self, job: &Job) -> Result<(), Failure> {
        let Some(engine) = self.engine else { return Ok(()) };
        let values = self.params.values();
        match self.learner.work(&mut self.session, &engine, &values, job) {
            Ok(false) => {}
            Ok(true) => self.params.session.store(&self.session),
            Err(Failure::CalledOff) => return Err(Failure::CalledOff),
            Err(Failure::Message(message)) => self.status.fail(message),
        }
        let cut = self.cut(self.shown);
        let of = self.slots[self.shown].recording.as_deref().map(|recording| (recording, &cut));
        match self.tape.make(of, engine.sample_rate_hz.round() as u32, job) {
            Err(Failure::Message(message)) => {
                self.tape.want(false);
                self.status.fail(message);
                Ok(())
            }
            done => done,
        }
    }

    fn key(&self, recording: &Recording, cut: &Cut, structure: &EngineConfig, sample_rate_hz: f64) -> DictionaryKey {
        DictionaryKey::new(&recording.content_hash, cut, sample_rate_hz, structure)
    }

    /// The dictionary of a part of a recording for the desired structure; none until a sample rate is known.
    fn build(
        &self,
        slot: usize,
        recording: &Recording,
        cut: &Cut,
        job: &Job,
    ) -> Result<Option<(DictionaryKey, Arc<Dictionary>)>, Failure> {
        let Some(Engine { sample_rate_hz, .. }) = self.engine else { return Ok(None) };
        let key = self.key(recording, cut, job.wanted(), sample_rate_hz);
        let progress = |stage: Stage, done: f32| match stage {
            Stage::Resampling => job.goes_on_indexing("Resampling", 0.2 + 0.2 * done),
            Stage::Indexing => job.goes_on_indexing("Indexing", 0.4 + 0.6 * done),
        };
        let make = || build(recording, cut, sample_rate_hz, job.wanted(), &progress).map_err(Failure::from);
        let is_called_off = || !job.goes_on_indexing("Waiting for another instance", 0.4);
        let read_or_make = || -> Result<Dictionary, Failure> {
            if let Some(kept) = self.store.as_ref().and_then(|store| store.read(&key)) {
                return Ok(kept);
            }
            let made = make()?;
            self.slots[slot].is_unkept.set(true);
            Ok(made)
        };
        match DICTIONARIES.get_or_make(&key, is_called_off, read_or_make) {
            Some(made) => Ok(Some((key, made?))),
            None => Err(Failure::CalledOff),
        }
    }

    /// Stores the dictionaries on disk for the next session, now that nobody is waiting.
    fn keep(&self) {
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
    fn recall(&mut self, slot: usize, content_hash: &str, job: &Job) {
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
    fn has_fitting_dictionary(&self, slot: usize) -> bool {
        let place = &self.slots[slot];
        let (Some(recording), Some(engine), Some((key, _))) = (&place.recording, self.engine, &place.dictionary) else {
            return false;
        };
        *key == self.key(recording, &self.cut(slot), &engine.structure, engine.sample_rate_hz)
    }

    fn send_dictionary(&mut self, slot: usize, dictionary: Arc<Dictionary>) {
        self.slots[slot].is_sent = self.link.send(Update::Dictionary(slot, Some(dictionary)));
        if slot == self.shown {
            self.show_dictionary();
        }
    }

    /// Shows the properties of the active slot's dictionary.
    fn show_dictionary(&self) {
        let dictionary = self.slots[self.shown].dictionary.as_ref().map(|(_, dictionary)| dictionary);
        let amplitudes = dictionary.and_then(|dictionary| shown_amplitudes(dictionary.distribution()));
        let crackles = dictionary.and_then(|dictionary| dictionary.crackles());
        let crackles_per_s = crackles.map(|crackles| crackles.summary().per_second as f32);
        let warning = dictionary.filter(|dictionary| dictionary.is_impulsive()).map(|_| IMPULSIVE.to_owned());
        self.status.update(|view| {
            view.amplitudes[0] = amplitudes;
            view.crackles_per_s = crackles_per_s;
            view.notice = warning.or_else(|| view.notice.take());
        });
    }

    /// Sends the data of a slot that the running engine lacks. A dictionary for a structure not running yet waits until
    /// it does.
    fn send_slot(&mut self, slot: usize) {
        if self.engine.is_none() || self.slots[slot].is_sent {
            return;
        }
        match &self.slots[slot].dictionary {
            Some((_, dictionary)) if self.has_fitting_dictionary(slot) => {
                let dictionary = dictionary.clone();
                self.send_dictionary(slot, dictionary);
            }
            Some(_) => {}
            None => {
                self.slots[slot].is_sent = self.link.send(Update::Dictionary(slot, None));
                if slot == self.shown {
                    self.show_dictionary();
                }
            }
        }
    }

    /// Sends all data that the running engine lacks.
    fn send(&mut self) {
        let Some(engine) = self.engine else { return };
        for slot in self.order() {
            self.send_slot(slot);
        }
        self.learner.send(&mut self.link, &self.session, &engine, &self.status);
        self.motion.send(&mut self.link);
        self.tape.send(&mut self.link, &self.status);
    }
}
