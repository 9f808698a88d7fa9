//! Slow work: decoding, resampling, indexing, learning. One thread per instance, joined when the instance is dropped.
//!
//! | module | content |
//! |---|---|
//! | [`mailbox`] | orders to the thread, and waiting for their completion |
//! | [`worker`] | the thread |
//! | [`job`] | one attempt at the missing work, and its progress |
//! | [`engine`] | properties of the running engines |
//! | [`slot`] | the loader's state of one recording |
//! | [`source`] | from a path or a session to a decoded recording |
//! | [`cache`] | things shared by instances of one process |
//! | [`learner`] | the learned distribution |
//! | [`motion`] | the speed field |
//! | [`clip_loader`] | the recording for monitoring |
//! | [`link`] | rings between the thread and the audio thread |
//! | [`status`] | the thread's state as shown by the editor |

pub mod cache;
pub mod clip_loader;
pub mod engine;
pub mod exchange;
pub mod job;
pub mod learner;
pub mod link;
pub mod mailbox;
pub mod motion;
pub mod slot;
pub mod source;
pub mod status;
pub mod worker;

use std::path::PathBuf;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;

use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::session::{self, Cut};
use pyrophone_settings::{PresetRecording, Recent};

use crate::parameters::EffectParams;
use crate::persist::SessionStore;
pub use engine::Engine;
use link::{AudioLink, Shared};
use mailbox::{Mailbox, Order, Ticket};
use status::Status;
use worker::Worker;

/// A handle to the loader's thread, for the editor.
#[derive(Clone)]
pub struct LoaderHandle {
    mailbox: Arc<Mailbox>,
    /// State of the thread.
    pub status: Arc<Status>,
    /// The switches it shares with the audio thread.
    pub shared: Arc<Shared>,
}

/// The loader's thread; dropping it cancels its work and waits for its end.
pub struct Loader {
    handle: LoaderHandle,
    thread: Option<JoinHandle<()>>,
}

impl Loader {
    /// Starts the thread; returns the parameters it follows and the audio thread's ends of its rings. If no thread can
    /// be started, recordings cannot be loaded, and the status says so. `recent` is the list of recordings loaded by
    /// the user.
    pub fn start(notifier: RepaintNotifier, recent: Option<Recent>) -> (Self, Arc<EffectParams>, AudioLink) {
        let mailbox = Arc::new(Mailbox::default());
        let session = {
            let mailbox = mailbox.clone();
            Arc::new(SessionStore::new(move || mailbox.post(Order::ReadSession)))
        };
        let params = Arc::new(EffectParams::new(session));
        let status = Arc::new(Status::new(notifier));
        let (link, audio_link) = link::pair();
        let handle = LoaderHandle { mailbox: mailbox.clone(), status: status.clone(), shared: link.shared.clone() };
        let worker = Worker::new(mailbox, params.clone(), status.clone(), link, recent);
        let thread = std::thread::Builder::new().name("pyrophone-loader".to_owned()).spawn(move || worker.run());
        if let Err(error) = &thread {
            status.fail(format!(
                "no recordings can be loaded, because the system cannot start a thread ({error}); close other programs"
            ));
        }
        (Self { handle, thread: thread.ok() }, params, audio_link)
    }

    /// A handle for the editor.
    pub fn handle(&self) -> LoaderHandle {
        self.handle.clone()
    }

    /// Sets the running engine; its dictionary and distribution are sent again.
    pub fn set_engine(&self, engine: Engine) -> Ticket {
        self.handle.mailbox.post_ticketed(Order::Engine(engine))
    }

    /// Waits until everything ordered up to `ticket` is done, or `limit` is over (`None`: no limit); returns whether it
    /// is done.
    pub fn wait(&self, ticket: Ticket, limit: Option<Duration>) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) && self.handle.mailbox.wait(ticket, limit)
    }
}

impl Loader {
    /// Waits until everything ordered so far is done, without a limit; returns whether it is done.
    pub fn wait_for_all(&self) -> bool {
        self.thread.as_ref().is_some_and(|thread| !thread.is_finished()) && self.handle.mailbox.wait_for_all()
    }
}

impl LoaderHandle {
    /// Loads a recording; the latest call wins, and the old sound plays on until it is ready.
    pub fn load(&self, path: PathBuf) {
        self.mailbox.post(Order::Load(path));
    }

    /// Loads a preset's recording into a slot; if it cannot be loaded, the old one stays.
    pub fn load_preset(&self, slot: usize, recording: PresetRecording) {
        self.mailbox.post(Order::LoadPreset(slot, recording));
    }

    /// Puts the recording back into a slot that was there before, or empties the slot.
    pub fn restore(&self, slot: usize, before: session::Slot) {
        self.mailbox.post(Order::Restore(slot, before));
    }

    /// Removes the recording.
    pub fn unload(&self) {
        self.mailbox.post(Order::Unload);
    }

    /// Cancels loading or indexing; the current sound continues.
    pub fn cancel(&self) {
        self.mailbox.post(Order::Cancel);
    }

    /// Learns from this part of the recording, at this level.
    pub fn set_cut(&self, cut: Cut) {
        self.mailbox.post(Order::Cut(cut));
    }

    /// Learns the distribution of the drive's amplitudes from a file, as if it had been played.
    pub fn learn_from(&self, path: PathBuf) {
        self.mailbox.post(Order::LearnFrom(path));
    }

    /// Saves the part of the recording used for learning, at its level, as a WAV file.
    pub fn save_part(&self, path: PathBuf) {
        self.mailbox.post(Order::SavePart(path));
    }

    /// Prepares the recording for monitoring, or not.
    pub fn audition(&self, wanted: bool) {
        self.mailbox.post(Order::Audition(wanted));
    }

    /// Embeds the recording in the session, or not.
    pub fn set_embed(&self, embed: bool) {
        self.mailbox.post(Order::Embed(embed));
    }

    /// Loads the speed field of vortex sound from a file.
    pub fn load_field(&self, path: PathBuf) {
        self.mailbox.post(Order::LoadField(path));
    }

    /// Does without a speed field.
    pub fn unload_field(&self) {
        self.mailbox.post(Order::UnloadField);
    }

    /// Forgets the learned distribution.
    pub fn forget_learned(&self) {
        self.mailbox.post(Order::ForgetLearned);
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.handle.mailbox.quit();
        if let Some(thread) = self.thread.take() {
            // A panic in the thread has been reported by the thread itself.
            let _ = thread.join();
        }
    }
}
