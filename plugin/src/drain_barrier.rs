//! Waits until the framework's background thread has no more tasks of an instance.
//!
//! All instances of a process share that thread. It ends when it meets a task of an instance that no longer exists, and
//! the next instance to be dropped then aborts the host. So an instance posts a task that does nothing and waits until
//! it has run: all its earlier tasks have then run too.
//!
//! While it runs a task, that thread owns a reference to the instance. If the host dropped its own reference at that
//! moment, the instance would be dropped on that thread, which would then try to join itself and deadlock. So the wait
//! polls, instead of being woken at exactly that point, and after the task there is one more pause.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Longest wait: a host that stops its window thread must not hang for good.
const LIMIT: Duration = Duration::from_secs(1);
/// Time between two checks of the count.
const POLL_INTERVAL: Duration = Duration::from_micros(200);
/// Time for the thread to drop its reference to the instance after its task; a few nanoseconds unless the thread is
/// interrupted.
const GRACE: Duration = Duration::from_millis(3);

/// A count of tasks that have run.
#[derive(Clone, Default)]
pub struct DrainBarrier(Arc<AtomicU64>);

impl DrainBarrier {
    /// Called by the task.
    pub fn pass(&self) {
        self.0.fetch_add(1, Ordering::Release);
    }

    /// Posts the task by `post` and waits until it has run; returns false at the time limit.
    pub fn wait(&self, post: impl FnOnce()) -> bool {
        let before = self.0.load(Ordering::Acquire);
        post();
        let began = Instant::now();
        while self.0.load(Ordering::Acquire) == before {
            if began.elapsed() > LIMIT {
                return false;
            }
            std::thread::sleep(POLL_INTERVAL);
        }
        std::thread::sleep(GRACE);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_for_the_task() {
        let barrier = DrainBarrier::default();
        for _ in 0..3 {
            let task = barrier.clone();
            assert!(barrier.wait(|| drop(std::thread::spawn(move || task.pass()))));
        }
        assert!(!barrier.wait(|| {}), "a task that never runs ends the wait at its limit");
    }
}
