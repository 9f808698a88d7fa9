//! A tree of bounding boxes over points, sixteen children wide.

use bitcode::{Decode, Encode};
use rayon::prelude::*;

use super::axes::{Axes, COLUMNS};
use super::codes::{CodeFrame, QUAD, Quad, Scale, code_of, first_axes, half_step_for, middle_and_half, square};
use super::lanes::Lanes;
use super::sizes::LANES;
use crate::Error;
use crate::bulk::bulk_fields;
use crate::texture::feature::Features;

/// Receives finished shares that add up to 1; may cancel the work.
pub type Step<'a> = &'a (dyn Fn(f32) -> Result<(), Error> + Sync);

/// A node, or a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Encode, Decode)]
pub struct Child(u32);

const LEAF_BIT: u32 = 1 << 31;

/// Kind of a child, with its number among that kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeKind {
    /// A node.
    Node(usize),
    /// A leaf.
    Leaf(usize),
}

impl Child {
    /// No child.
    pub const NONE: Self = Self(u32::MAX);

    /// The node of this number.
    pub fn of_node(node: usize) -> Self {
        Self(node as u32)
    }

    /// The leaf of this number.
    pub fn of_leaf(leaf: usize) -> Self {
        Self(leaf as u32 | LEAF_BIT)
    }

    /// Kind of the child.
    #[inline(always)]
    pub fn kind(self) -> NodeKind {
        if self.0 & LEAF_BIT == 0 {
            NodeKind::Node(self.0 as usize)
        } else {
            NodeKind::Leaf((self.0 & !LEAF_BIT) as usize)
        }
    }

    /// The same child of a tree with `nodes` and `leaves` inserted in front.
    fn behind(self, nodes: usize, leaves: usize) -> Self {
        match self {
            Self::NONE => self,
            Self(x) if x & LEAF_BIT == 0 => Self(x + nodes as u32),
            Self(x) => Self(x + leaves as u32),
        }
    }
}

/// Nodes and leaves, in flat arrays: a leaf's codes are contiguous.
#[derive(Debug, Encode, Decode)]
pub struct Tree {
    axes: usize,
    /// Middles, then halves, of every group of up to sixteen leaves.
    #[bitcode(skip)]
    frames: Vec<f32>,
    scales: Vec<Scale>,
    /// For every leaf: a quad for every four of the first axes, and separately for every four of the others, which are
    /// seldom compared and would only fill the cache.
    #[bitcode(skip)]
    codes: Vec<Quad>,
    #[bitcode(skip)]
    other_codes: Vec<Quad>,
    /// For every leaf, in the same way.
    #[bitcode(skip)]
    squares: Vec<[i32; LANES]>,
    #[bitcode(skip)]
    other_squares: Vec<[i32; LANES]>,
    #[bitcode(skip)]
    windows: Vec<[u32; LANES]>,
    #[bitcode(skip)]
    groups: Vec<u32>,
    #[bitcode(skip)]
    faces: Vec<[[f32; LANES]; 2]>,
    children: Vec<[Child; LANES]>,
    /// Starting point.
    pub root: Child,
}

bulk_fields!(Tree: frames, codes, other_codes, squares, other_squares, windows, groups, faces);

/// Up to sixteen windows; lanes not in use repeat the last.
#[derive(Debug)]
pub struct Leaf<'a> {
    /// The group whose frame applies to its codes.
    pub group: u32,
    /// Its points, along the first axes and along the others.
    pub codes: [&'a [Quad]; 2],
    /// Their squared lengths in half-steps, in the same way.
    pub squares: [&'a [i32; LANES]; 2],
    /// Window numbers.
    pub windows: &'a [u32; LANES],
}

/// Up to sixteen boxes.
#[derive(Debug)]
pub struct Node<'a> {
    /// Lower and upper faces of its boxes, axis by axis.
    pub faces: &'a [[[f32; LANES]; 2]],
    /// The children; `NONE` from the first unused lane on.
    pub children: &'a [Child; LANES],
}

impl Tree {
    /// A tree over `points`, at least one, and the largest distance of a point from the features' mean. `step` receives the
    /// part done.
    pub fn new(points: &Points<'_>, step: Step<'_>) -> Result<(Self, f32), Error> {
        Self::in_parts(points, AT_ONCE, step)
    }

    /// The same tree, bit for bit, with the points of at most `at_once` windows held at a time, 256 or more.
    fn in_parts(points: &Points<'_>, at_once: usize, step: Step<'_>) -> Result<(Self, f32), Error> {
        let total = points.windows.len();
        let mut tree = Self::empty(points.numbers);
        let radius = if total <= at_once {
            let (all, radius) = points.axes.points(points.features, points.windows, points.numbers);
            let builder = Builder { points: &all, axes: points.numbers, windows: points.windows, total, step };
            let mut order: Vec<u32> = (0..total as u32).collect();
            tree.root = builder.subtree(&mut tree, &mut order)?.0;
            radius
        } else {
            let (columns, radius) = points.axes.columns(points.features, points.windows);
            let top = Top { points, columns, at_once, total, step };
            let mut order: Vec<u32> = (0..total as u32).collect();
            tree.root = top.subtree(&mut tree, &mut order)?.0;
            radius
        };
        tree.frames.shrink_to_fit();
        tree.scales.shrink_to_fit();
        tree.codes.shrink_to_fit();
        tree.other_codes.shrink_to_fit();
        tree.squares.shrink_to_fit();
        tree.other_squares.shrink_to_fit();
        tree.windows.shrink_to_fit();
        tree.groups.shrink_to_fit();
        tree.faces.shrink_to_fit();
        tree.children.shrink_to_fit();
        Ok((tree, radius))
    }

    fn empty(axes: usize) -> Self {
        Self {
            axes,
            frames: Vec::new(),
            scales: Vec::new(),
            codes: Vec::new(),
            other_codes: Vec::new(),
            squares: Vec::new(),
            other_squares: Vec::new(),
            windows: Vec::new(),
            groups: Vec::new(),
            faces: Vec::new(),
            children: Vec::new(),
            root: Child::NONE,
        }
    }

    /// A leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: usize) -> Leaf<'_> {
        let first = first_axes(self.axes) / QUAD;
        let others = self.axes / QUAD - first;
        Leaf {
            group: self.groups[leaf],
            codes: [&self.codes[leaf * first..][..first], &self.other_codes[leaf * others..][..others]],
            squares: [&self.squares[leaf], &self.other_squares[leaf]],
            windows: &self.windows[leaf],
        }
    }

    /// A group's frame.
    #[inline(always)]
    pub fn frame(&self, group: u32) -> CodeFrame<'_> {
        let (middles, halves) = self.frames[2 * group as usize * self.axes..][..2 * self.axes].split_at(self.axes);
        CodeFrame { middles, halves, scale: self.scales[group as usize] }
    }

    /// A node.
    #[inline(always)]
    pub fn node(&self, node: usize) -> Node<'_> {
        Node { faces: &self.faces[node * self.axes..][..self.axes], children: &self.children[node] }
    }

    /// Prefetches a leaf or node that may be visited soon.
    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, lanes: L, child: Child) {
        match child.kind() {
            NodeKind::Leaf(leaf) => {
                let first = first_axes(self.axes) / QUAD;
                lanes.prefetch(&self.codes[leaf * first..]);
            }
            NodeKind::Node(node) => lanes.prefetch(&self.faces[node * self.axes..]),
        }
    }

    /// Approximate number of bytes held.
    pub fn bytes(&self) -> usize {
        let of_leaf = size_of::<[u32; LANES]>() + 2 * size_of::<[i32; LANES]>() + size_of::<u32>();
        let leaves = self.windows.len() * of_leaf + (self.codes.len() + self.other_codes.len()) * size_of::<Quad>();
        let groups = self.frames.len() * size_of::<f32>() + self.scales.len() * size_of::<Scale>();
        let nodes =
            self.children.len() * size_of::<[Child; LANES]>() + self.faces.len() * size_of::<[[f32; LANES]; 2]>();
        leaves + groups + nodes
    }

    /// Appends another tree; returns the new place of its root.
    fn append(&mut self, mut other: Self) -> Child {
        let (nodes, leaves, groups) = (self.children.len(), self.windows.len(), self.scales.len() as u32);
        self.frames.append(&mut other.frames);
        self.scales.append(&mut other.scales);
        self.codes.append(&mut other.codes);
        self.other_codes.append(&mut other.other_codes);
        self.squares.append(&mut other.squares);
        self.other_squares.append(&mut other.other_squares);
        self.windows.append(&mut other.windows);
        self.groups.extend(other.groups.iter().map(|group| group + groups));
        self.faces.append(&mut other.faces);
        self.children.extend(other.children.iter().map(|children| children.map(|x| x.behind(nodes, leaves))));
        other.root.behind(nodes, leaves)
    }
}

/// Lowest and highest coordinate along each axis.
type Bounds = Vec<(f32, f32)>;

fn no_bounds(axes: usize) -> Bounds {
    vec![(f32::MAX, f32::MIN); axes]
}

/// Subtrees of more points than this are built side by side.
const SIDE_BY_SIDE: usize = 4096;
/// At most this many points, evenly spread, decide along which axis to split.
const SAMPLE: usize = 512;
/// Most windows whose points are held at once: 50 MB of them. All points of a long recording would take more memory than
/// the index that is made of them.
const AT_ONCE: usize = 1 << 18;

/// Windows as points: `numbers` coordinates each (a multiple of `STAGE`).
#[derive(Debug, Clone, Copy)]
pub struct Points<'a> {
    /// Axes of the coordinates.
    pub axes: &'a Axes,
    /// Features that are projected.
    pub features: &'a Features<'a>,
    /// The windows, rising.
    pub windows: &'a [u32],
    /// Coordinates of a point.
    pub numbers: usize,
}

/// Divides points into two halves.
trait Split: Sync {
    /// Moves the `middle` points that lie lowest along the axis of largest variance to the front.
    fn split(&self, order: &mut [u32], middle: usize);
}

/// Splits `order` into parts of `capacity`; the last may be smaller.
fn parts<'o>(by: &impl Split, order: &'o mut [u32], capacity: usize) -> Vec<&'o mut [u32]> {
    let count = order.len().div_ceil(capacity);
    if count == 1 {
        return vec![order];
    }
    let large = order.len() > SIDE_BY_SIDE;
    let middle = count / 2 * capacity;
    by.split(order, middle);
    let (left, right) = order.split_at_mut(middle);
    let (mut left, right) = if large {
        rayon::join(|| parts(by, left, capacity), || parts(by, right, capacity))
    } else {
        (parts(by, left, capacity), parts(by, right, capacity))
    };
    left.extend(right);
    left
}

/// Points that a child holds at most: every child but the last holds as much as a tree one storey lower can.
fn capacity_below(points: usize) -> usize {
    let mut capacity = LANES;
    while capacity * LANES < points {
        capacity *= LANES;
    }
    capacity
}

/// The axis along which points differ most.
fn widest<'p>(axes: usize, sampled: impl Iterator<Item = &'p [f32]>) -> usize {
    let mut sums = vec![(0.0f64, 0.0f64); axes];
    let mut count = 0.0;
    for point in sampled {
        count += 1.0;
        for (sum, x) in sums.iter_mut().zip(point) {
            let x = f64::from(*x);
            sum.0 += x;
            sum.1 += x * x;
        }
    }
    let variance = |axis: &usize| sums[*axis].1 / count - maths::square(sums[*axis].0 / count);
    (0..axes).max_by(|a, b| variance(a).total_cmp(&variance(b))).unwrap_or(0)
}

/// Stride with which `points` are sampled.
fn stride(points: usize) -> usize {
    points.div_ceil(SAMPLE)
}

/// Builds the storeys above those whose points are held at once.
struct Top<'a> {
    points: &'a Points<'a>,
    columns: Vec<[f32; COLUMNS]>,
    at_once: usize,
    total: usize,
    step: Step<'a>,
}

impl Split for Top<'_> {
    fn split(&self, order: &mut [u32], middle: usize) {
        let Points { axes, features, numbers, .. } = *self.points;
        let sampled: Vec<u32> = self.windows_of(order.iter().step_by(stride(order.len())));
        let (sampled, _) = axes.points(features, &sampled, numbers);
        let axis = widest(numbers, sampled.chunks_exact(numbers));
        let mut keys: Vec<(f32, u32)> = if axis < COLUMNS {
            order.iter().map(|i| (self.columns[*i as usize][axis], *i)).collect()
        } else {
            let column = axes.column(features, &self.windows_of(order.iter()), numbers, axis);
            column.into_iter().zip(order.iter().copied()).collect()
        };
        keys.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        order.iter_mut().zip(keys).for_each(|(i, (_, sorted))| *i = sorted);
    }
}

impl Top<'_> {
    fn windows_of<'i>(&self, order: impl Iterator<Item = &'i u32>) -> Vec<u32> {
        order.map(|i| self.points.windows[*i as usize]).collect()
    }

    /// Builds the subtree over the points named in `order`; answers it and its bounds.
    fn subtree(&self, tree: &mut Tree, order: &mut [u32]) -> Result<(Child, Bounds), Error> {
        let Points { axes, features, numbers, .. } = *self.points;
        if order.len() <= self.at_once {
            let windows = self.windows_of(order.iter());
            let (points, _) = axes.points(features, &windows, numbers);
            let builder =
                Builder { points: &points, axes: numbers, windows: &windows, total: self.total, step: self.step };
            // In the order that the storeys above have left, which decides what is sampled.
            let mut order: Vec<u32> = (0..windows.len() as u32).collect();
            return builder.subtree(tree, &mut order);
        }
        let mut children = Vec::with_capacity(LANES);
        // One after the other: what each needs for itself is the most that is held.
        for part in parts(self, order, capacity_below(order.len())) {
            children.push(self.subtree(tree, part)?);
        }
        Ok(node(tree, numbers, &children))
    }
}

struct Builder<'a> {
    points: &'a [f32],
    axes: usize,
    windows: &'a [u32],
    total: usize,
    step: Step<'a>,
}

impl Split for Builder<'_> {
    fn split(&self, order: &mut [u32], middle: usize) {
        let axis = widest(self.axes, order.iter().step_by(stride(order.len())).map(|i| self.point(*i)));
        let key = |i: &u32| self.points[*i as usize * self.axes + axis];
        // Of equal points the earlier window comes first.
        let window = |i: &u32| self.windows[*i as usize];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then_with(|| window(a).cmp(&window(b))));
    }
}

impl Builder<'_> {
    fn point(&self, i: u32) -> &[f32] {
        &self.points[i as usize * self.axes..][..self.axes]
    }

    /// Builds the subtree over the points listed in `order`; returns it and its bounds.
    fn subtree(&self, tree: &mut Tree, order: &mut [u32]) -> Result<(Child, Bounds), Error> {
        if order.len() <= LANES * LANES {
            return Ok(self.group(tree, order));
        }
        let parts = parts(self, order, capacity_below(order.len()));
        let side_by_side = parts.iter().any(|part| part.len() > SIDE_BY_SIDE);
        let mut children = Vec::with_capacity(LANES);
        if side_by_side {
            let build = |part: &mut [u32]| {
                let mut own = Tree::empty(self.axes);
                let (root, bounds) = self.subtree(&mut own, part)?;
                own.root = root;
                Ok((own, bounds))
            };
            // Combined in order: the tree must not depend on the number of threads.
            let built: Result<Vec<(Tree, Bounds)>, Error> = parts.into_par_iter().map(build).collect();
            children.extend(built?.into_iter().map(|(own, bounds)| (tree.append(own), bounds)));
        } else {
            let points: usize = parts.iter().map(|part| part.len()).sum();
            for part in parts {
                children.push(self.subtree(tree, part)?);
            }
            if points > SIDE_BY_SIDE / LANES {
                (self.step)(points as f32 / self.total as f32)?;
            }
        }
        Ok(node(tree, self.axes, &children))
    }

    fn bounds(&self, order: &[u32]) -> Bounds {
        let mut bounds = no_bounds(self.axes);
        for i in order {
            for (bounds, x) in bounds.iter_mut().zip(self.point(*i)) {
                *bounds = (bounds.0.min(*x), bounds.1.max(*x));
            }
        }
        bounds
    }

    /// Up to sixteen leaves that share a frame.
    fn group(&self, tree: &mut Tree, order: &mut [u32]) -> (Child, Bounds) {
        let bounds = self.bounds(order);
        let (middles, halves): (Vec<f32>, Vec<f32>) =
            bounds.iter().map(|(low, high)| middle_and_half(*low, *high)).unzip();
        let half_step = half_step_for(halves.iter().copied());
        let group = tree.scales.len() as u32;
        let mut error = 0.0f64;
        let mut leaves: Vec<(Child, Bounds)> = Vec::with_capacity(LANES);
        for part in parts(self, order, LANES) {
            let (leaf, largest) = self.leaf(tree, part, group, &middles, half_step);
            error = error.max(largest);
            leaves.push((leaf, self.bounds(part)));
        }
        tree.frames.extend(middles);
        tree.frames.extend(halves);
        // Rounded up: a bound must remain a bound.
        tree.scales.push(Scale { half_step, slack: (error * (1.0 + 1e-6)) as f32 });
        match leaves.pop() {
            Some(only) if leaves.is_empty() => only,
            last => {
                leaves.extend(last);
                node(tree, self.axes, &leaves)
            }
        }
    }

    /// Adds a leaf; returns the largest distance of a point from the position given by its codes.
    fn leaf(&self, tree: &mut Tree, order: &mut [u32], group: u32, middles: &[f32], half_step: f32) -> (Child, f64) {
        order.sort_unstable_by_key(|i| self.windows[*i as usize]);
        let lanes: [u32; LANES] = std::array::from_fn(|lane| order[lane.min(order.len() - 1)]);
        let mut quads = vec![[0; QUAD * LANES]; self.axes / QUAD];
        let mut error = 0.0f64;
        let mut squares = [[0; LANES]; 2];
        for (lane, point) in lanes.iter().map(|point| self.point(*point)).enumerate() {
            let mut lost = 0.0;
            for (axis, (x, middle)) in point.iter().zip(middles).enumerate() {
                let (code, value) = code_of(*x, *middle, half_step);
                lost += maths::square(value - f64::from(*x));
                quads[axis / QUAD][QUAD * lane + axis % QUAD] = code;
                squares[usize::from(axis >= first_axes(self.axes))][lane] += square(code);
            }
            error = error.max(lost.sqrt());
        }
        let (first, others) = quads.split_at(first_axes(self.axes) / QUAD);
        tree.codes.extend(first);
        tree.other_codes.extend(others);
        tree.squares.push(squares[0]);
        tree.other_squares.push(squares[1]);
        tree.windows.push(lanes.map(|i| self.windows[i as usize]));
        tree.groups.push(group);
        (Child::of_leaf(tree.windows.len() - 1), error)
    }
}

/// A node over `children`, and its bounds.
fn node(tree: &mut Tree, axes: usize, children: &[(Child, Bounds)]) -> (Child, Bounds) {
    let mut bounds = no_bounds(axes);
    let mut lanes = [Child::NONE; LANES];
    for (lane, (child, inner)) in lanes.iter_mut().zip(children) {
        *lane = *child;
        for (outer, inner) in bounds.iter_mut().zip(inner) {
            *outer = (outer.0.min(inner.0), outer.1.max(inner.1));
        }
    }
    tree.faces.extend((0..axes).map(|axis| {
        // Lanes not in use lie beyond all distances.
        let mut faces = [[f32::MAX; LANES], [f32::MIN; LANES]];
        for (lane, (_, inner)) in children.iter().enumerate() {
            faces[0][lane] = inner[axis].0;
            faces[1][lane] = inner[axis].1;
        }
        faces
    }));
    tree.children.push(lanes);
    (Child::of_node(tree.children.len() - 1), bounds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;
    use crate::texture::{Dictionary, PyramidConfig};

    #[test]
    fn a_tree_built_in_parts_is_the_tree_built_at_once() {
        // Noise differs along all axes alike, so that splits also fall on axes beyond the first few.
        let mut noise = vec![0.0; 60_000];
        White::new(1, 2).fill(0, &mut noise);
        let shape = PyramidConfig { levels: 4, ..PyramidConfig::default() };
        let dictionary = Dictionary::new(&[noise], 44_100.0, &shape, &|_| true).unwrap();
        let (features, windows) = (dictionary.features(0), dictionary.index(0).unwrap().windows());
        let axes = Axes::new(&features, windows.clone());
        let windows: Vec<u32> = windows.map(|window| window as u32).collect();
        assert!(windows.len() > 5000, "{} windows are too few for several storeys", windows.len());
        for numbers in [8, 48] {
            let points = Points { axes: &axes, features: &features, windows: &windows, numbers };
            let built = |at_once: usize| format!("{:?}", Tree::in_parts(&points, at_once, &|_| Ok(())).unwrap());
            let whole = built(usize::MAX);
            for at_once in [256, 1000, 5000] {
                assert!(built(at_once) == whole, "{numbers} numbers, {at_once} windows at once");
            }
        }
    }
}
