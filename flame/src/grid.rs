//! Sampled fields: sparse blocks of voxels, as provided by simulation caches and the solver.

mod around;
mod join;
mod region;

pub(crate) use around::neighbour_key;
pub use region::{Part, Region};

use std::collections::BTreeMap;

use crate::error::Error;

/// Voxels along an edge of a block: as many as in a leaf of OpenVDB, so that leaves are copied whole.
pub const BLOCK: i32 = 8;

/// Voxels of a block.
pub const BLOCK_VOXELS: usize = (BLOCK * BLOCK * BLOCK) as usize;

/// Smallest and largest sensible voxel edge, in world units.
const VOXEL_SIZE: std::ops::RangeInclusive<f64> = 1e-9..=1e9;

/// Mapping of a grid's indices to the world: `world = index * matrix + translation`, with row vectors. An integer index
/// is the *centre* of a voxel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Row a: the world displacement of one voxel along axis a.
    rows: [[f64; 3]; 3],
    inverse: [[f64; 3]; 3],
    translation: [f64; 3],
}

impl Transform {
    /// The transform with this matrix, row by row, and this translation.
    ///
    /// # Errors
    /// [`Error::Transform`] if the matrix cannot be inverted or a voxel's edges are not between 1e-9 and 1e9.
    pub fn new(rows: [[f64; 3]; 3], translation: [f64; 3]) -> Result<Self, Error> {
        let finite = rows.iter().flatten().chain(&translation).all(|value| value.is_finite());
        let sane = rows.iter().all(|row| VOXEL_SIZE.contains(&length(*row)));
        if !finite || !sane {
            return Err(Error::Transform { rows, translation });
        }
        let volume = dot(rows[0], cross(rows[1], rows[2]));
        let edges: f64 = rows.iter().map(|row| length(*row)).product();
        // Edges that lie almost in one plane: an inverse would be nothing but rounding errors.
        if volume.abs() < 1e-9 * edges {
            return Err(Error::Transform { rows, translation });
        }
        let columns = [cross(rows[1], rows[2]), cross(rows[2], rows[0]), cross(rows[0], rows[1])];
        let inverse = std::array::from_fn(|axis| std::array::from_fn(|of| columns[of][axis] / volume));
        Ok(Self { rows, inverse, translation })
    }

    /// The identity: indices are world positions.
    pub const fn identity() -> Self {
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        Self { rows: unit, inverse: unit, translation: [0.0; 3] }
    }

    /// Voxels of edge `voxel_size`, with index 0 at `origin`.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn uniform(voxel_size: f64, origin: [f64; 3]) -> Result<Self, Error> {
        Self::new([[voxel_size, 0.0, 0.0], [0.0, voxel_size, 0.0], [0.0, 0.0, voxel_size]], origin)
    }

    /// World position of an index.
    pub fn to_world(&self, index: [f64; 3]) -> [f64; 3] {
        let turned = self.turn(index);
        std::array::from_fn(|axis| turned[axis] + self.translation[axis])
    }

    /// The index of a world position.
    pub fn to_index(&self, world: [f64; 3]) -> [f64; 3] {
        let from: [f64; 3] = std::array::from_fn(|axis| world[axis] - self.translation[axis]);
        std::array::from_fn(|axis| (0..3).map(|of| from[of] * self.inverse[of][axis]).sum())
    }

    /// A difference of indices as a difference in the world.
    pub fn turn(&self, step: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| (0..3).map(|of| step[of] * self.rows[of][axis]).sum())
    }

    /// The matrix that converts an area vector from index space to the world: the cofactors of the rows.
    pub(crate) fn cofactors(&self) -> [[f64; 3]; 3] {
        let [x, y, z] = self.rows;
        [cross(y, z), cross(z, x), cross(x, y)]
    }

    /// From an index of `self` to one of `other`: `index * matrix + translation`.
    pub(crate) fn index_map(&self, other: &Self) -> ([[f64; 3]; 3], [f64; 3]) {
        let onto = |step: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|axis| (0..3).map(|of| step[of] * other.inverse[of][axis]).sum())
        };
        (self.rows.map(onto), other.to_index(self.translation))
    }

    /// Converts a gradient per index to one per world unit.
    pub fn gradient_to_world(&self, gradient: [f64; 3]) -> [f64; 3] {
        self.inverse.map(|row| dot(row, gradient))
    }

    /// True if the grid's axes have the opposite handedness to the world's.
    pub fn is_mirrored(&self) -> bool {
        dot(self.rows[0], cross(self.rows[1], self.rows[2])) < 0.0
    }

    /// The voxel's edges in world units.
    pub fn voxel_edges(&self) -> [f64; 3] {
        self.rows.map(length)
    }
}

/// A field of `N` numbers per voxel, `f32`, in blocks of 8×8×8; outside all blocks and tiles it is background.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid<const N: usize> {
    blocks: BTreeMap<[i32; 3], Box<[[f32; N]; BLOCK_VOXELS]>>,
    /// Cubes of one value, 2^`log2` voxels along an edge.
    tiles: BTreeMap<(u32, [i32; 3]), [f32; N]>,
    /// The sizes that occur among the tiles.
    tile_sizes: Vec<u32>,
    background: [f32; N],
    transform: Transform,
}

impl<const N: usize> Grid<N> {
    /// A field that is `background` everywhere.
    pub fn new(background: [f32; N], transform: Transform) -> Self {
        Self { blocks: BTreeMap::new(), tiles: BTreeMap::new(), tile_sizes: vec![], background, transform }
    }

    /// A field from an array of `shape` (x, y, z; z fastest) whose first value is at index (0, 0, 0); zero outside.
    ///
    /// # Errors
    /// If the array's length is not the product of its shape.
    pub fn dense(shape: [usize; 3], values: &[[f32; N]], transform: Transform) -> Result<Self, Error> {
        let expected = shape.iter().try_fold(1usize, |product, size| product.checked_mul(*size));
        if expected != Some(values.len()) || shape.iter().any(|size| *size > 1 << 20) {
            return Err(Error::Shape { shape, found: values.len() });
        }
        let mut grid = Self::new([0.0; N], transform);
        for (row, line) in values.chunks_exact(shape[2].max(1)).enumerate() {
            let (x, y) = ((row / shape[1].max(1)) as i32, (row % shape[1].max(1)) as i32);
            for (part, run) in line.chunks(BLOCK as usize).enumerate() {
                let block = grid.block_mut([x >> 3, y >> 3, part as i32]);
                let start = slot([x, y, 0]);
                block[start..start + run.len()].copy_from_slice(run);
            }
        }
        Ok(grid)
    }

    /// The block at `key` (index / 8), created from background if there is none yet.
    pub fn block_mut(&mut self, key: [i32; 3]) -> &mut [[f32; N]; BLOCK_VOXELS] {
        let background = self.background;
        self.blocks.entry(key).or_insert_with(|| filled(background))
    }

    /// Puts a block at `key` (index / 8), replacing what was there.
    pub fn insert_block(&mut self, key: [i32; 3], block: Box<[[f32; N]; BLOCK_VOXELS]>) {
        self.blocks.insert(key, block);
    }

    /// The field with every value changed, including the background.
    pub fn map(mut self, change: impl Fn([f32; N]) -> [f32; N]) -> Self {
        let voxels = self.blocks.values_mut().flat_map(|block| block.iter_mut());
        for value in voxels.chain(self.tiles.values_mut()).chain([&mut self.background]) {
            *value = change(*value);
        }
        self
    }

    /// Adds a cube of one value, 2^`log2` voxels (at least a block) along an edge, at a multiple of its size.
    pub fn add_tile(&mut self, origin: [i32; 3], log2: u32, value: [f32; N]) {
        self.tiles.insert((log2, origin), value);
        if !self.tile_sizes.contains(&log2) {
            self.tile_sizes.push(log2);
            self.tile_sizes.sort_unstable();
        }
    }

    /// The value at an index.
    pub fn value(&self, index: [i32; 3]) -> [f32; N] {
        match self.blocks.get(&index.map(|i| i >> 3)) {
            Some(block) => block[slot(index)],
            None => self.outside_blocks(index),
        }
    }

    /// The block at `key` (index / 8), slots as [`slot`] numbers them.
    pub fn block(&self, key: [i32; 3]) -> Option<&[[f32; N]; BLOCK_VOXELS]> {
        self.blocks.get(&key).map(Box::as_ref)
    }

    /// The value at an index that lies in no block.
    pub fn outside_blocks(&self, index: [i32; 3]) -> [f32; N] {
        let tile = self.tile_sizes.iter().find_map(|log2| {
            let origin = index.map(|i| (i >> log2) << log2);
            self.tiles.get(&(*log2, origin))
        });
        *tile.unwrap_or(&self.background)
    }

    /// The blocks, in ascending order of their keys (index / 8).
    pub fn blocks(&self) -> impl Iterator<Item = ([i32; 3], &[[f32; N]; BLOCK_VOXELS])> {
        self.blocks.iter().map(|(key, block)| (*key, block.as_ref()))
    }

    /// The tiles: origin, binary logarithm of the edge, value.
    pub fn tiles(&self) -> impl Iterator<Item = ([i32; 3], u32, [f32; N])> + '_ {
        self.tiles.iter().map(|((log2, origin), value)| (*origin, *log2, *value))
    }

    /// The background value.
    pub fn background(&self) -> [f32; N] {
        self.background
    }

    /// Transform from indices to the world.
    pub fn transform(&self) -> &Transform {
        &self.transform
    }

    /// The same voxels with another transform.
    pub fn with_transform(self, transform: Transform) -> Self {
        Self { transform, ..self }
    }

    /// Lowest and highest index (inclusive) in any block of a value that differs from the background; none if all are
    /// background.
    pub fn bounds(&self) -> Option<([i32; 3], [i32; 3])> {
        let mut bounds: Option<([i32; 3], [i32; 3])> = None;
        for (key, block) in self.blocks() {
            for voxel in 0..BLOCK_VOXELS as i32 {
                let within = [voxel / (BLOCK * BLOCK), voxel / BLOCK % BLOCK, voxel % BLOCK];
                if block[slot(within)] == self.background {
                    continue;
                }
                let index: [i32; 3] = std::array::from_fn(|axis| key[axis] * BLOCK + within[axis]);
                let (low, high) = bounds.unwrap_or((index, index));
                bounds = Some((
                    std::array::from_fn(|axis| low[axis].min(index[axis])),
                    std::array::from_fn(|axis| high[axis].max(index[axis])),
                ));
            }
        }
        bounds
    }

    /// True if every value is finite.
    pub fn is_finite(&self) -> bool {
        let blocks = self.blocks.values().flat_map(|block| block.iter());
        blocks.chain(self.tiles.values()).chain([&self.background]).flatten().all(|value| value.is_finite())
    }
}

/// Slot of an index in its block: x slowest, z fastest.
pub fn slot(index: [i32; 3]) -> usize {
    let [x, y, z] = index.map(|i| (i & (BLOCK - 1)) as usize);
    (x << 6) | (y << 3) | z
}

fn filled<const N: usize>(value: [f32; N]) -> Box<[[f32; N]; BLOCK_VOXELS]> {
    Box::new([value; BLOCK_VOXELS])
}

/// Scalar product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Vector product.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Euclidean length.
pub(crate) fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
