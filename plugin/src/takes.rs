//! The takes that were tried, listed in the window and saved in the state.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{SystemTime, UNIX_EPOCH};

/// Maximum number of stored takes; the oldest are dropped.
const MOST: usize = 64;

/// Numbers of takes, in the order in which they were tried.
#[derive(Debug, Default)]
pub struct Takes(Mutex<Vec<u16>>);

impl Takes {
    /// All of them.
    pub fn list(&self) -> Vec<u16> {
        self.lock().clone()
    }

    /// Adds the random number of a take not tried yet, and returns it.
    pub fn add(&self) -> u16 {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |now| now.as_nanos() as u64);
        let mut takes = self.lock();
        let mut bits = now | 1;
        let take = loop {
            // xorshift64 (Marsaglia 2003); more than enough numbers are free.
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            let take = (bits >> 32) as u16;
            if take != 0 && !takes.contains(&take) {
                break take;
            }
        };
        if takes.len() == MOST {
            takes.remove(0);
        }
        takes.push(take);
        take
    }

    /// Forgets one.
    pub fn remove(&self, take: u16) {
        self.lock().retain(|found| *found != take);
    }

    /// The list as stored in a session.
    pub fn to_json(&self) -> String {
        format!("{:?}", self.list())
    }

    /// Restores the list stored in a session; anything else is ignored.
    pub fn read_json(&self, text: &str) {
        if let Ok(mut takes) = serde_json::from_str::<Vec<u16>>(text) {
            takes.truncate(MOST);
            *self.lock() = takes;
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<u16>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_survive_json_and_malformed_json_is_ignored() {
        let takes = Takes::default();
        let added: Vec<u16> = (0..3).map(|_| takes.add()).collect();
        assert!(added.iter().all(|take| *take != 0) && added[0] != added[1] && added[1] != added[2]);
        let other = Takes::default();
        other.read_json(&takes.to_json());
        assert_eq!(other.list(), added);
        for garbage in ["", "null", "{}", "[-1]", "[70000]", "\"x\""] {
            other.read_json(garbage);
            assert_eq!(other.list(), added, "{garbage}");
        }
        other.remove(added[1]);
        assert_eq!(other.list(), [added[0], added[2]]);
        for _ in 0..2 * MOST {
            assert_ne!(other.add(), 0);
        }
        assert_eq!(other.list().len(), MOST);
    }
}
