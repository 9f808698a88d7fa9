//! Exchange of objects between the loader and the audio thread.
//!
//! New objects travel one way, and the objects that they replace travel back. The audio thread takes an object only when
//! there is room to return the one that it may replace, so it never frees anything and never waits. Written over any
//! pair of rings, so that every interleaving of the two threads can be checked (`tests/it/exchange.rs`).

/// The writing end of a ring.
pub trait Push<T> {
    /// Appends an item, or hands it back when there is no room.
    fn push(&mut self, item: T) -> Result<(), T>;
    /// True if there is no room; otherwise there is room at least until the next push.
    fn is_full(&self) -> bool;
}

/// The reading end of a ring.
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
    /// Sends through `updates`; objects returned through `retired` are freed here.
    pub fn new(updates: U, retired: R) -> Self {
        Self { updates, retired }
    }

    /// Sends an object; returns false if there was no room.
    pub fn send<T>(&mut self, update: T) -> bool
    where
        U: Push<T>,
    {
        self.updates.push(update).is_ok()
    }

    /// Frees the objects returned by the audio thread.
    pub fn free_retired<T>(&mut self)
    where
        R: Pop<T>,
    {
        while self.retired.pop().is_some() {}
    }
}

impl<U, R> Receiver<U, R> {
    /// Receives from `updates`, returns objects through `retired`.
    pub fn new(updates: U, retired: R) -> Self {
        Self { updates, retired }
    }

    /// The next new object, as long as there is room to return what it replaces.
    pub fn receive<T, Old>(&mut self) -> Option<T>
    where
        U: Pop<T>,
        R: Push<Old>,
    {
        if self.retired.is_full() { None } else { self.updates.pop() }
    }

    /// Returns the object replaced by the one last [received](Self::receive).
    pub fn retire<Old>(&mut self, old: Old)
    where
        R: Push<Old>,
    {
        // `receive` has ensured that there is room; if there were none after all, leaking is the only option that
        // neither waits nor frees.
        if let Err(unsent) = self.retired.push(old) {
            std::mem::forget(unsent);
        }
    }
}
