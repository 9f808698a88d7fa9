//! A tree of bounding boxes over points, sixteen children wide.

use bitcode::{Decode, Encode};
use rayon::prelude::*;

use super::codes::{Frame, QUAD, Quad, Scale, code_of, first_axes, half_step_for, middle_and_half, square};
use super::lanes::Lanes;
use super::sizes::LANES;
use crate::Error;
use crate::bulk::bulk_fields;

/// Receives finished shares that add up to 1; may cancel the work.
pub type Step<'a> = &'a (dyn Fn(f32) -> Result<(), Error> + Sync);

/// A node, or a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Encode, Decode)]
pub struct Child(u32);

const LEAF_BIT: u32 = 1 << 31;

/// Kind of a child, with its number among that kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
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
    pub fn kind(self) -> Kind {
        if self.0 & LEAF_BIT == 0 { Kind::Node(self.0 as usize) } else { Kind::Leaf((self.0 & !LEAF_BIT) as usize) }
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
    /// A tree over the points listed in `order`: those of `points`, each of `axes` coordinates (a multiple of `STAGE`),
    /// which belong to `windows`. `step` receives the finished share.
    pub fn new(points: &[f32], axes: usize, order: &mut [u32], windows: &[u32], step: Step<'_>) -> Result<Self, Error> {
        let total = order.len();
        let builder = Builder { points, axes, windows, total, step };
        let mut tree = Self::empty(axes);
        tree.root = builder.subtree(&mut tree, order)?.0;
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
        Ok(tree)
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
    pub fn frame(&self, group: u32) -> Frame<'_> {
        let (middles, halves) = self.frames[2 * group as usize * self.axes..][..2 * self.axes].split_at(self.axes);
        Frame { middles, halves, scale: self.scales[group as usize] }
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
            Kind::Leaf(leaf) => {
                let first = first_axes(self.axes) / QUAD;
                lanes.prefetch(&self.codes[leaf * first..]);
            }
            Kind::Node(node) => lanes.prefetch(&self.faces[node * self.axes..]),
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

struct Builder<'a> {
    points: &'a [f32],
    axes: usize,
    windows: &'a [u32],
    total: usize,
    step: Step<'a>,
}

/// Subtrees of more points than this are built side by side.
const SIDE_BY_SIDE: usize = 4096;
/// Largest number of points, evenly spaced, that decide along which axis to split.
const SAMPLE: usize = 512;

impl Builder<'_> {
    fn point(&self, i: u32) -> &[f32] {
        &self.points[i as usize * self.axes..][..self.axes]
    }

    /// Builds the subtree over the points listed in `order`; returns it and its bounds.
    fn subtree(&self, tree: &mut Tree, order: &mut [u32]) -> Result<(Child, Bounds), Error> {
        if order.len() <= LANES * LANES {
            return Ok(self.group(tree, order));
        }
        // Every child except the last holds as much as a tree one storey lower can.
        let mut capacity = LANES;
        while capacity * LANES < order.len() {
            capacity *= LANES;
        }
        let parts = self.parts(order, capacity);
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
        Ok(self.node(tree, &children))
    }

    /// Splits `order` into parts of `capacity`; the last may be smaller.
    fn parts<'o>(&self, order: &'o mut [u32], capacity: usize) -> Vec<&'o mut [u32]> {
        let parts = order.len().div_ceil(capacity);
        if parts == 1 {
            return vec![order];
        }
        let large = order.len() > SIDE_BY_SIDE;
        let (left, right) = self.split(order, parts / 2 * capacity);
        let (mut left, right) = if large {
            rayon::join(|| self.parts(left, capacity), || self.parts(right, capacity))
        } else {
            (self.parts(left, capacity), self.parts(right, capacity))
        };
        left.extend(right);
        left
    }

    /// Splits at `middle`, along the axis of largest variance.
    fn split<'o>(&self, order: &'o mut [u32], middle: usize) -> (&'o mut [u32], &'o mut [u32]) {
        let mut sums = vec![(0.0f64, 0.0f64); self.axes];
        let mut count = 0.0;
        for i in order.iter().step_by(order.len().div_ceil(SAMPLE)) {
            count += 1.0;
            for (sum, x) in sums.iter_mut().zip(self.point(*i)) {
                let x = f64::from(*x);
                sum.0 += x;
                sum.1 += x * x;
            }
        }
        let variance = |axis: &usize| sums[*axis].1 / count - maths::square(sums[*axis].0 / count);
        let widest = (0..self.axes).max_by(|a, b| variance(a).total_cmp(&variance(b))).unwrap_or(0);
        let key = |i: &u32| self.points[*i as usize * self.axes + widest];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        order.split_at_mut(middle)
    }

    fn node(&self, tree: &mut Tree, children: &[(Child, Bounds)]) -> (Child, Bounds) {
        let mut bounds = no_bounds(self.axes);
        let mut lanes = [Child::NONE; LANES];
        for (lane, (child, inner)) in lanes.iter_mut().zip(children) {
            *lane = *child;
            for (outer, inner) in bounds.iter_mut().zip(inner) {
                *outer = (outer.0.min(inner.0), outer.1.max(inner.1));
            }
        }
        tree.faces.extend((0..self.axes).map(|axis| {
            // Unused lanes lie beyond all distances.
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
        for part in self.parts(order, LANES) {
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
                self.node(tree, &leaves)
            }
        }
    }

    /// Adds a leaf; returns the largest distance of a point from the position given by its codes.
    fn leaf(&self, tree: &mut Tree, order: &mut [u32], group: u32, middles: &[f32], half_step: f32) -> (Child, f64) {
        order.sort_unstable();
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
