//! The loader's thread: brings what the engines have towards what is wanted.
//!
//! Wanted are the recording of the user or the session, for the engine that runs and for the
//! structure that the parameters say. After each order, and twenty times a second, the worker
//! does what is missing.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use pyrophone_recording::{Cut, Recording, check_not_among, write_wav_f32};
use pyrophone_settings::Recent;
use pyrophone_settings::session::{self, Session};
use pyrophone_synthesis::Structure;
use pyrophone_synthesis::chain;
use pyrophone_synthesis::texture::Dictionary;
use pyrophone_training::{DictionaryKey, IMPULSIVE, Stage, Store, build};

use super::cache::DICTIONARIES;
use super::engine::Engine;
use super::job::Job;
use super::learner::{Learner, shown_amplitudes};
use super::link::{LoaderLink, Update};
use super::mailbox::{Mailbox, Order};
use super::motion::Motion;
use super::source::{self, Failure, Found};
use super::status::Status;
use super::tape::Tape;
use crate::analysis::Portrait;
use crate::parameters::EffectParams;
use crate::persist;

/// How often the worker looks at parameters and rings when there are no orders.
const TICK: Duration = Duration::from_millis(50);

/// A recording that is to be fetched.
enum Pending {
    /// The user's choice; where it fails, the old one stays.
    File(PathBuf),
    /// The session's; where it fails, there is none.
    Session,
}

/// The thread's own things.
pub struct Worker {
    mailbox: Arc<Mailbox>,
    params: Arc<EffectParams>,
    status: Arc<Status>,
    link: LoaderLink,
    session: Session,
    pending: Option<Pending>,
    recording: Option<Arc<Recording>>,
    engine: Option<Engine>,
    dictionary: Option<(DictionaryKey, Arc<Dictionary>)>,
    /// Where dictionaries are kept from one session to the next.
    store: Option<Store>,
    /// Whether the dictionary was made here and is not kept yet.
    is_unkept: Cell<bool>,
    /// What could not be indexed, so that it is not tried again.
    failed: Option<DictionaryKey>,
    dictionary_is_sent: bool,
    /// Whether what is drawn of the recording is not what it should be.
    portrait_is_due: bool,
    prepared: Option<Engine>,
    learner: Learner,
    motion: Motion,
    tape: Tape,
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
            pending: None,
            recording: None,
            engine: None,
            dictionary: None,
            store: Store::of_user(),
            is_unkept: Cell::new(false),
            failed: None,
            dictionary_is_sent: true,
            portrait_is_due: false,
            prepared: None,
            learner: Learner::default(),
            motion: Motion::default(),
            tape: Tape::default(),
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

    fn accept(&mut self, order: Order) {
        match order {
            Order::Load(path) => self.pending = Some(Pending::File(path)),
            Order::Unload => {
                self.pending = None;
                self.session.recording = None;
                self.set_recording(None);
                self.status.update(|view| view.error = None);
                self.params.session.store(&self.session);
            }
            Order::ReadSession => self.read_session(),
            Order::Engine(engine) => {
                self.engine = Some(engine);
                self.failed = None;
                self.dictionary_is_sent = false;
                self.learner.resend();
                self.motion.resend();
                self.tape.resend();
            }
            Order::Cancel => self.cancel(),
            Order::Cut(cut) => {
                self.session.cut = cut;
                self.failed = None;
                self.show_recording();
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

    /// Gives up what is under way. What could not be fetched is named as it would be if it had not been found; what could not
    /// be indexed is not tried again until something changes.
    fn cancel(&mut self) {
        let what = match self.pending.take() {
            Some(Pending::File(path)) => path.display().to_string(),
            Some(Pending::Session) => {
                self.set_recording(None);
                "the session's recording".to_owned()
            }
            None => match (self.learner.is_awaited(), &self.recording, self.engine) {
                (true, ..) => {
                    self.learner.give_up();
                    "learning from a file".to_owned()
                }
                (false, Some(recording), Some(engine)) => {
                    let key =
                        self.key(recording, &self.cut(), &self.params.values().structure(), engine.sample_rate_hz);
                    if self.dictionary.as_ref().is_some_and(|(made, _)| *made == key) {
                        return;
                    }
                    let name = recording.name.clone();
                    self.failed = Some(key);
                    name
                }
                _ => return,
            },
        };
        self.status.fail(format!("Cancelled: {what}. What was there before plays on; load it again when you like."));
    }

    fn save_part(&self, path: &Path) {
        let Some(recording) = self.recording.as_deref() else {
            return self.status.fail("there is no recording to be saved; load one first".to_owned());
        };
        let of = Path::new(self.session.recording.as_ref().map_or("", |reference| reference.path.as_str()));
        let part = check_not_among(path, &[of]).and_then(|()| self.cut().of(recording));
        let saved = part.and_then(|part| write_wav_f32(path, &part.channels, part.sample_rate_hz));
        match saved {
            Ok(()) => self.status.update(|view| view.notice = Some(format!("Saved: {}", path.display()))),
            Err(error) => self.status.fail(error.to_string()),
        }
    }

    /// The part of the recording that is learnt from.
    fn cut(&self) -> Cut {
        let session::Cut { region_s, gain_db, normalise } = self.session.cut;
        Cut { region_s, gain_db, normalise }
    }

    /// Takes over the session that the host has loaded. One that cannot be understood changes
    /// nothing; a later version's is kept for saving, a damaged one is not.
    fn read_session(&mut self) {
        let Some(field) = self.params.session.take_arrived() else { return };
        match persist::decode(&field) {
            Ok(session) => {
                self.session = session;
                self.pending = Some(Pending::Session);
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
        if let Some(reference) = &mut self.session.recording {
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
        let path = self.session.recording.as_ref().map(|reference| reference.path.clone());
        self.status.update(|view| {
            view.path = path;
            view.embed = self.session.embed;
        });
    }

    /// Fetches the recording that is to be fetched.
    fn fetch(&mut self, job: &Job) -> Result<(), Failure> {
        let found = match &self.pending {
            None => return Ok(()),
            Some(Pending::File(path)) => {
                let usable = source::open(path, self.session.embed, job).and_then(|found| {
                    // In another recording the old one's part means nothing; a session's file from its new place keeps it.
                    let known = self.session.recording.as_ref();
                    let is_known = known.is_some_and(|known| known.content_hash == found.reference.content_hash);
                    let cut = if is_known { self.cut() } else { Cut { region_s: None, ..self.cut() } };
                    // The old recording stays until the new one has its index.
                    let dictionary = self.build(&found.recording, &cut, job)?;
                    Ok((found, cut, dictionary))
                });
                usable.map(|(found, cut, dictionary)| {
                    self.session.recording = Some(found.reference.clone());
                    self.session.cut.region_s = cut.region_s;
                    self.params.session.store(&self.session);
                    self.dictionary = dictionary;
                    if let Some(recent) = &self.recent {
                        let known = recent.add(&found.reference.path);
                        self.status.update(|view| view.recent = known);
                    }
                    Some(found)
                })
            }
            Some(Pending::Session) => match self.session.recording.clone() {
                None => Ok(None),
                Some(reference) => source::locate(&reference).and_then(|located| {
                    // What is heard comes first; what is shown of the recording can wait until it is decoded.
                    self.recall(&located.content_hash, job);
                    located.decode(&reference, job).map(Some)
                }),
            },
        };
        match found {
            Err(Failure::CalledOff) => return Err(Failure::CalledOff),
            Err(Failure::Message(message)) => {
                if matches!(self.pending, Some(Pending::Session)) {
                    self.set_recording(None);
                }
                self.status.fail(message);
            }
            Ok(found) => {
                let (recording, notice) = match found {
                    Some(Found { recording, notice, .. }) => (Some(recording), notice),
                    None => (None, None),
                };
                self.status.update(|view| view.error = notice);
                self.set_recording(recording);
            }
        }
        self.pending = None;
        // Last, so that it is still shown.
        if let Some(error) = self.motion.take_error() {
            self.status.fail(error);
        }
        self.show_session();
        Ok(())
    }

    fn set_recording(&mut self, recording: Option<Arc<Recording>>) {
        // The same bytes may have been read from another place before, under another name.
        let path = self.session.recording.as_ref().map(|reference| Path::new(&reference.path));
        let name = path.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let shown = recording.as_ref().map(|recording| {
            let name = name.as_deref().unwrap_or(&recording.name);
            let (seconds, kilohertz) = (recording.duration_s(), f64::from(recording.sample_rate_hz) / 1000.0);
            let channels = match recording.channels.len() {
                1 => "mono".to_owned(),
                2 => "stereo".to_owned(),
                count => format!("{count} channels"),
            };
            format!("{name}: {seconds:.1} s, {kilohertz} kHz, {channels}")
        });
        let is_same = |known: &Arc<Recording>| recording.as_ref().is_some_and(|new| Arc::ptr_eq(new, known));
        let is_drawn = self.recording.as_ref().is_some_and(is_same);
        self.status.update(|view| {
            view.recording = shown;
            if !is_drawn {
                view.portrait = None;
            }
        });
        self.recording = recording;
        self.show_recording();
        self.failed = None;
        self.dictionary_is_sent &= self.has_fitting_dictionary();
        if self.recording.is_none() {
            self.dictionary = None;
        }
    }

    /// Shows the part that is learnt from, and has the recording drawn anew.
    fn show_recording(&mut self) {
        self.portrait_is_due = true;
        self.status.update(|view| view.cut = self.session.cut);
    }

    /// Draws the recording, once what sounds is ready, and only for a window: a session of fifty instances opens none.
    fn draw(&mut self) {
        if !self.portrait_is_due || !self.link.shared.is_watched.load(Ordering::Relaxed) {
            return;
        }
        self.portrait_is_due = false;
        let (cut, known) = (self.cut(), self.status.view().portrait);
        let portrait = self.recording.as_deref().map(|recording| {
            Arc::new(match known {
                Some(known) => known.with_cut(recording, &cut),
                None => Portrait::of(recording, &cut),
            })
        });
        self.status.update(|view| view.portrait = portrait);
    }

    /// Makes the dictionary of the recording for the structure that is wanted, and tells the audio
    /// thread when everything is ready for that structure.
    fn index(&mut self, job: &Job) -> Result<(), Failure> {
        let Some(engine) = self.engine else { return Ok(()) };
        if let Some(recording) = self.recording.clone() {
            let cut = self.cut();
            let key = self.key(&recording, &cut, job.wanted(), engine.sample_rate_hz);
            let is_made = self.dictionary.as_ref().is_some_and(|(made, _)| *made == key);
            if !is_made && self.failed.as_ref() != Some(&key) {
                match self.build(&recording, &cut, job) {
                    Ok(dictionary) => {
                        self.dictionary = dictionary;
                        self.dictionary_is_sent = false;
                    }
                    Err(Failure::CalledOff) => return Err(Failure::CalledOff),
                    Err(Failure::Message(message)) => {
                        self.failed = Some(key);
                        self.dictionary = None;
                        self.dictionary_is_sent = false;
                        self.status.fail(message);
                    }
                }
            }
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

    /// What somebody waits for beside the engines: a file to learn from, a recording to listen to.
    fn attend(&mut self, job: &Job) -> Result<(), Failure> {
        let Some(engine) = self.engine else { return Ok(()) };
        let values = self.params.values();
        match self.learner.work(&mut self.session, &engine, &values, job) {
            Ok(false) => {}
            Ok(true) => self.params.session.store(&self.session),
            Err(Failure::CalledOff) => return Err(Failure::CalledOff),
            Err(Failure::Message(message)) => self.status.fail(message),
        }
        let cut = self.cut();
        let of = self.recording.as_deref().map(|recording| (recording, &cut));
        match self.tape.make(of, engine.sample_rate_hz.round() as u32, job) {
            Err(Failure::Message(message)) => {
                self.tape.want(false);
                self.status.fail(message);
                Ok(())
            }
            done => done,
        }
    }

    fn key(&self, recording: &Recording, cut: &Cut, structure: &Structure, sample_rate_hz: f64) -> DictionaryKey {
        DictionaryKey::new(&recording.content_hash, cut, sample_rate_hz, structure)
    }

    /// The dictionary of a part of a recording for the structure that is wanted; none as long as no sample
    /// rate is known.
    fn build(
        &self,
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
            self.is_unkept.set(true);
            Ok(made)
        };
        match DICTIONARIES.get_or_make(&key, is_called_off, read_or_make) {
            Some(made) => Ok(Some((key, made?))),
            None => Err(Failure::CalledOff),
        }
    }

    /// Keeps the dictionary for the next session, now that nobody waits any longer.
    fn keep(&self) {
        if let (true, Some(store), Some((key, dictionary))) = (self.is_unkept.take(), &self.store, &self.dictionary)
            && let Err(error) = store.write(key, dictionary)
        {
            nice_plug::prelude::nice_warn!("the dictionary cannot be kept for the next session: {error}");
        }
    }

    /// Takes the dictionary of a recording that is not decoded yet from another instance or from the disk, and sends it.
    fn recall(&mut self, content_hash: &str, job: &Job) {
        let (Some(engine), Some(store)) = (self.engine, &self.store) else { return };
        let key = DictionaryKey::new(content_hash, &self.cut(), engine.sample_rate_hz, job.wanted());
        let read = || store.read(&key).ok_or(());
        if engine.structure == *job.wanted()
            && let Some(Ok(dictionary)) = DICTIONARIES.get_or_make(&key, || job.is_called_off(), read)
        {
            self.dictionary = Some((key, dictionary.clone()));
            self.send_dictionary(dictionary);
        }
    }

    /// Whether the dictionary is that of the recording for the engine that runs.
    fn has_fitting_dictionary(&self) -> bool {
        let (Some(recording), Some(engine), Some((key, _))) = (&self.recording, self.engine, &self.dictionary) else {
            return false;
        };
        *key == self.key(recording, &self.cut(), &engine.structure, engine.sample_rate_hz)
    }

    fn send_dictionary(&mut self, dictionary: Arc<Dictionary>) {
        let amplitudes = shown_amplitudes(dictionary.distribution());
        let crackles = dictionary.crackles().map(|crackles| crackles.summary().per_second as f32);
        let warning = dictionary.is_impulsive().then(|| IMPULSIVE.to_owned());
        self.status.update(|view| {
            view.amplitudes[0] = amplitudes;
            view.crackles_per_s = crackles;
            view.notice = warning.or_else(|| view.notice.take());
        });
        self.dictionary_is_sent = self.link.send(Update::Dictionary(Some(dictionary)));
    }

    /// Sends what the running engine lacks. A dictionary for a structure that it does not have yet
    /// waits until it has.
    fn send(&mut self) {
        let Some(engine) = self.engine else { return };
        if !self.dictionary_is_sent {
            match &self.dictionary {
                Some((_, dictionary)) if self.has_fitting_dictionary() => self.send_dictionary(dictionary.clone()),
                Some(_) => {}
                None => {
                    self.status.update(|view| (view.amplitudes[0], view.crackles_per_s) = (None, None));
                    self.dictionary_is_sent = self.link.send(Update::Dictionary(None));
                }
            }
        }
        self.learner.send(&mut self.link, &self.session, &engine, &self.status);
        self.motion.send(&mut self.link);
        self.tape.send(&mut self.link, &self.status);
    }
}
