//! A frame from the grids of a file.

use std::path::Path;

use super::error::{Error, FormatFault, shown};
use super::model::{GridInfo, GridSource, PlacementChoice, Selected};
use crate::grid::{Grid, Region, Transform};
use crate::velocity::{Placement, Velocity};

/// Reader of the grids of one frame. Errors name the grid's own file, otherwise `path`.
pub(super) struct Assembly<'a> {
    pub source: &'a mut dyn GridSource,
    pub path: &'a Path,
    /// The part that is read of every grid; all, if not stated.
    pub region: Option<&'a Region>,
}

impl Assembly<'_> {
    /// The burning field; larger in the flame.
    pub fn field(&mut self, index: usize) -> Result<Grid<1>, Error> {
        let grid = self.scalar(index, |grid, _| Ok(grid))?;
        Ok(if self.info(index).is_level_set() { grid.map(|[distance]| [-distance]) } else { grid })
    }

    /// The velocity in world units.
    pub fn velocity(&mut self, selected: &Selected, choice: PlacementChoice) -> Result<Velocity, Error> {
        let placement = match choice {
            PlacementChoice::Collocated => Placement::Collocated,
            PlacementChoice::Staggered => Placement::Staggered,
            PlacementChoice::FromFile => {
                let says_so = selected.velocity.iter().all(|index| self.info(*index).is_staggered());
                if says_so { Placement::Staggered } else { Placement::Collocated }
            }
        };
        let [x, y, z] = selected.velocity;
        if !selected.is_split() {
            return Ok(Velocity::Vectors(self.vectors(x)?, placement));
        }
        let mut component = |axis, index| {
            self.scalar(index, |grid, in_voxels| {
                let grid = if in_voxels { scaled(grid, axis)? } else { grid };
                if placement == Placement::Staggered { on_lower_face(grid, axis) } else { Ok(grid) }
            })
        };
        Ok(Velocity::Components(Box::new([component(0, x)?, component(1, y)?, component(2, z)?])))
    }

    /// A scalar grid, finite after `change`, which receives whether the values count voxels.
    fn scalar(
        &mut self,
        index: usize,
        change: impl FnOnce(Grid<1>, bool) -> Result<Grid<1>, FormatFault>,
    ) -> Result<Grid<1>, Error> {
        let in_voxels = self.info(index).in_voxels;
        let join = if self.info(index).is_level_set() { f32::min } else { |a, b| a + b };
        let region = self.region;
        let grid = self.joined(index, |source, index| source.scalar_within(index, region), join);
        let grid = grid.and_then(|grid| change(grid, in_voxels));
        grid.and_then(|grid| self.finite(index, grid.is_finite()).map(|()| grid)).map_err(self.failure(index))
    }

    fn vectors(&mut self, index: usize) -> Result<Grid<3>, Error> {
        let in_voxels = self.info(index).in_voxels;
        let region = self.region;
        let grid = self.joined(index, |source, index| source.vectors_within(index, region), |a, b| a + b);
        let grid = grid.map(|grid| if in_voxels { to_world(grid) } else { grid });
        grid.and_then(|grid| self.finite(index, grid.is_finite()).map(|()| grid)).map_err(self.failure(index))
    }

    /// A grid together with all others of the same name: simulators write one for each of their objects, and the flame
    /// is all of them. Fields and flows are summed; of distances, the nearer counts.
    fn joined<const N: usize>(
        &mut self,
        index: usize,
        read: impl Fn(&mut dyn GridSource, usize) -> Result<Grid<N>, FormatFault>,
        join: fn(f32, f32) -> f32,
    ) -> Result<Grid<N>, FormatFault> {
        let mut grid = read(self.source, index)?;
        for other in super::names::namesakes(self.source.grids(), index) {
            let found = format!("grids named {} whose voxels do not coincide", shown(&self.info(index).name));
            let advice = "export them as one, or under different names";
            let other = read(self.source, other)?;
            grid = grid.joined(&other, join).ok_or(FormatFault::Unsupported { found, advice })?;
        }
        Ok(grid)
    }

    fn info(&self, index: usize) -> GridInfo {
        self.source.grids().get(index).cloned().unwrap_or_default()
    }

    fn finite(&self, index: usize, is_finite: bool) -> Result<(), FormatFault> {
        if is_finite { Ok(()) } else { Err(FormatFault::NotFinite { grid: shown(&self.info(index).name) }) }
    }

    fn failure(&self, index: usize) -> impl Fn(FormatFault) -> Error + use<> {
        Error::of_file(self.source.path_of(index).unwrap_or(self.path))
    }
}

fn to_world(grid: Grid<3>) -> Grid<3> {
    let transform = *grid.transform();
    grid.map(|voxels| transform.turn(voxels.map(f64::from)).map(|number| number as f32))
}

/// A component in voxels, converted to world units; a single component can be converted only if the axes are the
/// world's.
fn scaled(grid: Grid<1>, axis: usize) -> Result<Grid<1>, FormatFault> {
    let step = grid.transform().turn(unit(axis));
    if (0..3).any(|other| other != axis && step[other] != 0.0) {
        let found = "a velocity in voxels, split into components, on rotated axes".into();
        return Err(FormatFault::Unsupported { found, advice: "export the velocity as one grid of vectors" });
    }
    Ok(grid.map(|[voxels]| [(f64::from(voxels) * step[axis]) as f32]))
}

/// The grid of a component on the voxels' lower faces: moved down by half a voxel.
fn on_lower_face(grid: Grid<1>, axis: usize) -> Result<Grid<1>, FormatFault> {
    let rows = [0, 1, 2].map(|of| grid.transform().turn(unit(of)));
    let half_down = unit(axis).map(|i| -0.5 * i);
    let moved = Transform::new(rows, grid.transform().to_world(half_down))?;
    Ok(grid.with_transform(moved))
}

fn unit(axis: usize) -> [f64; 3] {
    std::array::from_fn(|of| f64::from(u8::from(of == axis)))
}
