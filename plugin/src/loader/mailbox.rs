//! Orders to the loader's thread.
//!
//! The latest order of a kind wins. Orders that make current work useless cancel it.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyrophone_settings::PresetRecording;
use pyrophone_settings::session::{Cut, Slot};

use super::engine::Engine;

/// Order to the loader.
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Load this file.
    Load(PathBuf),
    /// Load a preset's recording into this slot.
    LoadPreset(usize, PresetRecording),
    /// Put this recording, or none, back into this slot.
    Restore(usize, Slot),
    /// Do without a recording.
    Unload,
    /// Cancel the current work.
    Cancel,
    /// Learn from this part of the recording.
    Cut(Cut),
    /// Read the session that the host has loaded.
    ReadSession,
    /// Work for this engine from now on.
    Engine(Engine),
    /// Embed the recording in the session, or not.
    Embed(bool),
    /// Learn the drive's distribution from this file.
    LearnFrom(PathBuf),
    /// Save the part of the recording used for learning as this file.
    SavePart(PathBuf),
    /// Forget the learned distribution.
    ForgetLearned,
    /// Prepare the recording for monitoring, or not.
    Audition(bool),
    /// Load the speed field from this file.
    LoadField(PathBuf),
    /// Do without a speed field.
    UnloadField,
}

/// A position in the sequence of orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticket(u64);

/// The pending orders, and the loader's progress through them.
#[derive(Default)]
pub struct Mailbox {
    inner: Mutex<Inner>,
    arrived: Condvar,
    settled: Condvar,
    /// Number of orders so far that cancel current work.
    epoch: AtomicU64,
}

#[derive(Default)]
struct Inner {
    orders: Vec<Order>,
    engine: Option<Engine>,
    posted: u64,
    settled: u64,
    quit: bool,
}

/// Orders for the loader to carry out together.
pub struct Batch {
    /// The orders in their sequence.
    pub orders: Vec<Order>,
    /// The position of the last of them.
    pub ticket: Ticket,
    /// The number of cancelling orders at that time.
    pub epoch: u64,
    /// True if the loader is to end.
    pub quit: bool,
}

impl Mailbox {
    /// Posts an order.
    pub fn post(&self, order: Order) {
        self.post_ticketed(order);
    }

    /// Posts an order whose completion can be awaited.
    pub fn post_ticketed(&self, order: Order) -> Ticket {
        let mut inner = self.lock();
        let calls_off = match &order {
            Order::Load(_)
            | Order::LoadPreset(..)
            | Order::Restore(..)
            | Order::Unload
            | Order::ReadSession
            | Order::Cut(_)
            | Order::Cancel => true,
            // Hosts activate repeatedly with the same settings; work for these must not start again.
            Order::Engine(engine) => inner.engine.replace(*engine) != Some(*engine),
            Order::Embed(_)
            | Order::LearnFrom(_)
            | Order::SavePart(_)
            | Order::ForgetLearned
            | Order::Audition(_)
            | Order::LoadField(_)
            | Order::UnloadField => false,
        };
        if calls_off {
            self.epoch.fetch_add(1, Ordering::Relaxed);
        }
        inner.orders.push(order);
        inner.posted += 1;
        self.arrived.notify_one();
        Ticket(inner.posted)
    }

    /// Asks the loader to end; cancels its work.
    pub fn quit(&self) {
        self.lock().quit = true;
        self.epoch.fetch_add(1, Ordering::Relaxed);
        self.arrived.notify_one();
        self.settled.notify_all();
    }

    /// True if work begun at `epoch` has been cancelled.
    pub fn is_called_off(&self, epoch: u64) -> bool {
        self.epoch.load(Ordering::Relaxed) != epoch
    }

    /// Takes all orders; waits for one for at most `patience`.
    pub fn take_batch(&self, patience: Duration) -> Batch {
        let waits = |inner: &mut Inner| inner.orders.is_empty() && !inner.quit;
        let waited = self.arrived.wait_timeout_while(self.lock(), patience, waits);
        let mut inner = waited.unwrap_or_else(PoisonError::into_inner).0;
        Batch {
            orders: std::mem::take(&mut inner.orders),
            ticket: Ticket(inner.posted),
            epoch: self.epoch.load(Ordering::Relaxed),
            quit: inner.quit,
        }
    }

    /// Announces that everything up to `ticket` is done.
    pub fn settle(&self, ticket: Ticket) {
        self.lock().settled = ticket.0;
        self.settled.notify_all();
    }

    /// Waits until everything up to `ticket` is done, or `limit` is over; returns whether it is done.
    pub fn wait(&self, ticket: Ticket, limit: Option<Duration>) -> bool {
        let waits = |inner: &mut Inner| inner.settled < ticket.0 && !inner.quit;
        let inner = match limit {
            Some(limit) => {
                let waited = self.settled.wait_timeout_while(self.lock(), limit, waits);
                waited.unwrap_or_else(PoisonError::into_inner).0
            }
            None => self.settled.wait_while(self.lock(), waits).unwrap_or_else(PoisonError::into_inner),
        };
        inner.settled >= ticket.0
    }

    /// Waits until everything ordered so far is done; returns whether it is done.
    pub fn wait_for_all(&self) -> bool {
        let posted = Ticket(self.lock().posted);
        self.wait(posted, None)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
