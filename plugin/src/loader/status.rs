//! What the editor shows of the loader's work.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::session::Cut;
use pyrophone_synthesis::controls::SLOTS;

use crate::analysis::Portrait;

/// A moment of the loader.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct View {
    /// The slot that is shown.
    pub slot: usize,
    /// Recordings by slot, as [`recording`](Self::recording) is.
    pub slots: [Option<String>; SLOTS],
    /// Whether the session names a recording, by slot, be it found or not.
    pub is_named: [bool; SLOTS],
    /// The recording that sounds: name, length, rate, channels.
    pub recording: Option<String>,
    /// What is drawn of it.
    pub portrait: Option<Arc<Portrait>>,
    /// Which part of it is learnt from.
    pub cut: Cut,
    /// Amplitudes at equal steps of probability of what is matched: of the recording, and of the drive where it was learned.
    pub amplitudes: [Option<Arc<[f32]>>; 2],
    /// Crackles a second that were split off it, where there are any.
    pub crackles_per_s: Option<f32>,
    /// Whether it is ready to be listened to.
    pub has_tape: bool,
    /// Recordings that were loaded of late, the latest first.
    pub recent: Vec<String>,
    /// Path of the recording that the session names, whether or not it was found.
    pub path: Option<String>,
    /// What is under way, and how much of it is done (0-1).
    pub progress: Option<(String, f32)>,
    /// The last thing that went wrong, until something goes right.
    pub error: Option<String>,
    /// What was done and is worth a word.
    pub notice: Option<String>,
    /// The learned distribution, or that there is none.
    pub learned: Option<String>,
    /// Amplitudes learned so far, while learning.
    pub learning: Option<usize>,
    /// The speed field: name, length, sources.
    pub field: Option<String>,
    /// Whether the recording itself is kept in the session.
    pub embed: bool,
}

/// The present moment; the loader writes it, the editor reads it.
pub struct Status {
    view: Mutex<View>,
    notifier: RepaintNotifier,
}

impl Status {
    /// Nothing is loaded; `notifier` wakes the window at changes.
    pub fn new(notifier: RepaintNotifier) -> Self {
        Self { view: Mutex::default(), notifier }
    }

    /// The present moment.
    pub fn view(&self) -> View {
        self.lock().clone()
    }

    /// Changes the moment.
    pub fn update(&self, change: impl FnOnce(&mut View)) {
        change(&mut self.lock());
        self.notifier.request_repaint();
    }

    /// Says what went wrong.
    pub fn fail(&self, message: String) {
        nice_plug::prelude::nice_warn!("{message}");
        self.update(|view| view.error = Some(message));
    }

    fn lock(&self) -> MutexGuard<'_, View> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
