//! What a file holds, before its voxels are read.

use std::path::Path;

use super::error::Fault;
use super::{Error, Selection, names};
use crate::grid::Grid;

/// What is known of a grid from its header.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GridInfo {
    /// Its name.
    pub name: String,
    /// The type of its values, as its format names it: `float`, `vec3s`; `<f4 (20, 20, 40)`.
    pub kind: String,
    /// Numbers per voxel where it can be read (1 or 3), else 0.
    pub components: usize,
    /// What it says of itself: `level set`, `fog volume`, `staggered`, `unknown`; empty where it says nothing.
    pub class: String,
    /// Its vectors count voxels, not world units.
    pub in_voxels: bool,
    /// Blender (Mantaflow) wrote it: vectors are in cells per unit of its own time.
    pub is_blender: bool,
    /// The voxel's edges in world units, where they make sense.
    pub voxel_edges: Option<[f64; 3]>,
}

impl GridInfo {
    fn has_class(&self, class: &str) -> bool {
        self.class.trim().eq_ignore_ascii_case(class)
    }

    /// A signed distance, negative inside. Read as a field it is negated, so that it too is larger where it burns; the
    /// front stands at 0.
    pub fn is_level_set(&self) -> bool {
        self.has_class("level set") || (names::is_distance(&self.name) && !self.has_class("fog volume"))
    }

    /// Says that its components stand on the voxels' faces.
    pub fn is_staggered(&self) -> bool {
        self.has_class("staggered")
    }

    /// A quantity with a unit (temperature, fuel), whose value at the front nobody but the user knows.
    pub fn is_unit_dependent(&self) -> bool {
        names::is_unit_dependent(&self.name)
    }
}

/// The grids that answer to a [`Selection`], as indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selected {
    /// The burning field.
    pub field: usize,
    /// The velocity: one grid of vectors three times, or the grids of x, y and z.
    pub velocity: [usize; 3],
}

impl Selected {
    /// Whether the velocity comes as a grid per component.
    pub fn is_split(&self) -> bool {
        self.velocity[0] != self.velocity[1]
    }
}

/// The grids of one frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// The file, fit for messages.
    pub(super) path: String,
    /// In the file's order.
    pub grids: Vec<GridInfo>,
}

impl Description {
    /// The grids that answer to a selection; fails, with a list of those there are, where none does.
    pub fn select(&self, selection: &Selection) -> Result<Selected, Error> {
        names::select(&self.grids, selection).map_err(|fault| Error::File { path: self.path.clone(), fault })
    }

    /// The grid of a selection's field alone; fails as [`select`](Self::select) does.
    pub fn select_field(&self, selection: &Selection) -> Result<usize, Error> {
        names::select_field(&self.grids, selection).map_err(|fault| Error::File { path: self.path.clone(), fault })
    }

    /// The grid that tells where the gas went (density, smoke, temperature), where there is one.
    pub fn carried(&self) -> Option<usize> {
        names::carried(&self.grids)
    }
}

/// A file (or a few files of one frame) whose grids can be read one by one.
pub trait Source {
    /// The grids, in the file's order.
    fn grids(&self) -> &[GridInfo];

    /// Reads a grid of single numbers. Values are as stored: not negated, not checked to be finite.
    fn scalar(&mut self, index: usize) -> Result<Grid<1>, Fault>;

    /// Reads a grid of vectors. Values are as stored: not checked to be finite.
    fn vectors(&mut self, index: usize) -> Result<Grid<3>, Fault>;

    /// When the frame takes place, in seconds, where the file says so.
    fn time_s(&self) -> Option<f64> {
        None
    }

    /// The file a grid is in, where each has its own.
    fn path_of(&self, index: usize) -> Option<&Path> {
        let _ = index;
        None
    }
}

/// Fails where there is no grid `index` of `components` numbers a voxel.
pub(super) fn check_components(grids: &[GridInfo], index: usize, components: usize) -> Result<&GridInfo, Fault> {
    let wanted = || format!("grid {index} of {components} numbers per voxel");
    let fault = || Fault::NoGrid { wanted: wanted(), there: names::listed(grids) };
    grids.get(index).filter(|info| info.components == components).ok_or_else(fault)
}
