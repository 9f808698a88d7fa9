//! Orders to the loader's thread.
//!
//! The latest order of a kind wins. Orders that make the work under way useless call it off.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use pyrophone_settings::session::Cut;

use super::engine::Engine;

/// Something for the loader to do.
#[derive(Debug, Clone, PartialEq)]
pub enum Order {
    /// Load this file.
    Load(PathBuf),
    /// Do without a recording.
    Unload,
    /// Give up what is under way.
    Cancel,
    /// Learn from this part of the recording.
    Cut(Cut),
    /// Read the session that the host has loaded.
    ReadSession,
    /// This engine runs from now on.
    Engine(Engine),
    /// Keep the recording itself in the session.
    Embed(bool),
    /// Learn the drive's distribution from this file.
    LearnFrom(PathBuf),
    /// Save the part of the recording that is learnt from as this file.
    SavePart(PathBuf),
    /// Forget the learned distribution.
    ForgetLearned,
    /// Have the recording ready to be listened to, or not.
    Audition(bool),
    /// Take the speed field from this file.
    LoadField(PathBuf),
    /// Do without a speed field.
    UnloadField,
}

/// A place in the sequence of orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Ticket(u64);

/// The orders not yet taken, and how far the loader has come.
#[derive(Default)]
pub struct Mailbox {
    inner: Mutex<Inner>,
    arrived: Condvar,
    settled: Condvar,
    /// Counts what calls off the work under way.
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

/// What the loader takes at once.
pub struct Batch {
    /// The orders in their sequence.
    pub orders: Vec<Order>,
    /// The place of the last of them.
    pub ticket: Ticket,
    /// The count of what calls off work, at the time of taking.
    pub epoch: u64,
    /// Whether to end.
    pub quit: bool,
}

impl Mailbox {
    /// Gives an order.
    pub fn post(&self, order: Order) {
        self.post_ticketed(order);
    }

    /// Gives an order that can be waited for.
    pub fn post_ticketed(&self, order: Order) -> Ticket {
        let mut inner = self.lock();
        let calls_off = match &order {
            Order::Load(_) | Order::Unload | Order::ReadSession | Order::Cut(_) | Order::Cancel => true,
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

    /// Asks the loader to end; calls off its work.
    pub fn quit(&self) {
        self.lock().quit = true;
        self.epoch.fetch_add(1, Ordering::Relaxed);
        self.arrived.notify_one();
        self.settled.notify_all();
    }

    /// Whether work taken at `epoch` has been called off.
    pub fn is_called_off(&self, epoch: u64) -> bool {
        self.epoch.load(Ordering::Relaxed) != epoch
    }

    /// Takes all orders; waits for one for at most `patience`.
    pub fn take(&self, patience: Duration) -> Batch {
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

    /// Tells that everything up to `ticket` is done.
    pub fn settle(&self, ticket: Ticket) {
        self.lock().settled = ticket.0;
        self.settled.notify_all();
    }

    /// Waits until everything up to `ticket` is done, or `limit` is over; whether it is done.
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

    /// Waits until everything ordered so far is done; whether it is done.
    pub fn wait_for_all(&self) -> bool {
        let posted = Ticket(self.lock().posted);
        self.wait(posted, None)
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
