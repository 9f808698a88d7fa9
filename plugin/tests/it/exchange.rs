//! The exchange of recordings between loader and audio thread, in every interleaving of the two.

use std::cell::Cell;

use loom::cell::UnsafeCell;
use loom::sync::Arc;
use loom::sync::atomic::{AtomicUsize, Ordering};
use pyrophone::loader::exchange::{Pop, Push, Receiver, Sender};

/// A ring for one writer and one reader, of loom's parts: stands in for the real one, whose order
/// of writes and reads it has.
struct Ring<T, const N: usize> {
    slots: [UnsafeCell<Option<T>>; N],
    written: AtomicUsize,
    read: AtomicUsize,
}

struct Writer<T, const N: usize>(Arc<Ring<T, N>>);
struct Reader<T, const N: usize>(Arc<Ring<T, N>>);

fn ring<T, const N: usize>() -> (Writer<T, N>, Reader<T, N>) {
    let slots = std::array::from_fn(|_| UnsafeCell::new(None));
    let ring = Arc::new(Ring { slots, written: AtomicUsize::new(0), read: AtomicUsize::new(0) });
    (Writer(ring.clone()), Reader(ring))
}

impl<T, const N: usize> Push<T> for Writer<T, N> {
    fn push(&mut self, item: T) -> Result<(), T> {
        if self.is_full() {
            return Err(item);
        }
        let written = self.0.written.load(Ordering::Relaxed);
        // SAFETY: the only writer, and the reader stays away from a slot until `written` is past it;
        // loom itself watches over it.
        self.0.slots[written % N].with_mut(|slot| unsafe { *slot = Some(item) });
        self.0.written.store(written + 1, Ordering::Release);
        Ok(())
    }

    fn is_full(&self) -> bool {
        self.0.written.load(Ordering::Relaxed) - self.0.read.load(Ordering::Acquire) == N
    }
}

impl<T, const N: usize> Pop<T> for Reader<T, N> {
    fn pop(&mut self) -> Option<T> {
        let read = self.0.read.load(Ordering::Relaxed);
        if read == self.0.written.load(Ordering::Acquire) {
            return None;
        }
        // SAFETY: the only reader, of a slot that has been written and will not be written again
        // until `read` is past it; loom itself watches over it.
        let item = self.0.slots[read % N].with_mut(|slot| unsafe { (*slot).take() });
        self.0.read.store(read + 1, Ordering::Release);
        item
    }
}

loom::thread_local! {
    static ON_AUDIO_THREAD: Cell<bool> = Cell::new(false);
}

/// A dictionary that must be freed exactly once, and never by the audio thread.
struct Dictionary(Arc<AtomicUsize>);

impl Drop for Dictionary {
    fn drop(&mut self) {
        assert!(!ON_AUDIO_THREAD.with(Cell::get), "the audio thread freed a dictionary");
        self.0.fetch_add(1, Ordering::Relaxed);
    }
}

/// Engines that hold one dictionary.
struct Engine {
    dictionary: Option<Dictionary>,
}

impl Engine {
    /// As `Audio::receive_updates`.
    fn process<const U: usize, const R: usize>(
        &mut self,
        taker: &mut Receiver<Reader<Option<Dictionary>, U>, Writer<Dictionary, R>>,
    ) {
        while let Some(new) = taker.receive() {
            let old = std::mem::replace(&mut self.dictionary, new);
            if let Some(old) = old {
                taker.retire(old);
            }
        }
    }
}

fn check<const UPDATES: usize, const RETIRED: usize>(sent: usize, blocks: usize) {
    loom::model(move || {
        let freed = Arc::new(AtomicUsize::new(0));
        let (updates_in, updates_out) = ring::<Option<Dictionary>, UPDATES>();
        let (retired_in, retired_out) = ring::<Dictionary, RETIRED>();
        let mut giver = Sender::new(updates_in, retired_out);
        let mut taker = Receiver::new(updates_out, retired_in);
        let audio = loom::thread::spawn(move || {
            ON_AUDIO_THREAD.with(|here| here.set(true));
            let mut engine = Engine { dictionary: None };
            for _ in 0..blocks {
                engine.process(&mut taker);
            }
            (engine, taker)
        });
        let mut accepted = 0;
        for _ in 0..sent {
            accepted += usize::from(giver.send(Some(Dictionary(freed.clone()))));
            giver.free_retired();
        }
        let (mut engine, mut taker) = audio.join().unwrap();
        // The host plays on: what is under way arrives, and what it replaces comes back.
        for _ in 0..sent {
            engine.process(&mut taker);
            giver.free_retired();
        }
        let held = usize::from(engine.dictionary.is_some());
        assert_eq!(held, usize::from(accepted > 0), "the last dictionary did not arrive");
        assert_eq!(freed.load(Ordering::Relaxed), sent - held, "leaked, or freed too soon");
        drop(engine);
        assert_eq!(freed.load(Ordering::Relaxed), sent);
    });
}

#[test]
fn nothing_leaks_and_nothing_is_lost() {
    check::<2, 2>(2, 2);
    check::<1, 1>(2, 2);
    check::<2, 1>(3, 2);
}

#[test]
#[should_panic(expected = "the audio thread freed a dictionary")]
fn freeing_on_the_audio_thread_would_be_noticed() {
    loom::model(|| {
        ON_AUDIO_THREAD.with(|here| here.set(true));
        drop(Dictionary(Arc::new(AtomicUsize::new(0))));
    });
}
