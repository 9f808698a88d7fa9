//! The nearest window to a feature (§5.2): Pyrophone's own index.
//!
//! Features have some fifty dimensions, but few of them matter. Every window is therefore stored as its coordinates
//! along the level's principal axes, as many as its sound needs, and the length of the remainder. The distance in these
//! numbers never exceeds the true one. They are stored as integers of seven bits, in leaves of sixteen neighbouring
//! windows, and a tree of bounding boxes, sixteen children wide, leads to the leaves. Sixteen bounds are computed at
//! once.
//!
//! Windows of different loudness are divided into *shells*, one for every 12 dB of the feature's length, each with its
//! own tree. A noise floor far below the rest is thus coded in its own steps and along as many axes as it needs,
//! although it contributes nothing to the recording's variance. No window is nearer than the difference of the two
//! lengths, so most shells are skipped.
//!
//! Only windows whose bound is below the best distance so far are compared in full, first in the fastest order of
//! arithmetic. If that is inconclusive, they are compared in the reference's order, without fused operations. All
//! bounds allow for rounding, so the result is the nearest window, with ties going to the lowest, on every machine.

mod axes;
mod block;
mod coded;
mod codes;
mod frontier;
mod lanes;
mod query;
mod shells;
mod sizes;
mod tree;

use bitcode::{Decode, Encode};
use std::ops::Range;

pub use query::{Budget, COMPARISON_COST, SearchResult, Searcher};
pub use tree::Step;

use super::feature::Features;
use crate::Error;
use crate::bulk::bulk_fields;
use axes::Axes;
use shells::Shell;
use sizes::AXES_MAX;
use tree::{Points, Tree};

/// An index over the windows of one level.
#[derive(Debug, Encode, Decode)]
pub struct Index {
    axes: Axes,
    /// The loudest first; none is empty.
    shells: Vec<Shell>,
    first_window: usize,
    windows: usize,
}

bulk_fields!(Index: shells);

impl Index {
    /// Indexes `windows`, at least one, of `features`.
    pub fn new(features: &Features<'_>, windows: Range<usize>, step: Step<'_>) -> Result<Self, Error> {
        let mut axes = Axes::new(features, windows.clone());
        step(0.2)?;
        let (first_window, count) = (windows.start, windows.len());
        let parts = shells::divide(features, windows);
        step(0.1)?;
        let numbers: Vec<usize> = parts.iter().map(|part| axes.needed(features, &part.windows)).collect();
        axes.keep(numbers.iter().copied().max().unwrap_or(AXES_MAX));
        let total: usize = parts.iter().map(|part| part.windows.len()).sum();
        let mut shells = Vec::with_capacity(parts.len());
        for (part, numbers) in parts.into_iter().zip(numbers) {
            let share = part.windows.len() as f32 / total as f32;
            let points = Points { axes: &axes, features, windows: &part.windows, numbers };
            let done = |done: f32| step(0.7 * share * done);
            let (tree, radius) = Tree::new(&points, &done)?;
            shells.push(Shell { least: part.least, most: part.most, radius, axes: numbers, tree });
        }
        Ok(Self { axes, shells, first_window, windows: count })
    }

    /// The windows in it.
    pub fn windows(&self) -> Range<usize> {
        self.first_window..self.first_window + self.windows
    }

    /// Approximate number of bytes held.
    pub fn bytes(&self) -> usize {
        self.shells.iter().map(|shell| shell.tree.bytes()).sum()
    }
}
