//! The loader's thread: it brings the engines' data to the desired state.
//!
//! Desired are the recordings of the user or the session, by slot, for the running engine and for the structure given
//! by the parameters. After each order, and twenty times a second, the worker does the missing work, the active slot
//! first. The user's actions on a recording apply to this slot.
//!
//! | module | content |
//! |---|---|
//! | `orders` | orders from the window and the host |
//! | `fetching` | from paths and sessions to recordings |
//! | `indexing` | from recordings to dictionaries |
//! | `sending` | what the running engine gets |
//! | `showing` | what the window is shown |

mod fetching;
mod indexing;
mod orders;
mod sending;
mod showing;

use std::sync::Arc;
use std::time::Duration;

use pyrophone_recording::Cut;
use pyrophone_settings::Recent;
use pyrophone_settings::session::{self, Session};
use pyrophone_synthesis::controls::SLOTS;
use pyrophone_training::Store;

use crate::loader::clip_loader::ClipLoader;
use crate::loader::engine::Engine;
use crate::loader::job::Job;
use crate::loader::learner::Learner;
use crate::loader::link::LoaderLink;
use crate::loader::mailbox::Mailbox;
use crate::loader::motion::Motion;
use crate::loader::slot::Slot;
use crate::loader::source::Failure;
use crate::loader::status::Status;
use crate::parameters::EffectParams;

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
    clip_loader: ClipLoader,
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
            clip_loader: ClipLoader::default(),
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
            let batch = self.mailbox.take_batch(TICK);
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

    /// Slots in order of priority.
    fn order(&self) -> impl Iterator<Item = usize> + use<> {
        let shown = self.shown;
        std::iter::once(shown).chain((0..SLOTS).filter(move |slot| *slot != shown))
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

    /// Work besides the engines' data: a file to learn from, a recording to monitor.
    fn attend(&mut self, job: &Job) -> Result<(), Failure> {
        let Some(engine) = self.engine else { return Ok(()) };
        let values = self.params.values();
        match self.learner.work(&mut self.session, &engine, &values, job) {
            Ok(false) => {}
            Ok(true) => self.params.session.store(&self.session),
            Err(Failure::Cancelled) => return Err(Failure::Cancelled),
            Err(Failure::Message(message)) => self.status.fail(message),
        }
        let cut = self.cut(self.shown);
        let of = self.slots[self.shown].recording.as_deref().map(|recording| (recording, &cut));
        match self.clip_loader.make(of, engine.sample_rate_hz.round() as u32, job) {
            Err(Failure::Message(message)) => {
                self.clip_loader.want(false);
                self.status.fail(message);
                Ok(())
            }
            done => done,
        }
    }
}
