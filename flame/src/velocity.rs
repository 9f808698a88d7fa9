//! The flow's velocity at any place.

use crate::grid::{BLOCK, Grid, Transform, slot};

/// Where in a voxel the components of a velocity stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Placement {
    /// All at its centre.
    #[default]
    Collocated,
    /// Component a on the middle of the voxel's lower face across axis a (a MAC grid).
    Staggered,
}

/// A velocity field: one grid of vectors, or a grid for each component.
#[derive(Debug, Clone)]
#[expect(clippy::large_enum_variant, reason = "a frame has one, and none is ever moved about in bulk")]
pub enum Velocity {
    /// One grid of vectors along the world's axes.
    Vectors(Grid<3>, Placement),
    /// A grid per component, each with a transform of its own.
    Components(Box<[Grid<1>; 3]>),
}

impl Velocity {
    /// The velocity at a place in the world, trilinear between the samples (Chadwick & James 2011, §3); zero, or the
    /// field's background, where nothing is stored.
    pub fn at(&self, world: [f64; 3]) -> [f64; 3] {
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

    /// Lowest and highest place in the world of a sample that differs from the background; none where none does.
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

    /// Whether every value is finite.
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

/// The box around two boxes, each by its lowest and highest corner.
pub fn join(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    [std::array::from_fn(|axis| a[0][axis].min(b[0][axis])), std::array::from_fn(|axis| a[1][axis].max(b[1][axis]))]
}

/// Trilinear interpolation at a fractional index.
pub(crate) fn trilinear<const N: usize>(grid: &Grid<N>, index: [f64; 3]) -> [f64; N] {
    // Beyond this no grid has values, and an index would not fit its type.
    if !index.iter().all(|i| i.abs() < f64::from(1 << 30)) {
        return grid.background().map(f64::from);
    }
    let base = index.map(|i| i.floor() as i32);
    let fraction: [f64; 3] = std::array::from_fn(|axis| index[axis] - f64::from(base[axis]));
    // Mostly all eight voxels lie in one block, which then is looked up only once.
    let is_inner = base.iter().all(|i| i & (BLOCK - 1) != BLOCK - 1);
    let block = if is_inner { grid.block(base.map(|i| i.div_euclid(BLOCK))) } else { None };
    if is_inner && block.is_none() {
        return grid.outside_blocks(base).map(f64::from);
    }
    let mut sum = [0.0; N];
    for corner in 0..8i32 {
        let offset = [corner >> 2, (corner >> 1) & 1, corner & 1];
        let weight: f64 =
            (0..3).map(|axis| if offset[axis] == 1 { fraction[axis] } else { 1.0 - fraction[axis] }).product();
        if weight == 0.0 {
            continue;
        }
        let index = std::array::from_fn(|axis| base[axis] + offset[axis]);
        let value = match block {
            Some(block) => block[slot(index)],
            None => grid.value(index),
        };
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += weight * f64::from(value);
        }
    }
    sum
}
