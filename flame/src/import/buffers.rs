//! Memory for whole files.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::error::{Error, FormatFault};
use super::file::open;

/// Bytes of a file from which on only some threads read at a time: what is read is smaller than the file, and what is done with it
/// takes longer.
const LARGE_BYTES: u64 = 16 << 20;

/// Memory in which files were read, for the next ones. As large pieces of a heap it would leave holes that the next file, a little
/// larger, does not fit in.
#[derive(Debug, Default)]
pub(super) struct Buffers {
    state: Mutex<State>,
    /// Signalled when a thread has finished reading a large file.
    finished: Condvar,
}

#[derive(Debug, Default)]
struct State {
    spare: Vec<Vec<u8>>,
    /// Threads that are reading large files.
    reading: usize,
}

/// Permission to read a large file, until it is dropped.
struct Permit<'a>(&'a Buffers);

impl Drop for Permit<'_> {
    fn drop(&mut self) {
        self.0.state().reading -= 1;
        self.0.finished.notify_one();
    }
}

impl Buffers {
    /// The bytes of a file for `use_it`, which must not wait for other threads.
    pub fn with_file<T>(&self, path: &Path, use_it: impl FnOnce(&[u8]) -> Result<T, Error>) -> Result<T, Error> {
        let (file, size) = open(path)?;
        let _permit = (size > LARGE_BYTES).then(|| self.permit());
        let mut bytes = self.state().spare.pop().unwrap_or_default();
        let used = read(file, size, path, &mut bytes).and_then(|()| use_it(&bytes));
        self.state().spare.push(bytes);
        used
    }

    /// Waits until fewer than half of the pool's threads read large files. A thread of the pool may wait: those that read depend on
    /// no other thread.
    fn permit(&self) -> Permit<'_> {
        self.permit_of((rayon::current_num_threads() / 2).max(1))
    }

    /// Waits until fewer than `most` threads read large files.
    fn permit_of(&self, most: usize) -> Permit<'_> {
        let state = self.finished.wait_while(self.state(), |state| state.reading >= most);
        state.unwrap_or_else(PoisonError::into_inner).reading += 1;
        Permit(self)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A thread that panicked has left a valid state: its permit has ended.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads a whole file into `bytes`.
fn read(file: File, size: u64, path: &Path, bytes: &mut Vec<u8>) -> Result<(), Error> {
    let too_large = |_| Error::of_file(path)(FormatFault::Unreadable("out of memory".into()));
    bytes.clear();
    // A little more, because the next file is often a little larger.
    bytes.try_reserve_exact(usize::try_from(size + size / 16).unwrap_or(usize::MAX)).map_err(too_large)?;
    // Data appended meanwhile is not read.
    file.take(size).read_to_end(bytes).map_err(Error::of_system(path))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn large_files_are_read_by_half_of_the_threads_at_a_time() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        let buffers = Buffers::default();
        let (asks, reading) = (AtomicBool::new(false), AtomicUsize::new(0));
        // More than once: a thread that did not wait might be late by chance.
        for _ in 0..50 {
            asks.store(false, Ordering::SeqCst);
            pool.in_place_scope(|scope| {
                let held = [buffers.permit_of(2), buffers.permit_of(2)];
                scope.spawn(|_| {
                    asks.store(true, Ordering::SeqCst);
                    let _permit = buffers.permit();
                    reading.fetch_max(buffers.state().reading, Ordering::SeqCst);
                });
                while !asks.load(Ordering::SeqCst) {
                    std::thread::yield_now();
                }
                (0..50).for_each(|_| std::thread::yield_now());
                drop(held);
            });
        }
        assert!((1..=2).contains(&reading.load(Ordering::SeqCst)));
        assert_eq!(buffers.state().reading, 0);
    }

    #[test]
    fn memory_of_a_file_is_used_again() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let buffers = Buffers::default();
        for size in [100, 7, 0, 50] {
            std::fs::write(&path, vec![size as u8; size]).unwrap();
            assert_eq!(buffers.with_file(&path, |bytes| Ok(bytes.to_vec())).unwrap(), vec![size as u8; size]);
            assert!(buffers.state().spare.len() == 1 && buffers.state().spare[0].capacity() >= 100);
        }
        assert!(buffers.with_file(&folder.path().join("none"), |_| Ok(())).is_err());
    }

    #[test]
    fn a_permit_ends_with_a_failure_and_with_a_panic() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("large");
        File::create(&path).unwrap().set_len(LARGE_BYTES + 1).unwrap();
        let buffers = Buffers::default();
        for _ in 0..2 {
            let failed = || Err(Error::of_file(&path)(FormatFault::Unreadable("it is a test".into())));
            assert!(buffers.with_file(&path, |_| -> Result<(), Error> { failed() }).is_err());
            let panicked =
                std::panic::catch_unwind(|| buffers.with_file(&path, |_| -> Result<(), Error> { panic!("a test") }));
            assert!(panicked.is_err());
        }
        assert_eq!(buffers.state().reading, 0);
    }
}
