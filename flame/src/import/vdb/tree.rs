//! The tree of a grid: a root, branches of 32³ and 16³ slots, leaves of 8³ voxels.
//!
//! First comes the topology with the values of the branches, depth first; then, in the same order, the leaves' values.

use std::collections::BTreeSet;

use super::cursor::Cursor;
use super::kind::Number;
use super::values::{FLAGGED_VERSION, ValueLayout, Values, bit, ones};
use crate::grid::{BLOCK_VOXELS, Grid, Part};
use crate::import::budget::Budget;
use crate::import::error::{FormatFault, damaged};

/// Binary logarithms of the slots along an edge of the two kinds of branches, and of the voxels along an edge of a
/// slot.
const BRANCHES: [Branch; 2] = [Branch { log2: 5, slot_log2: 7 }, Branch { log2: 4, slot_log2: 3 }];

/// Binary logarithm of the voxels along an edge of the root's children.
const ROOT_SLOT_LOG2: u32 = 12;

/// Largest number of tiles in the root.
const MOST_ROOT_TILES: usize = 1 << 20;

/// Farthest position of anything below the root, in voxels.
const FARTHEST: i32 = 1 << 24;

const LEAF_MASK_BYTES: usize = BLOCK_VOXELS / 8;

/// Memory of a leaf and of a tile in a grid besides the voxels, generously.
const LEAF_OVERHEAD_BYTES: usize = 128;
const TILE_BYTES: usize = 96;

#[derive(Clone, Copy)]
struct Branch {
    log2: u32,
    slot_log2: u32,
}

impl Branch {
    fn slots(self) -> usize {
        1 << (3 * self.log2)
    }

    fn mask_bytes(self) -> usize {
        self.slots() / 8
    }

    /// The lowest corner of a slot: x slowest, z fastest.
    fn slot_origin(self, origin: [i32; 3], slot: usize) -> [i32; 3] {
        let mask = (1usize << self.log2) - 1;
        let [x, y, z] = [slot >> (2 * self.log2), slot >> self.log2 & mask, slot & mask];
        let [dx, dy, dz] = [x, y, z].map(|step| (step as i32) << self.slot_log2);
        [origin[0].saturating_add(dx), origin[1].saturating_add(dy), origin[2].saturating_add(dz)]
    }
}

/// Receiver of a tree's values.
pub(super) trait Sink {
    /// True if values are needed, false if only the end of the tree is.
    const WANTED: bool;

    fn tile(&mut self, origin: [i32; 3], log2: u32, value: &[f32]);

    /// True if the values of the leaf at `origin` are needed.
    fn wants(&self, origin: [i32; 3]) -> bool;

    /// Receives a leaf's `values`: all voxels, x slowest, z fastest.
    fn leaf(&mut self, origin: [i32; 3], values: &[f32]);
}

/// A sink that discards everything.
pub(super) struct Nothing;

impl Sink for Nothing {
    const WANTED: bool = false;

    fn tile(&mut self, _: [i32; 3], _: u32, _: &[f32]) {}

    fn wants(&self, _: [i32; 3]) -> bool {
        Self::WANTED
    }

    fn leaf(&mut self, _: [i32; 3], _: &[f32]) {}
}

/// A grid, and the part of it that is needed; all, if not stated.
pub(super) struct Wanted<'a, const N: usize> {
    pub grid: Grid<N>,
    pub part: Option<Part<'a>>,
}

impl<const N: usize> Sink for Wanted<'_, N> {
    const WANTED: bool = true;

    fn tile(&mut self, origin: [i32; 3], log2: u32, value: &[f32]) {
        if let Some(value) = value.first_chunk() {
            self.grid.add_tile(origin, log2, *value);
        }
    }

    fn wants(&self, origin: [i32; 3]) -> bool {
        self.part.is_none_or(|part| part.holds(origin.map(|i| i >> 3)))
    }

    fn leaf(&mut self, origin: [i32; 3], values: &[f32]) {
        let block = self.grid.block_mut(origin.map(|i| i >> 3));
        for (voxel, value) in block.iter_mut().zip(values.as_chunks::<N>().0) {
            *voxel = *value;
        }
    }
}

/// A tree whose background has been read, but not its nodes.
pub(super) struct Tree<'a, 'b> {
    cursor: Cursor<'a>,
    layout: ValueLayout,
    background: Vec<f32>,
    values: Values,
    budget: &'b mut Budget,
    /// Leaves in the order of the topology, with their masks.
    leaves: Vec<([i32; 3], &'a [u8])>,
}

impl<'a, 'b> Tree<'a, 'b> {
    /// A tree whose topology starts at `cursor`.
    pub fn open(mut cursor: Cursor<'a>, layout: ValueLayout, budget: &'b mut Budget) -> Result<Self, FormatFault> {
        let buffers = cursor.i32()?;
        if buffers != 1 {
            return damaged(format!("a tree of {buffers} buffers, 1 is expected"));
        }
        let background = Values::single(&mut cursor, layout.kind)?;
        let values = Values::new(layout, background.clone());
        Ok(Self { cursor, layout, background, values, budget, leaves: vec![] })
    }

    /// The background value.
    pub fn background(&self) -> &[f32] {
        &self.background
    }

    /// Reads the tree and returns the offset of its end.
    pub fn read<S: Sink>(mut self, sink: &mut S) -> Result<usize, FormatFault> {
        self.root(sink)?;
        self.leaf_values(sink)?;
        Ok(self.cursor.offset())
    }

    fn root<S: Sink>(&mut self, sink: &mut S) -> Result<(), FormatFault> {
        let (tiles, children) = (self.cursor.u32()? as usize, self.cursor.u32()? as usize);
        if tiles > MOST_ROOT_TILES {
            return Err(FormatFault::TooLarge {
                what: "tiles of a root",
                found: tiles as u64,
                allowed: MOST_ROOT_TILES as u64,
            });
        }
        self.cursor.check_room("root tiles", tiles, 13 + self.layout.kind.bytes())?;
        let mut seen = BTreeSet::new();
        for _ in 0..tiles {
            let origin = self.root_origin(&mut seen)?;
            let value = Values::single(&mut self.cursor, self.layout.kind)?;
            self.cursor.u8()?;
            self.tile(sink, origin, ROOT_SLOT_LOG2, &value)?;
        }
        self.cursor.check_room("root branches", children, 12 + 2 * BRANCHES[0].mask_bytes())?;
        let mut last = None;
        for _ in 0..children {
            let origin = self.root_origin(&mut seen)?;
            if last.replace(origin).is_some_and(|last| last >= origin) {
                return damaged("branches of the root out of order");
            }
            self.branch(sink, &BRANCHES, origin)?;
        }
        Ok(())
    }

    fn root_origin(&mut self, seen: &mut BTreeSet<[i32; 3]>) -> Result<[i32; 3], FormatFault> {
        let origin = self.cursor.position()?;
        let size = 1 << ROOT_SLOT_LOG2;
        if origin.iter().any(|i| i % size != 0 || !(-FARTHEST..=FARTHEST).contains(i)) {
            return damaged(format!("an entry of the root at {origin:?}"));
        }
        if !seen.insert(origin) {
            return damaged(format!("two entries of the root at {origin:?}"));
        }
        Ok(origin)
    }

    /// Reads one branch and everything below it; `levels` are its own level and those below.
    fn branch<S: Sink>(&mut self, sink: &mut S, levels: &[Branch], origin: [i32; 3]) -> Result<(), FormatFault> {
        let Some((branch, below)) = levels.split_first() else { return self.leaf_mask(origin) };
        self.budget.node()?;
        let children = self.cursor.read_bytes(branch.mask_bytes())?;
        let active = self.cursor.read_bytes(branch.mask_bytes())?;
        self.branch_values(sink, *branch, children, active, origin)?;
        let least_bytes = below.first().map_or(LEAF_MASK_BYTES, |branch| 2 * branch.mask_bytes());
        self.cursor.check_room("nodes", ones(children), least_bytes)?;
        for slot in (0..branch.slots()).filter(|slot| bit(children, *slot)) {
            self.branch(sink, below, branch.slot_origin(origin, slot))?;
        }
        Ok(())
    }

    fn branch_values<S: Sink>(
        &mut self,
        sink: &mut S,
        branch: Branch,
        children: &[u8],
        active: &[u8],
        origin: [i32; 3],
    ) -> Result<(), FormatFault> {
        // Older files leave out the slots that have a child.
        let packed = self.layout.version < FLAGGED_VERSION;
        let stored = if packed { branch.slots() - ones(children) } else { branch.slots() };
        if !S::WANTED {
            return self.values.skip(&mut self.cursor, stored, active);
        }
        let mut values = self.values.read(&mut self.cursor, stored, active)?.chunks_exact(self.layout.kind.components);
        for slot in 0..branch.slots() {
            let is_child = bit(children, slot);
            if is_child && packed {
                continue;
            }
            let value = values.next().unwrap_or(&self.background);
            if !is_child && value != self.background {
                self.budget.keep(TILE_BYTES)?;
                sink.tile(branch.slot_origin(origin, slot), branch.slot_log2, value);
            }
        }
        Ok(())
    }

    /// Emits a tile unless it equals the background, which fills the rest anyway.
    fn tile<S: Sink>(&mut self, sink: &mut S, origin: [i32; 3], log2: u32, value: &[f32]) -> Result<(), FormatFault> {
        if S::WANTED && value != self.background {
            self.budget.keep(TILE_BYTES)?;
            sink.tile(origin, log2, value);
        }
        Ok(())
    }

    fn leaf_mask(&mut self, origin: [i32; 3]) -> Result<(), FormatFault> {
        self.budget.node()?;
        let mask = self.cursor.read_bytes(LEAF_MASK_BYTES)?;
        self.leaves.push((origin, mask));
        Ok(())
    }

    fn leaf_values<S: Sink>(&mut self, sink: &mut S) -> Result<(), FormatFault> {
        self.cursor.check_room("leaves", self.leaves.len(), LEAF_MASK_BYTES)?;
        let voxel_bytes = size_of::<f32>() * self.layout.kind.components;
        for (origin, mask) in std::mem::take(&mut self.leaves) {
            if self.cursor.read_bytes(LEAF_MASK_BYTES)? != mask {
                return damaged(format!("two different masks of the leaf at {origin:?}"));
            }
            let is_wanted = sink.wants(origin);
            if is_wanted {
                self.budget.keep(BLOCK_VOXELS * voxel_bytes + LEAF_OVERHEAD_BYTES)?;
            }
            if self.layout.kind.is_bits() {
                self.leaf_bits(sink, origin, is_wanted)?;
                continue;
            }
            if self.layout.version < FLAGGED_VERSION {
                self.leaf_origin(origin)?;
                let buffers = self.cursor.u8()?;
                if buffers != 1 {
                    return damaged(format!("a leaf of {buffers} buffers, 1 is expected"));
                }
            }
            if is_wanted {
                sink.leaf(origin, self.values.read(&mut self.cursor, BLOCK_VOXELS, mask)?);
            } else {
                self.values.skip(&mut self.cursor, BLOCK_VOXELS, mask)?;
            }
        }
        Ok(())
    }

    fn leaf_bits<S: Sink>(&mut self, sink: &mut S, origin: [i32; 3], is_wanted: bool) -> Result<(), FormatFault> {
        self.leaf_origin(origin)?;
        if self.layout.kind.number == Number::Mask {
            return Ok(());
        }
        let bits = self.cursor.read_bytes(LEAF_MASK_BYTES)?;
        let values: [f32; BLOCK_VOXELS] = std::array::from_fn(|voxel| f32::from(u8::from(bit(bits, voxel))));
        if is_wanted {
            sink.leaf(origin, &values);
        }
        Ok(())
    }

    fn leaf_origin(&mut self, expected: [i32; 3]) -> Result<(), FormatFault> {
        let found = self.cursor.position()?;
        if found == expected { Ok(()) } else { damaged(format!("a leaf at {found:?} that should be at {expected:?}")) }
    }
}
