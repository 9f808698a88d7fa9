//! Velocity of the flow at any position.

use crate::grid::{BLOCK, Grid, Transform, slot};

/// Position of a velocity's components in a voxel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Placement {
    /// All components at its centre.
    #[default]
    Collocated,
    /// Component a at the centre of the voxel's lower face across axis a (a MAC grid).
    Staggered,
}

/// A velocity field: one grid of vectors, or a grid for each component.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a frame has one, and none is ever moved about in bulk")]
pub enum Velocity {
    /// One grid of vectors along the world's axes.
    Vectors(Grid<3>, Placement),
    /// One grid per component, each with its own transform.
    Components(Box<[Grid<1>; 3]>),
}

impl Velocity {
    /// Velocity at a world position, trilinear between the samples (Chadwick & James 2011, §3); zero, or the field's
    /// background, where nothing is stored.
    pub fn velocity_at(&self, world: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Vectors(grid, Placement::Collocated) => trilinear(grid, grid.transform().to_index(world)),
            Self::Vectors(grid, Placement::Staggered) => {
                let index = grid.transform().to_index(world);
                std::array::from_fn(|axis| {
                    let mut shifted = index;
                    shifted[axis] += 0.5;
                    trilinear(grid, shifted)[axis]
                })
            }
            Self::Components(grids) => {
                std::array::from_fn(|axis| trilinear(&grids[axis], grids[axis].transform().to_index(world))[0])
            }
        }
    }

    /// Lowest and highest world positions of samples that differ from the background; none if there are no such
    /// samples.
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        fn of<const N: usize>(grid: &Grid<N>) -> Option<[[f64; 3]; 2]> {
            let (low, high) = grid.bounds()?;
            let corner = |corner: usize| {
                let index = std::array::from_fn(|axis| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] });
                grid.transform().to_world(index.map(f64::from))
            };
            (0..8).map(|which| [corner(which); 2]).reduce(join)
        }
        match self {
            Self::Vectors(grid, _) => of(grid),
            Self::Components(grids) => grids.iter().filter_map(of).reduce(join),
        }
    }

    /// True if every value is finite.
    pub fn is_finite(&self) -> bool {
        match self {
            Self::Vectors(grid, _) => grid.is_finite(),
            Self::Components(grids) => grids.iter().all(Grid::is_finite),
        }
    }

    /// The flow with every speed multiplied.
    pub fn scaled(self, factor: f64) -> Self {
        fn of<const N: usize>(grid: Grid<N>, factor: f64) -> Grid<N> {
            grid.map(|speed| speed.map(|speed| (f64::from(speed) * factor) as f32))
        }
        match self {
            Self::Vectors(grid, placement) => Self::Vectors(of(grid, factor), placement),
            Self::Components(grids) => Self::Components(Box::new(grids.map(|grid| of(grid, factor)))),
        }
    }

    /// The transform of the field, or of its first component.
    pub fn transform(&self) -> &Transform {
        match self {
            Self::Vectors(grid, _) => grid.transform(),
            Self::Components(grids) => grids[0].transform(),
        }
    }
}

/// The bounding box of two boxes, each given by its lowest and highest corner.
pub fn join(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [std::array::from_fn(|axis| a[0][axis].min(b[0][axis])), std::array::from_fn(|axis| a[1][axis].max(b[1][axis]))]
}

/// Velocity at many positions near each other, given as indices of another grid: the samples around a position are kept
/// for the next.
pub(crate) enum Probe<'a> {
    Collocated(Box<Cells<'a, 3>>),
    Staggered(Box<[Cells<'a, 3>; 3]>),
    Components(Box<[Cells<'a, 1>; 3]>),
}

impl<'a> Probe<'a> {
    /// A probe for positions given as indices of a grid with transform `from`.
    pub fn new(velocity: &'a Velocity, from: &Transform) -> Self {
        match velocity {
            Velocity::Vectors(grid, Placement::Collocated) => {
                Self::Collocated(Box::new(Cells::new(grid, from, [0.0; 3])))
            }
            Velocity::Vectors(grid, Placement::Staggered) => {
                let shift = |axis: usize| std::array::from_fn(|of| if of == axis { 0.5 } else { 0.0 });
                Self::Staggered(Box::new([0, 1, 2].map(|axis| Cells::new(grid, from, shift(axis)))))
            }
            Velocity::Components(grids) => {
                Self::Components(Box::new([0, 1, 2].map(|axis| Cells::new(&grids[axis], from, [0.0; 3]))))
            }
        }
    }

    /// As [`Velocity::at`].
    pub fn velocity_at(&mut self, index: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Collocated(cells) => cells.values_at(index),
            Self::Staggered(cells) => std::array::from_fn(|axis| cells[axis].component_at(index, axis)),
            Self::Components(cells) => std::array::from_fn(|axis| cells[axis].component_at(index, 0)),
        }
    }
}

/// A grid, and the samples around the most recent positions.
pub(crate) struct Cells<'a, const N: usize> {
    grid: &'a Grid<N>,
    rows: [[f64; 3]; 3],
    translation: [f64; 3],
    /// The most recent cells; two neighbouring cells along any axis are both kept.
    kept: [Cell<N>; 8],
}

/// The samples at the corners of a cell; corner 4x + 2y + z.
#[derive(Clone, Copy)]
struct Cell<const N: usize> {
    base: Option<[i32; 3]>,
    values: [[f64; 8]; N],
}

impl<'a, const N: usize> Cells<'a, N> {
    fn new(grid: &'a Grid<N>, from: &Transform, shift: [f64; 3]) -> Self {
        let (rows, translation) = from.index_map(grid.transform());
        let translation = std::array::from_fn(|axis| translation[axis] + shift[axis]);
        Self { grid, rows, translation, kept: [Cell { base: None, values: [[0.0; 8]; N] }; 8] }
    }

    fn values_at(&mut self, index: [f64; 3]) -> [f64; N] {
        match self.cell(index) {
            Some((values, fraction)) => values.map(|values| mix(&values, fraction)),
            None => self.grid.background().map(f64::from),
        }
    }

    fn component_at(&mut self, index: [f64; 3], component: usize) -> f64 {
        match self.cell(index) {
            Some((values, fraction)) => mix(&values[component], fraction),
            None => f64::from(self.grid.background()[component]),
        }
    }

    /// The cell that contains a position, and the position within it; none beyond all indices.
    fn cell(&mut self, place: [f64; 3]) -> Option<(&[[f64; 8]; N], [f64; 3])> {
        let index: [f64; 3] = std::array::from_fn(|axis| {
            (0..3).map(|of| place[of] * self.rows[of][axis]).sum::<f64>() + self.translation[axis]
        });
        if !is_indexable(index) {
            return None;
        }
        let floor = index.map(f64::floor);
        let base = floor.map(|i| i as i32);
        let cell = &mut self.kept[base.iter().fold(0, |number, i| number << 1 | (i & 1) as usize)];
        if cell.base != Some(base) {
            *cell = Cell { base: Some(base), values: corners(self.grid, base) };
        }
        Some((&cell.values, std::array::from_fn(|axis| index[axis] - floor[axis])))
    }
}

/// True if an index fits its type; beyond, no grid has values.
fn is_indexable(index: [f64; 3]) -> bool {
    index.iter().all(|i| i.abs() < f64::from(1 << 30))
}

/// The samples at the corners of the cell at `base`.
fn corners<const N: usize>(grid: &Grid<N>, base: [i32; 3]) -> [[f64; 8]; N] {
    // Usually all eight voxels lie in one block, which is then looked up only once.
    let is_inner = base.iter().all(|i| i & (BLOCK - 1) != BLOCK - 1);
    let block = if is_inner { grid.block(base.map(|i| i.div_euclid(BLOCK))) } else { None };
    if is_inner && block.is_none() {
        return grid.outside_blocks(base).map(|value| [f64::from(value); 8]);
    }
    let mut values = [[0.0; 8]; N];
    for corner in 0..8 {
        let index = std::array::from_fn(|axis| base[axis] + (corner >> (2 - axis) & 1));
        let value = match block {
            Some(block) => block[slot(index)],
            None => grid.value(index),
        };
        for (values, value) in values.iter_mut().zip(value) {
            values[corner as usize] = f64::from(value);
        }
    }
    values
}

/// Trilinear interpolation between a cell's corners.
fn mix(corners: &[f64; 8], [x, y, z]: [f64; 3]) -> f64 {
    let lines: [f64; 4] = std::array::from_fn(|n| corners[2 * n] * (1.0 - z) + corners[2 * n + 1] * z);
    let planes = [lines[0] * (1.0 - y) + lines[1] * y, lines[2] * (1.0 - y) + lines[3] * y];
    planes[0] * (1.0 - x) + planes[1] * x
}

/// Trilinear interpolation at a fractional index.
pub(crate) fn trilinear<const N: usize>(grid: &Grid<N>, index: [f64; 3]) -> [f64; N] {
    if !is_indexable(index) {
        return grid.background().map(f64::from);
    }
    let floor = index.map(f64::floor);
    let fraction = std::array::from_fn(|axis| index[axis] - floor[axis]);
    corners(grid, floor.map(|i| i as i32)).map(|corners| mix(&corners, fraction))
}
