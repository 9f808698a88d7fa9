//! Things shared by instances of one process: each is created once and lives as long as it is in use. Only loaders
//! access it.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Condvar, LazyLock, Mutex, MutexGuard, PoisonError, Weak};
use std::time::Duration;

use pyrophone_recording::Recording;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_training::DictionaryKey;

/// Polling interval for cancellation of a loader that waits for another one.
const POLL_INTERVAL: Duration = Duration::from_millis(20);

/// Decoded recordings by content hash.
pub static RECORDINGS: LazyLock<Cache<String, Recording>> = LazyLock::new(Cache::default);

/// Dictionaries by their origin.
pub static DICTIONARIES: LazyLock<Cache<DictionaryKey, RecordingDictionary>> = LazyLock::new(Cache::default);

enum Entry<V> {
    /// Some loader is at it.
    Underway,
    Made(Weak<V>),
}

/// A map that does not keep its values alive.
pub struct Cache<K, V> {
    entries: Mutex<HashMap<K, Entry<V>>>,
    changed: Condvar,
}

impl<K, V> Default for Cache<K, V> {
    fn default() -> Self {
        Self { entries: Mutex::new(HashMap::new()), changed: Condvar::new() }
    }
}

impl<K, V> Cache<K, V> {
    fn lock(&self) -> MutexGuard<'_, HashMap<K, Entry<V>>> {
        self.entries.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Mark of a value in the making, removed however that ends.
struct Claim<'a, K: Eq + Hash, V> {
    cache: &'a Cache<K, V>,
    key: &'a K,
}

impl<K: Eq + Hash, V> Drop for Claim<'_, K, V> {
    fn drop(&mut self) {
        let mut entries = self.cache.lock();
        if matches!(entries.get(self.key), Some(Entry::Underway)) {
            entries.remove(self.key);
        }
        drop(entries);
        self.cache.changed.notify_all();
    }
}

impl<K: Eq + Hash + Clone, V> Cache<K, V> {
    /// The value of `key`: an existing one, or one that another loader is creating, or otherwise the result of `make`.
    /// `None` if `is_called_off` while waiting.
    pub fn get_or_make<E>(
        &self,
        key: &K,
        is_called_off: impl Fn() -> bool,
        make: impl FnOnce() -> Result<V, E>,
    ) -> Option<Result<Arc<V>, E>> {
        let mut entries = self.lock();
        loop {
            match entries.get(key) {
                Some(Entry::Made(weak)) => match weak.upgrade() {
                    Some(value) => return Some(Ok(value)),
                    None => break,
                },
                Some(Entry::Underway) if is_called_off() => return None,
                Some(Entry::Underway) => {
                    entries =
                        self.changed.wait_timeout(entries, POLL_INTERVAL).unwrap_or_else(PoisonError::into_inner).0;
                }
                None => break,
            }
        }
        entries.retain(|_, entry| !matches!(entry, Entry::Made(weak) if weak.strong_count() == 0));
        entries.insert(key.clone(), Entry::Underway);
        drop(entries);
        let claim = Claim { cache: self, key };
        let made = make().map(Arc::new);
        if let Ok(value) = &made {
            self.lock().insert(key.clone(), Entry::Made(Arc::downgrade(value)));
        }
        drop(claim);
        Some(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    type Made = Option<Result<Arc<u32>, &'static str>>;

    #[test]
    fn shared_while_alive_and_made_again_after() {
        let cache: Cache<&str, u32> = Cache::default();
        let count = AtomicUsize::new(0);
        let get = || -> Made { cache.get_or_make(&"a", || false, || Ok(count.fetch_add(1, Ordering::Relaxed) as u32)) };
        let (first, second) = (get().unwrap().unwrap(), get().unwrap().unwrap());
        assert!(Arc::ptr_eq(&first, &second));
        drop((first, second));
        assert_eq!(*get().unwrap().unwrap(), 1, "nothing is kept alive");
        assert_eq!(cache.lock().len(), 1, "dead entries are cleared");
    }

    #[test]
    fn made_once_for_all_who_ask_at_once() {
        let cache: Cache<u8, u32> = Cache::default();
        let count = AtomicUsize::new(0);
        let all: Vec<Arc<u32>> = std::thread::scope(|scope| {
            let ask = || -> Made {
                cache.get_or_make(
                    &1,
                    || false,
                    || {
                        std::thread::sleep(Duration::from_millis(30));
                        Ok(count.fetch_add(1, Ordering::Relaxed) as u32)
                    },
                )
            };
            let threads: Vec<_> = (0..8).map(|_| scope.spawn(ask)).collect();
            threads.into_iter().map(|thread| thread.join().unwrap().unwrap().unwrap()).collect()
        });
        assert_eq!(count.load(Ordering::Relaxed), 1);
        assert!(all.iter().all(|value| Arc::ptr_eq(value, &all[0])));
    }

    #[test]
    fn a_failure_or_a_panic_lets_the_next_one_try() {
        let cache: Cache<u8, u32> = Cache::default();
        let failed: Made = cache.get_or_make(&1, || false, || Err("no"));
        assert_eq!(failed, Some(Err("no")));
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            let _: Made = cache.get_or_make(&1, || false, || panic!("deliberate"));
        }));
        assert!(panicked.is_err());
        let made: Made = cache.get_or_make(&1, || false, || Ok(5));
        assert_eq!(*made.unwrap().unwrap(), 5);
    }

    #[test]
    fn a_waiting_loader_can_be_called_off() {
        let cache: Cache<u8, u32> = Cache::default();
        cache.lock().insert(1, Entry::Underway);
        let made: Made = cache.get_or_make(&1, || true, || Ok(5));
        assert!(made.is_none());
    }
}
