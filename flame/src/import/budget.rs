//! Memory budget of one file.

use super::error::FormatFault;

/// Bytes that a file of any size may unpack to: room for fields that compress to almost nothing.
pub const BASE_BYTES: u64 = 256 << 20;

/// Further bytes that a file may unpack to per byte of its size. A leaf of vectors takes 6 KiB in memory and at least
/// 129 bytes in a VDB file, so no genuine tree reaches this.
pub const BYTES_PER_FILE_BYTE: u64 = 64;

/// Largest number of bytes that any file may unpack to.
pub const MOST_BYTES: u64 = 32 << 30;

/// Largest number of nodes (branches and leaves) in all trees of a file.
pub const MOST_NODES: u64 = 1 << 22;

/// Largest file that is read, in bytes.
pub const MOST_FILE_BYTES: u64 = 4 << 30;

/// Memory left for one file; charged before anything is allocated.
#[derive(Debug, Clone)]
pub struct Budget {
    bytes: Count,
    nodes: Count,
}

#[derive(Debug, Clone)]
struct Count {
    what: &'static str,
    spent: u64,
    allowed: u64,
}

impl Count {
    fn spend(&mut self, amount: u64) -> Result<(), FormatFault> {
        self.spent = self.spent.saturating_add(amount);
        if self.spent <= self.allowed {
            return Ok(());
        }
        Err(FormatFault::TooLarge { what: self.what, found: self.spent, allowed: self.allowed })
    }
}

impl Budget {
    /// The budget of a file with `file_bytes` bytes.
    pub fn of_file(file_bytes: u64) -> Self {
        let allowed = BASE_BYTES.saturating_add(file_bytes.saturating_mul(BYTES_PER_FILE_BYTE)).min(MOST_BYTES);
        Self {
            bytes: Count { what: "bytes of voxels", spent: 0, allowed },
            nodes: Count { what: "nodes of trees", spent: 0, allowed: MOST_NODES },
        }
    }

    /// Charges memory that is about to be allocated.
    ///
    /// # Errors
    /// [`FormatFault::TooLarge`] if the budget is used up.
    pub fn keep(&mut self, bytes: usize) -> Result<(), FormatFault> {
        self.bytes.spend(bytes as u64)
    }

    /// Charges one node of a tree.
    ///
    /// # Errors
    /// [`FormatFault::TooLarge`] if the budget is used up.
    pub fn node(&mut self) -> Result<(), FormatFault> {
        self.nodes.spend(1)
    }
}

/// Rejects a file larger than the limit.
pub(super) fn check_file_size(found: u64) -> Result<(), FormatFault> {
    if found <= MOST_FILE_BYTES {
        return Ok(());
    }
    Err(FormatFault::TooLarge { what: "bytes of the file", found, allowed: MOST_FILE_BYTES })
}
