//! How things change hands between the loader and the audio thread.
//!
//! What is new travels one way, what it replaces the other way: the audio thread takes something
//! only when there is room to give back what it may replace, so it never frees anything and never
//! waits. Written over any pair of rings, so that every interleaving of the two threads can be
//! checked (`tests/it/exchange.rs`).

/// The end of a ring that things are put into.
pub trait Push<T> {
    /// Puts it in, or hands it back when there is no room.
    fn push(&mut self, item: T) -> Result<(), T>;
    /// Whether there is no room; once there is, it stays until something is put in.
    fn is_full(&self) -> bool;
}

/// The end of a ring that things are taken out of.
pub trait Pop<T> {
    /// The oldest, if there is one.
    fn pop(&mut self) -> Option<T>;
}

/// The loader's end.
#[derive(Debug)]
pub struct Sender<U, R> {
    updates: U,
    retired: R,
}

/// The audio thread's end; real-time safe as long as its rings are.
#[derive(Debug)]
pub struct Receiver<U, R> {
    updates: U,
    retired: R,
}

impl<U, R> Sender<U, R> {
    /// Sends through `updates`; what comes back through `retired` is freed here.
    pub fn new(updates: U, retired: R) -> Self {
        Self { updates, retired }
    }

    /// Sends something new; whether there was room.
    pub fn send<T>(&mut self, update: T) -> bool
    where
        U: Push<T>,
    {
        self.updates.push(update).is_ok()
    }

    /// Frees what the audio thread has given up.
    pub fn free_retired<T>(&mut self)
    where
        R: Pop<T>,
    {
        while self.retired.pop().is_some() {}
    }
}

impl<U, R> Receiver<U, R> {
    /// Takes from `updates`, gives back through `retired`.
    pub fn new(updates: U, retired: R) -> Self {
        Self { updates, retired }
    }

    /// The next new thing, as long as there is room to give back what it replaces.
    pub fn receive<T, Old>(&mut self) -> Option<T>
    where
        U: Pop<T>,
        R: Push<Old>,
    {
        if self.retired.is_full() { None } else { self.updates.pop() }
    }

    /// Gives up what the last thing [received](Self::receive) has replaced.
    pub fn retire<Old>(&mut self, old: Old)
    where
        R: Push<Old>,
    {
        // `receive` has made sure of the room; were there none after all, leaking is the only
        // thing that neither waits nor frees.
        if let Err(unsent) = self.retired.push(old) {
            std::mem::forget(unsent);
        }
    }
}
