//! Volume sources of a flame, voxel by voxel.
//!
//! By Gauss's theorem the flux through a closed front is the divergence of the flow summed over everything that burns
//! (Chadwick & James 2011, §3, eq. 6-8, in reverse). A frame's flux is therefore a sum over voxels, each with its own
//! share, and the change from one frame to the next is known voxel by voxel.

use crate::error::Error;
use crate::frame::Frame;
use crate::grid::{BLOCK, BLOCK_VOXELS, Grid, Transform, cross, dot, slot};
use crate::velocity::{Placement, Velocity};

/// Voxels along the edge of a block, including the neighbours that its smoothed values need.
const REACH: usize = BLOCK as usize + 2;

/// Binary logarithm of the edge of the largest tile that is unpacked.
const LARGEST_TILE: u32 = 7;

/// The slope per voxel below which a field is a plateau.
const FLAT: f64 = 1e-6;

/// The sources of a block's voxels.
pub(super) type Block = [[f32; 1]; BLOCK_VOXELS];

/// A block in which nothing burns.
const NOTHING: Block = [[0.0]; BLOCK_VOXELS];

/// The volume that every burning voxel of a frame emits per second.
#[derive(Debug, Clone, PartialEq)]
pub struct VoxelSources {
    /// The voxels' edges in world units.
    edges: [f64; 3],
    /// The sources; indices count from the voxel nearest the world's origin.
    given: Grid<1>,
}

impl Default for VoxelSources {
    fn default() -> Self {
        Self { edges: [0.0; 3], given: Grid::new([0.0], Transform::identity()) }
    }
}

impl VoxelSources {
    /// The values of a field as volumes per second: of a rate of heat release, or of a solver's divergence input.
    ///
    /// # Errors
    /// If the field is not finite everywhere, or fills all space.
    pub fn of_field(field: &Grid<1>) -> Result<Self, Error> {
        let background = f64::from(field.background()[0]);
        if background != 0.0 {
            return Err(Error::Unbounded { background, iso: 0.0 });
        }
        if !field.is_finite() {
            return Err(Error::NotFinite { what: "field" });
        }
        let transform = field.transform();
        let volume = voxel_volume(transform);
        let mut source = Self::new(transform);
        let shift = lattice_shift(transform);
        let mut add = |key, block: &Block| {
            source.add(key, shift, &block.map(|[value]| [(f64::from(value) * volume) as f32]));
        };
        field.blocks().for_each(|(key, block)| add(key, block));
        for key in tiled_blocks(field, |value| value != 0.0) {
            add(key, &[field.outside_blocks(key.map(|key| key * BLOCK)); BLOCK_VOXELS]);
        }
        Ok(source)
    }

    /// The sources inside the front at `iso`.
    ///
    /// # Errors
    /// If the field or the flow is not finite everywhere.
    pub fn of_front(frame: &Frame, iso: f64) -> Result<Self, Error> {
        if !frame.field.is_finite() {
            return Err(Error::NotFinite { what: "field" });
        }
        if !frame.velocity.is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let transform = frame.field.transform();
        let volume = voxel_volume(transform);
        let mut source = Self::new(transform);
        let shift = lattice_shift(transform);
        for key in burning_blocks(&frame.field, iso) {
            let fill = fill(&frame.field, key, iso);
            if fill.iter().all(|fill| *fill == 0.0) {
                continue;
            }
            let mut block = NOTHING;
            for ((given, fill), divergence) in block.iter_mut().zip(&fill).zip(divergence(frame, transform, key, &fill))
            {
                *given = [(fill * divergence * volume) as f32];
            }
            source.add(key, shift, &block);
        }
        Ok(source)
    }

    fn new(transform: &Transform) -> Self {
        Self { edges: transform.voxel_edges(), ..Self::default() }
    }

    /// Adds the block of a field at `key`, whose indices are moved by `shift`.
    fn add(&mut self, key: [i32; 3], shift: [i32; 3], block: &Block) {
        let edge = BLOCK as usize;
        for (row, values) in block.chunks_exact(edge).enumerate().filter(|(_, row)| row.iter().any(|[x]| *x != 0.0)) {
            let within = index_of(key, row * edge);
            // Wrapped, not saturated: where numbers end, voxels still are in a block's places.
            let index: [i32; 3] = std::array::from_fn(|axis| within[axis].wrapping_add(shift[axis]));
            // Up to the end of one block, and from the beginning of the next.
            let (first, rest) = values.split_at((BLOCK - (index[2] & (BLOCK - 1))) as usize);
            let next = [index[0], index[1], index[2].wrapping_add(first.len() as i32)];
            for (index, values) in [(index, first), (next, rest)].into_iter().filter(|(_, values)| !values.is_empty()) {
                let start = slot(index);
                self.given.block_mut(index.map(|i| i >> 3))[start..start + values.len()].copy_from_slice(values);
            }
        }
    }

    /// Sum of all sources: the flame's flux.
    pub fn total(&self) -> f64 {
        self.given.blocks().flat_map(|(_, block)| block).map(|[given]| f64::from(*given)).sum()
    }

    /// Sum of the absolute differences to another frame.
    pub fn difference(&self, next: &Self) -> f64 {
        let of_blocks = |(_, before, after): (_, &Block, &Block)| {
            let pairs = before.iter().zip(after);
            pairs.map(|([before], [after])| (f64::from(*after) - f64::from(*before)).abs()).sum::<f64>()
        };
        self.pairs(next).map(of_blocks).sum()
    }

    /// The blocks of two frames in which anything burns in either, in ascending order of their keys. None if their voxels
    /// differ in size.
    pub(super) fn pairs<'a>(&'a self, next: &'a Self) -> impl Iterator<Item = ([i32; 3], &'a Block, &'a Block)> {
        let is_same = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-4;
        let keys = |source: &'a Self| source.given.blocks().map(|(key, _)| key);
        let (mut all, others): (Vec<_>, Vec<_>) = (keys(self).collect(), keys(next).collect());
        let is_comparable = all.is_empty() || others.is_empty() || self.edges.iter().zip(&next.edges).all(is_same);
        all.extend(others);
        all.sort_unstable();
        all.dedup();
        let block = |source: &'a Self, key| source.given.block(key).unwrap_or(&NOTHING);
        let all = if is_comparable { all } else { vec![] };
        all.into_iter().map(move |key| (key, block(self, key), block(next, key)))
    }
}

/// Offset of index 0 from the voxel nearest the world's origin. With it, boxes that move with the flame by whole voxels
/// keep the positions of burning voxels.
fn lattice_shift(transform: &Transform) -> [i32; 3] {
    transform.to_index([0.0; 3]).map(|index| -(index.clamp(-1e6, 1e6).round() as i32))
}

fn voxel_volume(transform: &Transform) -> f64 {
    let [a, b, c] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|step| transform.turn(step));
    dot(a, cross(b, c)).abs()
}

/// Keys of the blocks in which something may burn, and of the blocks around them.
fn burning_blocks(field: &Grid<1>, iso: f64) -> Vec<[i32; 3]> {
    let mut keys = vec![];
    for (key, block) in field.blocks() {
        if block.iter().any(|[value]| f64::from(*value) > iso) {
            // The smoothed front may lie a voxel beyond the block.
            keys.extend(
                (0..27)
                    .map(|n| [n / 9, n / 3 % 3, n % 3])
                    .map(|offset: [i32; 3]| std::array::from_fn(|axis| key[axis] + offset[axis] - 1)),
            );
        }
    }
    keys.extend(tiled_blocks(field, |value| f64::from(value) > iso));
    keys.sort_unstable();
    keys.dedup();
    keys
}

/// Keys of the blocks within tiles of certain values; tiles larger than any flame's are left out.
fn tiled_blocks(field: &Grid<1>, is_wanted: impl Fn(f32) -> bool) -> Vec<[i32; 3]> {
    let mut keys = vec![];
    for (origin, log2, _) in field.tiles().filter(|(_, log2, [value])| *log2 <= LARGEST_TILE && is_wanted(*value)) {
        let edge = 1 << log2.saturating_sub(3);
        for n in 0..edge * edge * edge {
            let offset = [n / (edge * edge), n / edge % edge, n % edge];
            let key: [i32; 3] = std::array::from_fn(|axis| (origin[axis] >> 3) + offset[axis]);
            if field.block(key).is_none() {
                keys.push(key);
            }
        }
    }
    keys
}

/// The share of every voxel of a block that lies inside the front of the smoothed field, taking the front as flat
/// there.
fn fill(field: &Grid<1>, key: [i32; 3], iso: f64) -> Vec<f64> {
    let mut values = [[0.0]; REACH.pow(3)];
    field.copy_around(key, 1, &mut values);
    if values.iter().all(|[value]| f64::from(*value) <= iso) {
        return vec![0.0; BLOCK_VOXELS];
    }
    let filled = |place: usize| {
        let first = neighbour_index(within(place));
        let mut sums = [0.0; 4];
        for (offset, weights) in &SMOOTHING {
            let value = f64::from(values[first + offset][0]);
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += weight * value;
            }
        }
        let [value, x, y, z] = sums;
        let slope = (x * x + y * y + z * z).sqrt().max(FLAT);
        ((value - iso) / slope + 0.5).clamp(0.0, 1.0)
    };
    (0..BLOCK_VOXELS).map(filled).collect()
}

/// The 27 voxels around one, as distances from the first among the values of [`Grid::copy_around`], with their weights in a
/// cubic B-spline and in its slopes along x, y and z.
const SMOOTHING: [(usize, [f64; 4]); 27] = {
    /// Weights at a voxel, and of the slope.
    const KERNELS: [[f64; 3]; 2] = [[1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0], [-0.5, 0.0, 0.5]];
    let mut table = [(0, [0.0; 4]); 27];
    let mut n = 0;
    while n < 27 {
        let (x, y, z) = (n / 9, n / 3 % 3, n % 3);
        let [value, slope] = KERNELS;
        let weights = [
            value[x] * value[y] * value[z],
            slope[x] * value[y] * value[z],
            value[x] * slope[y] * value[z],
            value[x] * value[y] * slope[z],
        ];
        table[n] = (neighbour_index([x, y, z]), weights);
        n += 1;
    }
    table
};

/// The flow's divergence at every burning voxel of a block: the mean over the voxel of the trilinear flow's divergence,
/// which is consistent with its flux through any surface. Differences alone, without the neighbours to the sides, would
/// be some 4 dB too loud above 30 Hz.
fn divergence(frame: &Frame, transform: &Transform, key: [i32; 3], fill: &[f64]) -> Vec<f64> {
    let flow = flow_around(frame, transform, key);
    let of = |place: usize| {
        let first = neighbour_index(within(place));
        let along: [[f64; 3]; 3] = std::array::from_fn(|axis| {
            let mut slope = [0.0; 3];
            for (low, high, weight) in &DIFFERENCES[axis] {
                for (slope, (low, high)) in slope.iter_mut().zip(flow[first + low].iter().zip(flow[first + high])) {
                    *slope += weight * (high - low);
                }
            }
            slope
        });
        (0..3).map(|axis| transform.gradient_to_world(along.map(|slope| slope[axis]))[axis]).sum()
    };
    fill.iter().enumerate().map(|(place, fill)| if *fill > 0.0 { of(place) } else { 0.0 }).collect()
}

/// The pairs of neighbours whose difference makes up a slope along x, y or z, as distances from the first neighbour, with
/// their weights.
const DIFFERENCES: [[(usize, usize, f64); 9]; 3] = {
    /// Weights of the neighbours to the sides.
    const SIDES: [f64; 3] = [0.125, 0.75, 0.125];
    let mut table = [[(0, 0, 0.0); 9]; 3];
    let mut n = 0;
    while n < 27 {
        let (axis, one, other) = (n / 9, n / 3 % 3, n % 3);
        let mut low = [0; 3];
        low[(axis + 1) % 3] = one;
        low[(axis + 2) % 3] = other;
        let mut high = low;
        high[axis] = 2;
        table[axis][n % 9] = (neighbour_index(low), neighbour_index(high), 0.5 * SIDES[one] * SIDES[other]);
        n += 1;
    }
    table
};

/// The flow at the centres of a block's voxels and of those around it.
fn flow_around(frame: &Frame, transform: &Transform, key: [i32; 3]) -> Vec<[f64; 3]> {
    let at_centres = |frame: &Frame| {
        let index = |n: usize| {
            let within = [n / (REACH * REACH), n / REACH % REACH, n % REACH];
            std::array::from_fn(|axis| f64::from(key[axis] * BLOCK + within[axis] as i32 - 1))
        };
        (0..REACH.pow(3)).map(|n| frame.velocity.velocity_at(transform.to_world(index(n)))).collect()
    };
    match &frame.velocity {
        // The usual case: nothing has to be interpolated.
        Velocity::Vectors(flow, Placement::Collocated) if flow.transform() == transform => {
            let mut values = [[0.0; 3]; REACH.pow(3)];
            flow.copy_around(key, 1, &mut values);
            values.iter().map(|flow| flow.map(f64::from)).collect()
        }
        _ => at_centres(frame),
    }
}

/// Index of a voxel of the block at `key`.
fn index_of(key: [i32; 3], place: usize) -> [i32; 3] {
    let within = within(place);
    std::array::from_fn(|axis| key[axis].wrapping_mul(BLOCK).wrapping_add(within[axis] as i32))
}

/// Position of a voxel in its block.
fn within(place: usize) -> [usize; 3] {
    [place >> 6, (place >> 3) & 7, place & 7]
}

/// Index of a voxel among those of a block and around it, counted from the first.
const fn neighbour_index([x, y, z]: [usize; 3]) -> usize {
    (x * REACH + y) * REACH + z
}
