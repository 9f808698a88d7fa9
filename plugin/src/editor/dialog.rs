//! The system's file dialog, on a separate thread so that neither window nor sound waits for it.
//!
//! If the environment variable `PYROPHONE_DIALOG` names a path, that is chosen at once and no dialog is shown: for
//! tests, and for systems without a dialog.

use std::future::Future;
use std::path::{Path, PathBuf};
use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll, Wake, Waker};
use std::thread::{JoinHandle, Thread};
use std::time::{Duration, Instant};

use nice_plug_egui::RepaintNotifier;
use rfd::AsyncFileDialog;

/// File names that recordings have.
const EXTENSIONS: &[&str] =
    &["wav", "wave", "bwf", "rf64", "w64", "flac", "ogg", "oga", "mp3", "mp2", "aif", "aiff", "aifc", "caf"];

const VARIABLE: &str = "PYROPHONE_DIALOG";

/// Interval at which the thread checks for cancellation.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Least time in which a user cancels a dialog.
const QUICKEST: Duration = Duration::from_millis(300);

/// Purpose of the dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Ask {
    /// A recording of fire, or a speed field.
    Recording,
    /// A sound whose loudness is learned.
    Drive,
    /// A destination for a sound, with a suggested name.
    Save(String),
    /// A folder for presets.
    Folder,
}

/// Outcome of a dialog.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Answer {
    /// A file or folder.
    Chosen(PathBuf),
    /// Nothing, by the user's decision.
    Cancelled,
    /// Nothing, because the system shows no dialog.
    Unavailable,
}

impl Answer {
    /// The outcome of a dialog that was open for `open_for`. The library reports a dialog that could not be shown as one
    /// that was cancelled, but nobody reads and cancels one so quickly.
    fn of(chosen: Option<PathBuf>, open_for: Duration) -> Self {
        match chosen {
            Some(path) => Self::Chosen(path),
            None if open_for < QUICKEST => Self::Unavailable,
            None => Self::Cancelled,
        }
    }
}

/// An open dialog; dropping it cancels it.
pub struct Dialog {
    chosen: Mutex<Receiver<Answer>>,
    called_off: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

struct Unpark(Thread);

impl Wake for Unpark {
    fn wake(self: Arc<Self>) {
        self.0.unpark();
    }
}

impl Dialog {
    /// Opens the dialog in the folder of `path`; `notifier` wakes the window when it closes.
    pub fn open(ask: Ask, path: &str, notifier: RepaintNotifier) -> Self {
        let folder = Path::new(path).parent().filter(|folder| folder.is_dir()).map(Path::to_owned);
        let (sender, receiver) = channel();
        let answer = std::env::var_os(VARIABLE).map(PathBuf::from);
        let called_off = Arc::new(AtomicBool::new(false));
        let flag = called_off.clone();
        let ask = move || {
            let began = Instant::now();
            let chosen = answer.or_else(|| show(&ask, folder.as_deref(), &flag));
            // Fails only if the window is gone, and then nobody needs the answer.
            let _ = sender.send(Answer::of(chosen, began.elapsed()));
            notifier.request_repaint();
        };
        // Without a thread the receiver is disconnected, which reads as "unavailable".
        let thread = std::thread::Builder::new().name("pyrophone-dialog".to_owned()).spawn(ask).ok();
        Self { chosen: Mutex::new(receiver), called_off, thread }
    }

    /// The answer, once there is one.
    pub fn poll(&mut self) -> Option<Answer> {
        let receiver = self.chosen.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner);
        match receiver.try_recv() {
            Ok(chosen) => Some(chosen),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Answer::Unavailable),
        }
    }
}

impl Drop for Dialog {
    fn drop(&mut self) {
        self.called_off.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic in there only means that nothing was chosen.
            let _ = thread.join();
        }
    }
}

/// Shows the dialog, starting in a folder, and returns the choice.
fn show(ask: &Ask, folder: Option<&Path>, called_off: &AtomicBool) -> Option<PathBuf> {
    let mut dialog = AsyncFileDialog::new();
    if let Some(folder) = folder {
        dialog = dialog.set_directory(folder);
    }
    let sounds = |dialog: AsyncFileDialog| dialog.add_filter("Sound files", EXTENSIONS);
    let every = |dialog: AsyncFileDialog| dialog.add_filter("All files", &["*"]);
    let chosen = match ask {
        Ask::Recording => {
            let dialog = sounds(dialog.set_title("Load a recording of fire")).add_filter("Speed fields", &["field"]);
            wait_for(every(dialog).pick_file(), called_off)
        }
        Ask::Drive => {
            wait_for(every(sounds(dialog.set_title("Learn the loudness of a sound"))).pick_file(), called_off)
        }
        Ask::Save(name) => {
            let dialog = dialog.set_title("Save a sound").set_file_name(name).add_filter("WAV", &["wav"]);
            wait_for(dialog.save_file(), called_off)
        }
        Ask::Folder => wait_for(dialog.set_title("Choose the folder of your presets").pick_folder(), called_off),
    };
    chosen.flatten().map(|file| file.path().to_owned())
}

/// Runs a future to completion on this thread, or until cancelled.
fn wait_for<T>(future: impl Future<Output = T>, called_off: &AtomicBool) -> Option<T> {
    let waker = Waker::from(Arc::new(Unpark(std::thread::current())));
    let mut context = Context::from_waker(&waker);
    let mut future = pin!(future);
    while !called_off.load(Ordering::Relaxed) {
        if let Poll::Ready(value) = future.as_mut().poll(&mut context) {
            return Some(value);
        }
        std::thread::park_timeout(POLL_INTERVAL);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dialog_that_closes_at_once_was_never_shown() {
        let path = PathBuf::from("/a.wav");
        assert_eq!(Answer::of(Some(path.clone()), Duration::ZERO), Answer::Chosen(path));
        assert_eq!(Answer::of(None, Duration::from_millis(20)), Answer::Unavailable);
        assert_eq!(Answer::of(None, Duration::from_secs(2)), Answer::Cancelled);
    }

    #[test]
    fn a_future_ends_or_is_called_off() {
        let off = AtomicBool::new(false);
        assert_eq!(wait_for(std::future::ready(3), &off), Some(3));
        let off = AtomicBool::new(true);
        assert_eq!(wait_for(std::future::pending::<u8>(), &off), None);
    }
}
