//! Work with files, on a separate thread so that the window does not wait.

use std::sync::Mutex;
use std::sync::mpsc::{Receiver, channel};
use std::thread::JoinHandle;

/// Task under way; dropping it waits for its end, so that no thread outlives the plug-in.
pub struct Task<T> {
    outcome: Mutex<Receiver<T>>,
    thread: Option<JoinHandle<()>>,
}

impl<T: Send + 'static> Task<T> {
    /// Does `work` on a thread called `name`, then calls `end`. None where the system cannot start a thread.
    pub fn start(
        name: &str,
        work: impl FnOnce() -> T + Send + 'static,
        end: impl FnOnce() + Send + 'static,
    ) -> Option<Self> {
        let (sender, receiver) = channel();
        let thread = move || {
            // Fails only if the window is gone, and then nobody needs the result.
            let _ = sender.send(work());
            end();
        };
        let thread = std::thread::Builder::new().name(name.to_owned()).spawn(thread).ok()?;
        Some(Self { outcome: Mutex::new(receiver), thread: Some(thread) })
    }

    /// The result, once.
    pub fn poll(&mut self) -> Option<T> {
        self.outcome.get_mut().unwrap_or_else(std::sync::PoisonError::into_inner).try_recv().ok()
    }
}

impl<T> Drop for Task<T> {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            // A panic in there only means that nothing was done.
            let _ = thread.join();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outcome_comes_once_and_the_end_is_waited_for() {
        let (sender, receiver) = channel();
        let mut task = Task::start("test", || 7, move || sender.send(()).expect("somebody listens")).expect("a thread");
        receiver.recv().expect("an end");
        assert_eq!((task.poll(), task.poll()), (Some(7), None));
    }
}
