//! A tree of bounding boxes over points, sixteen children wide.

use bitcode::{Decode, Encode};
use rayon::prelude::*;

use super::block::{Frame, frame_of, nearest_code, value};
use super::lanes::Lanes;
use super::{LANES, Step};
use crate::Error;
use crate::bulk::bulk_fields;

/// A node, or a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Encode, Decode)]
pub struct Child(u32);

const LEAF_BIT: u32 = 1 << 31;

/// What a child is, and its number among its kind.
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

    /// Which of the two it is.
    #[inline(always)]
    pub fn kind(self) -> Kind {
        if self.0 & LEAF_BIT == 0 { Kind::Node(self.0 as usize) } else { Kind::Leaf((self.0 & !LEAF_BIT) as usize) }
    }

    /// The same child of a tree that `nodes` and `leaves` have been put in front of.
    fn behind(self, nodes: usize, leaves: usize) -> Self {
        match self {
            Self::NONE => self,
            Self(x) if x & LEAF_BIT == 0 => Self(x + nodes as u32),
            Self(x) => Self(x + leaves as u32),
        }
    }
}

/// Nodes and leaves, in flat arrays: a block's coordinates lie together.
#[derive(Debug, Encode, Decode)]
pub struct Tree {
    axes: usize,
    leaves: Blocks,
    #[bitcode(skip)]
    windows: Vec<[u32; LANES]>,
    #[bitcode(skip)]
    slack: Vec<f32>,
    #[bitcode(skip)]
    faces: Vec<[[f32; LANES]; 2]>,
    children: Vec<[Child; LANES]>,
    /// Where to begin.
    pub root: Child,
}

/// Points of the leaves: for each leaf a frame, and codes for each axis.
#[derive(Debug, Encode, Decode)]
struct Blocks {
    #[bitcode(skip)]
    frames: Vec<f32>,
    #[bitcode(skip)]
    codes: Vec<[u8; LANES]>,
}

bulk_fields!(Tree: leaves, windows, slack, faces);
bulk_fields!(Blocks: frames, codes);

impl Blocks {
    #[inline(always)]
    fn get(&self, block: usize, axes: usize) -> (Frame<'_>, &[[u8; LANES]]) {
        let (offsets, steps) = self.frames[2 * block * axes..][..2 * axes].split_at(axes);
        (Frame { offsets, steps }, &self.codes[block * axes..][..axes])
    }

    fn push(&mut self, frames: &[(f32, f32)], codes: impl Iterator<Item = [u8; LANES]>) {
        self.frames.extend(frames.iter().map(|(offset, _)| offset));
        self.frames.extend(frames.iter().map(|(_, step)| step));
        self.codes.extend(codes);
    }

    fn append(&mut self, mut other: Self) {
        self.frames.append(&mut other.frames);
        self.codes.append(&mut other.codes);
    }

    fn bytes(&self) -> usize {
        self.frames.len() * size_of::<f32>() + self.codes.len() * size_of::<[u8; LANES]>()
    }
}

/// Up to sixteen windows; lanes not in use repeat the last.
#[derive(Debug)]
pub struct Leaf<'a> {
    /// Where its codes lie.
    pub frame: Frame<'a>,
    /// Its points.
    pub codes: &'a [[u8; LANES]],
    /// Window numbers.
    pub windows: &'a [u32; LANES],
    /// Farthest that a point lies from where its codes say.
    pub slack: f32,
}

/// Up to sixteen boxes.
#[derive(Debug)]
pub struct Node<'a> {
    /// Lower and upper faces of its boxes, axis by axis.
    pub faces: &'a [[[f32; LANES]; 2]],
    /// What is in them; `NONE` from the first lane on that is not in use.
    pub children: &'a [Child; LANES],
}

impl Tree {
    /// A tree over `order`ed points: those of `points`, each of `axes` coordinates (a multiple of
    /// `STAGE`), the first of which belongs to `first_window`. `step` is told the part done.
    pub fn new(
        points: &[f32],
        axes: usize,
        order: &mut [u32],
        first_window: usize,
        step: Step<'_>,
    ) -> Result<Self, Error> {
        let total = order.len();
        let builder = Builder { points, axes, first_window, total, step };
        let mut tree = Self::empty(axes);
        tree.root = builder.subtree(&mut tree, order)?.0;
        tree.leaves.frames.shrink_to_fit();
        tree.leaves.codes.shrink_to_fit();
        tree.windows.shrink_to_fit();
        tree.slack.shrink_to_fit();
        tree.faces.shrink_to_fit();
        tree.children.shrink_to_fit();
        Ok(tree)
    }

    fn empty(axes: usize) -> Self {
        Self {
            axes,
            leaves: Blocks { frames: Vec::new(), codes: Vec::new() },
            windows: Vec::new(),
            slack: Vec::new(),
            faces: Vec::new(),
            children: Vec::new(),
            root: Child::NONE,
        }
    }

    /// A leaf.
    #[inline(always)]
    pub fn leaf(&self, leaf: usize) -> Leaf<'_> {
        let (frame, codes) = self.leaves.get(leaf, self.axes);
        Leaf { frame, codes, windows: &self.windows[leaf], slack: self.slack[leaf] }
    }

    /// A node.
    #[inline(always)]
    pub fn node(&self, node: usize) -> Node<'_> {
        Node { faces: &self.faces[node * self.axes..][..self.axes], children: &self.children[node] }
    }

    /// Asks for the memory of a leaf that may be visited soon.
    #[inline(always)]
    pub fn prefetch<L: Lanes>(&self, lanes: L, child: Child) {
        if let Kind::Leaf(leaf) = child.kind() {
            lanes.prefetch(&self.leaves.frames[2 * leaf * self.axes..]);
            lanes.prefetch(&self.leaves.codes[leaf * self.axes..]);
        }
    }

    /// Bytes held, about.
    pub fn bytes(&self) -> usize {
        let of_leaf = size_of::<[u32; LANES]>() + size_of::<f32>();
        let lists = self.windows.len() * of_leaf + self.children.len() * size_of::<[Child; LANES]>();
        self.leaves.bytes() + self.faces.len() * size_of::<[[f32; LANES]; 2]>() + lists
    }

    /// Takes over another tree; answers where its root is now.
    fn append(&mut self, mut other: Self) -> Child {
        let (nodes, leaves) = (self.children.len(), self.windows.len());
        self.leaves.append(other.leaves);
        self.windows.append(&mut other.windows);
        self.slack.append(&mut other.slack);
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
    first_window: usize,
    total: usize,
    step: Step<'a>,
}

/// Subtrees of more points than this are built side by side.
const SIDE_BY_SIDE: usize = 4096;
/// At most this many points, evenly spread, decide along which axis to split.
const SAMPLE: usize = 512;

impl Builder<'_> {
    fn point(&self, i: u32) -> &[f32] {
        &self.points[i as usize * self.axes..][..self.axes]
    }

    /// Builds the subtree over the points named in `order`; answers it and its bounds.
    fn subtree(&self, tree: &mut Tree, order: &mut [u32]) -> Result<(Child, Bounds), Error> {
        if order.len() <= LANES {
            return Ok(self.leaf(tree, order));
        }
        // Every child but the last holds as much as a tree one storey lower can.
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
            // Put together in order: the tree must not depend on the number of threads.
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
        let variance = |axis: &usize| sums[*axis].1 / count - (sums[*axis].0 / count).powi(2);
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

    fn leaf(&self, tree: &mut Tree, order: &mut [u32]) -> (Child, Bounds) {
        order.sort_unstable();
        let lanes: [u32; LANES] = std::array::from_fn(|lane| order[lane.min(order.len() - 1)]);
        let mut bounds = no_bounds(self.axes);
        for i in order.iter() {
            for (bounds, x) in bounds.iter_mut().zip(self.point(*i)) {
                *bounds = (bounds.0.min(*x), bounds.1.max(*x));
            }
        }
        let frames: Vec<(f32, f32)> = bounds.iter().map(|(low, high)| frame_of(*low, *high)).collect();
        let mut errors = [0.0f64; LANES];
        let codes = frames.iter().enumerate().map(|(axis, frame)| {
            std::array::from_fn(|lane| {
                let x = self.point(lanes[lane])[axis];
                let code = nearest_code(x, *frame);
                errors[lane] += (value(code, *frame) - f64::from(x)).powi(2);
                code
            })
        });
        tree.leaves.push(&frames, codes);
        tree.windows.push(lanes.map(|i| self.first_window as u32 + i));
        let error = errors.iter().fold(0.0f64, |error, x| error.max(*x)).sqrt();
        // Rounded up: a bound must stay one.
        tree.slack.push((error * (1.0 + 1e-6)) as f32);
        (Child::of_leaf(tree.windows.len() - 1), bounds)
    }
}
