//! State of the loader as shown by the editor.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use nice_plug_egui::RepaintNotifier;
use pyrophone_settings::session::Cut;
use pyrophone_synthesis::controls::SLOTS;

use pyrophone_analysis::RecordingOverview;

/// A moment of the loader.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct View {
    /// The slot that is shown.
    pub slot: usize,
    /// Recordings by slot, as [`recording`](Self::recording) is.
    pub slots: [Option<String>; SLOTS],
    /// True for each slot with a recording in the session, whether or not it was found.
    pub is_named: [bool; SLOTS],
    /// The recording that sounds: name, length, rate, channels.
    pub recording: Option<String>,
    /// Its picture.
    pub overview: Option<Arc<RecordingOverview>>,
    /// Part of it used for learning.
    pub cut: Cut,
    /// Matched amplitudes at equal steps of probability: those of the recording, and of the drive if learned.
    pub amplitudes: [Option<Arc<[f32]>>; 2],
    /// Crackles a second separated from it, if any.
    pub crackles_per_s: Option<f32>,
    /// True if it is ready for monitoring.
    pub has_clip: bool,
    /// Recently loaded recordings, the latest first.
    pub recent: Vec<String>,
    /// Path of the session's recording, whether or not it was found.
    pub path: Option<String>,
    /// Current work, and its progress (0-1).
    pub progress: Option<(String, f32)>,
    /// The last error, until something succeeds.
    pub error: Option<String>,
    /// Notice about completed work.
    pub notice: Option<String>,
    /// Description of the learned distribution, or of its absence.
    pub learned: Option<String>,
    /// Amplitudes learned so far, while learning.
    pub learning: Option<usize>,
    /// The speed field: name, length, sources.
    pub field: Option<String>,
    /// True if the recording is embedded in the session.
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

    /// Sets the error message.
    pub fn fail(&self, message: String) {
        nice_plug::prelude::nice_warn!("{message}");
        self.update(|view| view.error = Some(message));
    }

    fn lock(&self) -> MutexGuard<'_, View> {
        self.view.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
