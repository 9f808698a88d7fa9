//! Memory budget of one file.

use super::error::FormatFault;

/// Bytes a file may unfold to whatever its size: room for fields that compress to almost nothing.
pub const BASE_BYTES: u64 = 256 << 20;

/// Bytes a file may unfold to for each of its own. A leaf of vectors takes 6 KiB in memory and at least 129 bytes in
/// a VDB file, so that no honest tree reaches this.
pub const BYTES_PER_FILE_BYTE: u64 = 64;

/// Bytes a file may unfold to at most.
pub const MOST_BYTES: u64 = 32 << 30;

/// Nodes (branches and leaves) of all trees of a file.
pub const MOST_NODES: u64 = 1 << 22;

/// Bytes of a file that is read.
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
    /// For a file of so many bytes.
    pub fn of_file(file_bytes: u64) -> Self {
        let allowed = BASE_BYTES.saturating_add(file_bytes.saturating_mul(BYTES_PER_FILE_BYTE)).min(MOST_BYTES);
        Self {
            bytes: Count { what: "bytes of voxels", spent: 0, allowed },
            nodes: Count { what: "nodes of trees", spent: 0, allowed: MOST_NODES },
        }
    }

    /// Takes memory that is about to be allocated.
    ///
    /// # Errors
    /// [`FormatFault::TooLarge`] where the budget is used up.
    pub fn keep(&mut self, bytes: usize) -> Result<(), FormatFault> {
        self.bytes.spend(bytes as u64)
    }

    /// Takes one node of a tree.
    ///
    /// # Errors
    /// [`FormatFault::TooLarge`] where the budget is used up.
    pub fn node(&mut self) -> Result<(), FormatFault> {
        self.nodes.spend(1)
    }
}

/// Fails where a file is larger than any that is read.
pub(super) fn check_file_size(found: u64) -> Result<(), FormatFault> {
    if found <= MOST_FILE_BYTES {
        return Ok(());
    }
    Err(FormatFault::TooLarge { what: "bytes of the file", found, allowed: MOST_FILE_BYTES })
}
