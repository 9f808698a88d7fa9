//! The nearest window to a feature (§5.2): an index of our own.
//!
//! Features have some fifty dimensions, but few of them are real. So every window is kept as its
//! coordinates along the level's principal axes, as many as its sound needs, and the length of what
//! they leave out; the distance in these numbers never exceeds the true one. They are stored as
//! bytes, in blocks of sixteen windows that lie near each other, and a tree of bounding boxes,
//! sixteen children wide, leads to the blocks. Sixteen bounds are computed at once.
//!
//! Only windows whose bound lies below the best distance found so far are looked at in full: first
//! in whatever order of arithmetic is fastest, and if that cannot tell, in double precision in the
//! reference's order, without fused operations. Rounding is allowed for in all bounds, so the window
//! found is the nearest, ties to the lowest, on every machine.

mod aside;
mod axes;
mod block;
mod lanes;
mod query;
mod tree;

use bitcode::{Decode, Encode};
use std::ops::Range;

pub use query::{Answer, Budget, COMPARISON_COST, Searcher};

use super::feature::Features;
use crate::Error;
use crate::bulk::bulk_fields;
use axes::Axes;
use tree::Tree;

/// Windows of a leaf, and children of a node.
const LANES: usize = 16;
/// Most numbers kept per window.
const AXES_MAX: usize = 32;

/// Told parts done that add up to 1; may call it off.
pub type Step<'a> = &'a (dyn Fn(f32) -> Result<(), Error> + Sync);

/// An index over the windows of one level.
#[derive(Debug, Encode, Decode)]
pub struct Index {
    axes: Axes,
    tree: Tree,
    /// Largest distance of a window from the mean.
    radius: f32,
    first_window: usize,
    windows: usize,
}

bulk_fields!(Index: tree);

impl Index {
    /// Indexes `windows`, at least one, of `features`.
    pub fn new(features: &Features<'_>, windows: Range<usize>, step: Step<'_>) -> Result<Self, Error> {
        let axes = Axes::new(features, windows.clone());
        step(0.2)?;
        let points = axes.project_all(features, windows.clone());
        step(0.3)?;
        // A recording may hold minutes of digital silence: of equal windows in a row the first,
        // which wins ties, stands for all.
        let repeats = |i: u32| i > 0 && features.equal(windows.start + i as usize - 1, windows.start + i as usize);
        let mut order: Vec<u32> = (0..windows.len() as u32).filter(|i| !repeats(*i)).collect();
        let part = |done: f32| step(0.5 * done);
        let tree = Tree::new(&points.coordinates, axes.count(), &mut order, windows.start, &part)?;
        Ok(Self { axes, tree, radius: points.radius, first_window: windows.start, windows: windows.len() })
    }

    /// The windows it holds.
    pub fn windows(&self) -> Range<usize> {
        self.first_window..self.first_window + self.windows
    }

    /// Bytes held, about.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
    }
}
