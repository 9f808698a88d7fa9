//! Memory for whole files.

use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use super::error::{Error, FormatFault};
use super::sequence::open;

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

/// A thread's turn to read a large file, until it is dropped.
struct Turn<'a>(&'a Buffers);

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        self.0.state().reading -= 1;
        self.0.finished.notify_one();
    }
}

impl Buffers {
    /// The bytes of a file for `use_it`, which must not wait for other threads.
    pub fn with_file<T>(&self, path: &Path, use_it: impl FnOnce(&[u8]) -> Result<T, Error>) -> Result<T, Error> {
        let (file, size) = open(path)?;
        let _turn = (size > LARGE_BYTES).then(|| self.turn());
        let mut bytes = self.state().spare.pop().unwrap_or_default();
        let used = read(file, size, path, &mut bytes).and_then(|()| use_it(&bytes));
        self.state().spare.push(bytes);
        used
    }

    /// Waits until fewer than half of the pool's threads read large files.
    fn turn(&self) -> Turn<'_> {
        let most = (rayon::current_num_threads() / 2).max(1);
        let state = self.finished.wait_while(self.state(), |state| state.reading >= most);
        state.unwrap_or_else(PoisonError::into_inner).reading += 1;
        Turn(self)
    }

    fn state(&self) -> MutexGuard<'_, State> {
        // A thread that panicked has left a valid state: its turn has ended.
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
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    #[test]
    fn large_files_are_read_by_some_threads_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let path = |large: bool| folder.path().join(if large { "large" } else { "small" });
        File::create(path(true)).unwrap().set_len(LARGE_BYTES + 1).unwrap();
        std::fs::write(path(false), [7; 100]).unwrap();
        let buffers = Buffers::default();
        let (now, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let look = |bytes: &[u8]| {
            most.fetch_max(now.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
            std::thread::sleep(std::time::Duration::from_millis(2));
            now.fetch_sub(1, Ordering::SeqCst);
            Ok(bytes.len())
        };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build().unwrap();
        pool.broadcast(|_| {
            for _ in 0..3 {
                assert_eq!(buffers.with_file(&path(true), look).unwrap(), LARGE_BYTES as usize + 1);
            }
        });
        assert!((1..=2).contains(&most.load(Ordering::SeqCst)));
        assert_eq!(buffers.with_file(&path(false), |bytes| Ok(bytes.to_vec())).unwrap(), [7; 100]);
        assert!(buffers.with_file(&folder.path().join("none"), look).is_err());
        let state = buffers.state();
        assert!(state.reading == 0 && (1..=2).contains(&state.spare.len()));
    }

    #[test]
    fn a_turn_ends_with_a_failure_and_with_a_panic() {
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
