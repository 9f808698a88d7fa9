//! The nearest window to a feature (§5.2): an index of our own.
//!
//! Features have some fifty dimensions, but few of them are real. So every window is kept as its
//! first principal coordinates and the length of what they leave out; the distance in these
//! sixteen numbers never exceeds the true one. A tree of bounding boxes, sixteen children wide,
//! leads to blocks of sixteen windows; both are stored dimension-major, so that sixteen bounds are
//! computed at once. Only windows whose bound lies below the best distance found so far are
//! compared in full, in double precision, in the reference's order of arithmetic: rounding in the
//! bounds is allowed for, so the window found is the nearest, ties to the lowest.

mod axes;
mod query;
mod tree;

use std::ops::Range;

pub use query::{Answer, Budget, Searcher};

use super::feature::Features;
use crate::Error;
use axes::Axes;
use tree::Tree;

/// Lanes of a block.
const LANES: usize = 16;
/// Numbers kept per window: principal coordinates, then the length of the rest.
const COORDINATES: usize = 16;
/// One number per lane for each coordinate.
type Block = [[f32; LANES]; COORDINATES];

/// An index over the windows of one level.
#[derive(Debug)]
pub struct Index {
    axes: Axes,
    tree: Tree,
    first_window: usize,
    windows: usize,
}

impl Index {
    /// Indexes `windows`, at least one, of `features`; `progress` is called with parts that add
    /// up to 1 and may call it off.
    pub fn new(
        features: &Features<'_>,
        windows: Range<usize>,
        progress: &dyn Fn(f32) -> Result<(), Error>,
    ) -> Result<Self, Error> {
        let axes = Axes::new(features, windows.clone());
        progress(0.3)?;
        let points = axes.project_all(features, windows.clone());
        progress(0.3)?;
        let same = |a: usize, b: usize| features.equal(windows.start + a, windows.start + b);
        let tree = Tree::new(&points, windows.start, &same);
        progress(0.4)?;
        Ok(Self { axes, tree, first_window: windows.start, windows: windows.len() })
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
