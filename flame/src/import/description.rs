//! Contents of a file, before its voxels are read.

use super::error::Error;
use super::model::{GridInfo, Selected, Selection};
use super::names;

/// The grids of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Path of the file, fit for messages.
    pub(super) path: String,
    /// The grids in the file's order.
    pub grids: Vec<GridInfo>,
}

impl Description {
    /// The grids that match a selection.
    ///
    /// # Errors
    /// [`Error::File`], listing the grids that exist, if none matches.
    pub fn select(&self, selection: &Selection) -> Result<Selected, Error> {
        names::select(&self.grids, selection).map_err(|fault| Error::File { path: self.path.clone(), fault })
    }

    /// The grid of a selection's field only.
    ///
    /// # Errors
    /// As [`select`](Self::select).
    pub fn select_field(&self, selection: &Selection) -> Result<usize, Error> {
        names::select_field(&self.grids, selection).map_err(|fault| Error::File { path: self.path.clone(), fault })
    }

    /// The grid that shows the gas's motion (density, smoke, temperature), if there is one.
    pub fn carried(&self) -> Option<usize> {
        names::carried(&self.grids)
    }
}
