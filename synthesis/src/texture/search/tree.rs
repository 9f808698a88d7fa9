//! A tree of bounding boxes over points, sixteen children wide.

use std::collections::HashMap;

use super::axes::Point;
use super::{Block, COORDINATES, LANES};

/// Bounds of up to sixteen children.
#[derive(Debug)]
pub struct Node {
    /// Lowest coordinate of each child.
    pub low: Block,
    /// Highest coordinate of each child.
    pub high: Block,
    /// What each child is.
    pub children: [Child; LANES],
    /// Children in use; the lanes beyond hold bounds that nothing lies near.
    pub count: usize,
}

/// A child of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Child {
    /// Index of a node.
    Node(u32),
    /// Index of a leaf.
    Leaf(u32),
}

/// Up to sixteen windows.
#[derive(Debug)]
pub struct Leaf {
    /// Their points; lanes not in use lie at infinity.
    pub points: Block,
    /// Their window numbers.
    pub windows: [u32; LANES],
    /// Largest distance of one of them from the mean, for the allowance for rounding.
    pub radius: f32,
}

/// The whole tree; the root is the last node, or the only leaf.
#[derive(Debug)]
pub struct Tree {
    /// Inner nodes.
    pub nodes: Vec<Node>,
    /// Leaves.
    pub leaves: Vec<Leaf>,
    /// Largest distance of a window from the mean.
    pub radius: f32,
    /// Where to begin.
    pub root: Child,
}

/// A box.
type Bounds = (Point, Point);

impl Tree {
    /// A tree over `points`, the first of which belongs to `first_window`; `same` tells whether two
    /// windows' features are equal.
    pub fn new(points: &[(Point, f32)], first_window: usize, same: &dyn Fn(usize, usize) -> bool) -> Self {
        let mut order = distinct(points, same);
        let mut tree = Self { nodes: Vec::new(), leaves: Vec::new(), radius: 0.0, root: Child::Leaf(0) };
        let builder = Builder { points, first_window };
        tree.root = builder.subtree(&mut tree, &mut order).0;
        tree.radius = tree.leaves.iter().fold(0.0, |radius, leaf| leaf.radius.max(radius));
        tree
    }

    /// Bytes held, about.
    pub fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.leaves.len() * size_of::<Leaf>()
    }
}

/// The points without exact copies of an earlier window, which stands for them: a recording may
/// hold minutes of digital silence.
fn distinct(points: &[(Point, f32)], same: &dyn Fn(usize, usize) -> bool) -> Vec<u32> {
    let mut first_of = HashMap::new();
    let mut order = Vec::with_capacity(points.len());
    for (i, (point, length)) in points.iter().enumerate() {
        let first = *first_of.entry((point.map(f32::to_bits), length.to_bits())).or_insert(i);
        if first == i || !same(first, i) {
            order.push(i as u32);
        }
    }
    order
}

struct Builder<'a> {
    points: &'a [(Point, f32)],
    first_window: usize,
}

impl Builder<'_> {
    /// Builds the subtree over the points named in `order`; answers it and its bounds.
    fn subtree(&self, tree: &mut Tree, order: &mut [u32]) -> (Child, Bounds) {
        if order.len() <= LANES {
            return self.leaf(tree, order);
        }
        let mut parts: Vec<&mut [u32]> = vec![order];
        while parts.len() < LANES {
            let largest = (0..parts.len()).max_by_key(|i| (parts[*i].len(), LANES - i)).unwrap_or(0);
            if parts[largest].len() <= LANES {
                break;
            }
            let part = std::mem::take(&mut parts[largest]);
            let (left, right) = self.split(part);
            parts[largest] = left;
            parts.insert(largest + 1, right);
        }
        let built: Vec<(Child, Bounds)> = parts.into_iter().map(|part| self.subtree(tree, part)).collect();
        let mut node = Node {
            low: [[f32::MAX; LANES]; COORDINATES],
            high: [[f32::MAX; LANES]; COORDINATES],
            children: [Child::Leaf(0); LANES],
            count: built.len(),
        };
        let mut bounds = ([f32::MAX; COORDINATES], [f32::MIN; COORDINATES]);
        for (lane, (child, (low, high))) in built.into_iter().enumerate() {
            node.children[lane] = child;
            for d in 0..COORDINATES {
                node.low[d][lane] = low[d];
                node.high[d][lane] = high[d];
                bounds.0[d] = bounds.0[d].min(low[d]);
                bounds.1[d] = bounds.1[d].max(high[d]);
            }
        }
        tree.nodes.push(node);
        (Child::Node(tree.nodes.len() as u32 - 1), bounds)
    }

    /// Splits at a multiple of sixteen near the middle, along the coordinate of largest variance.
    fn split<'o>(&self, order: &'o mut [u32]) -> (&'o mut [u32], &'o mut [u32]) {
        let mut sums = [(0.0f64, 0.0f64); COORDINATES];
        for i in order.iter() {
            for (sum, x) in sums.iter_mut().zip(&self.points[*i as usize].0) {
                let x = f64::from(*x);
                sum.0 += x;
                sum.1 += x * x;
            }
        }
        let count = order.len() as f64;
        let variance = |d: &usize| sums[*d].1 / count - (sums[*d].0 / count).powi(2);
        let widest = (0..COORDINATES).max_by(|a, b| variance(a).total_cmp(&variance(b))).unwrap_or(0);
        let leaves = order.len().div_ceil(LANES);
        let middle = (leaves / 2 * LANES).max(LANES).min(order.len() - 1);
        let key = |i: &u32| self.points[*i as usize].0[widest];
        order.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
        order.split_at_mut(middle)
    }

    fn leaf(&self, tree: &mut Tree, order: &mut [u32]) -> (Child, Bounds) {
        order.sort_unstable();
        let mut leaf = Leaf { points: [[f32::INFINITY; LANES]; COORDINATES], windows: [u32::MAX; LANES], radius: 0.0 };
        let mut bounds = ([f32::MAX; COORDINATES], [f32::MIN; COORDINATES]);
        for (lane, i) in order.iter().enumerate() {
            let (point, length) = &self.points[*i as usize];
            leaf.windows[lane] = self.first_window as u32 + i;
            leaf.radius = leaf.radius.max(*length);
            for (d, x) in point.iter().enumerate() {
                leaf.points[d][lane] = *x;
                bounds.0[d] = bounds.0[d].min(*x);
                bounds.1[d] = bounds.1[d].max(*x);
            }
        }
        tree.leaves.push(leaf);
        (Child::Leaf(tree.leaves.len() as u32 - 1), bounds)
    }
}
