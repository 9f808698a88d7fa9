//! The types that all readers of simulations share. Readers know these and nothing of one another.

use std::path::Path;

use super::error::{FormatFault, shown};
use super::vocabulary;
use crate::grid::{Grid, Region};

/// Largest number of grids listed in a message.
const MOST_LISTED: usize = 24;

/// Assumed position of the velocity's components in their voxels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PlacementChoice {
    /// At the centre, regardless of the file.
    #[default]
    Collocated,
    /// On the lower faces, regardless of the file.
    Staggered,
    /// On the lower faces if the file calls the grid staggered, otherwise at the centre.
    FromFile,
}

/// Names of the grids to read from a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Selection {
    /// Burning field. `flame` matches any of the usual names; another name matches only itself.
    pub field: String,
    /// Velocity, one grid or three. `velocity` matches any of the usual names; another name matches only itself.
    pub velocity: String,
    /// Position of its components.
    pub placement: PlacementChoice,
    /// Factor that converts the file's numbers to world units per second.
    pub velocity_scale: f64,
}

impl Default for Selection {
    fn default() -> Self {
        Self {
            field: "flame".into(),
            velocity: "velocity".into(),
            placement: PlacementChoice::default(),
            velocity_scale: 1.0,
        }
    }
}

/// A grid's description, from its header.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GridInfo {
    /// Its name.
    pub name: String,
    /// The type of its values, as its format names it: `float`, `vec3s`; `<f4 (20, 20, 40)`.
    pub kind: String,
    /// Numbers per voxel if the grid can be read (1 or 3), otherwise 0.
    pub components: usize,
    /// Its declared class: `level set`, `fog volume`, `staggered`, `unknown`; empty if undeclared.
    pub class: String,
    /// True if its vectors count voxels instead of world units.
    pub in_voxels: bool,
    /// True if Blender (Mantaflow) wrote it: vectors are then in cells per unit of Blender's time.
    pub is_blender: bool,
    /// Voxel edges in world units, if they make sense.
    pub voxel_edges: Option<[f64; 3]>,
}

impl GridInfo {
    fn has_class(&self, class: &str) -> bool {
        self.class.trim().eq_ignore_ascii_case(class)
    }

    /// True for a signed distance, negative inside. Read as a field it is negated, so that it too is larger in the
    /// flame; the front is at 0.
    pub fn is_level_set(&self) -> bool {
        self.has_class("level set") || (vocabulary::is_distance(&self.name) && !self.has_class("fog volume"))
    }

    /// True if its components are on the voxels' faces.
    pub fn is_staggered(&self) -> bool {
        self.has_class("staggered")
    }

    /// True for a quantity with a unit (temperature, fuel), whose value at the front only the user knows.
    pub fn is_unit_dependent(&self) -> bool {
        vocabulary::is_unit_dependent(&self.name)
    }
}

/// The grids that match a [`Selection`], as indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Selected {
    /// The burning field.
    pub field: usize,
    /// Velocity: one grid of vectors three times, or the grids of x, y and z.
    pub velocity: [usize; 3],
}

impl Selected {
    /// True if each component of the velocity has its own grid.
    pub fn is_split(&self) -> bool {
        self.velocity[0] != self.velocity[1]
    }
}

/// A file (or a few files of one frame) whose grids can be read one by one.
pub trait GridSource {
    /// The grids, in the file's order.
    fn grids(&self) -> &[GridInfo];

    /// Reads a grid of single numbers, or those of its blocks that a region depends on; the others are then missing. Values
    /// are as stored: not negated, not checked to be finite.
    ///
    /// # Errors
    /// If there is no such grid, or its file is damaged where it is read.
    fn scalar_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<1>, FormatFault>;

    /// Reads a grid of vectors, or those of its blocks that a region depends on. Values are as stored: not checked to be
    /// finite.
    ///
    /// # Errors
    /// As [`scalar_within`](Self::scalar_within).
    fn vectors_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<3>, FormatFault>;

    /// Reads a whole grid of single numbers.
    ///
    /// # Errors
    /// As [`scalar_within`](Self::scalar_within).
    fn scalar(&mut self, index: usize) -> Result<Grid<1>, FormatFault> {
        self.scalar_within(index, None)
    }

    /// Reads a whole grid of vectors.
    ///
    /// # Errors
    /// As [`scalar_within`](Self::scalar_within).
    fn vectors(&mut self, index: usize) -> Result<Grid<3>, FormatFault> {
        self.vectors_within(index, None)
    }

    /// Time of the frame in seconds, if the file states it.
    fn time_s(&self) -> Option<f64> {
        None
    }

    /// File of a grid, if each grid has its own.
    fn path_of(&self, index: usize) -> Option<&Path> {
        let _ = index;
        None
    }
}

/// Fails unless there is a grid `index` with `components` numbers per voxel.
pub(super) fn check_components(grids: &[GridInfo], index: usize, components: usize) -> Result<&GridInfo, FormatFault> {
    let wanted = || format!("grid {index} of {components} numbers per voxel");
    let fault = || FormatFault::NoGrid { wanted: wanted(), there: listed(grids) };
    grids.get(index).filter(|info| info.components == components).ok_or_else(fault)
}

/// Names and types, for a message.
pub(super) fn listed(grids: &[GridInfo]) -> String {
    if grids.is_empty() {
        return "no grids".into();
    }
    let named = |grid: &GridInfo| format!("{} ({})", shown(&grid.name), shown(&grid.kind));
    let first: Vec<String> = grids.iter().take(MOST_LISTED).map(named).collect();
    match grids.len().saturating_sub(MOST_LISTED) {
        0 => first.join(", "),
        more => format!("{} and {more} more", first.join(", ")),
    }
}
