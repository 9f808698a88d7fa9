//! Lets an instance wait until the framework's background thread has nothing of it left.
//!
//! All instances of a process share that thread. It ends when it meets a task of an instance that
//! is gone, and the next instance to go then aborts the host. So an instance posts a task that
//! does nothing and waits until it has run: all its earlier tasks have then run too.
//!
//! While it runs a task, that thread owns a share of the instance. If the host let go of its own
//! share in that moment, the instance would end on that thread, which then tries to join itself
//! and is lost. So the wait is by naps, never by a wake-up that would interrupt the thread right
//! there, and after the task there is one more nap.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// The longest wait: a host that stops its window thread must not hang for good.
const LIMIT: Duration = Duration::from_secs(1);
/// How long to sleep between two looks at the count.
const POLL_INTERVAL: Duration = Duration::from_micros(200);
/// In this time the thread lets go of the instance after its task; it takes a few nanoseconds
/// unless the thread is interrupted.
const GRACE: Duration = Duration::from_millis(3);

/// A count of tasks that have run.
#[derive(Clone, Default)]
pub struct Fence(Arc<AtomicU64>);

impl Fence {
    /// To be called by the task.
    pub fn pass(&self) {
        self.0.fetch_add(1, Ordering::Release);
    }

    /// Posts the task by `post` and waits until it has run; whether it has within the limit.
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
        let fence = Fence::default();
        for _ in 0..3 {
            let task = fence.clone();
            assert!(fence.wait(|| drop(std::thread::spawn(move || task.pass()))));
        }
        assert!(!fence.wait(|| {}), "a task that never runs ends the wait at its limit");
    }
}
