//! Finding the nearest window: exactly, or with a bound on the work.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use multiversion::multiversion;

use super::tree::{Child, Leaf, Node};
use super::{Block, COORDINATES, Index, LANES};
use crate::texture::feature::Features;

/// How much work a search may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// Until the window found is at most (1 + eps) times as far away as the nearest; 0 = exact.
    Exact {
        /// Relative error allowed, 0 or more.
        eps: f64,
    },
    /// At most this many windows and boxes compared.
    Bounded {
        /// Windows and boxes.
        candidates: u32,
    },
}

/// What a search found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Window number.
    pub window: usize,
    /// Squared distance of its feature to the query.
    pub distance_squared: f64,
    /// Windows and boxes compared.
    pub compared: u32,
}

/// Boxes that a bounded search keeps in mind; more than any budget can fill.
const HEAP_CAPACITY: usize = 1 << 13;
/// Sixteen for every storey of the tree; eight storeys hold 2^32 windows.
const STACK_CAPACITY: usize = 9 * LANES;

/// Room for searches; one for each thread that searches. Nothing allocates after `new`.
#[derive(Debug)]
pub struct Searcher {
    stack: Vec<(f32, Child)>,
    heap: BinaryHeap<Reverse<(u32, u32)>>,
}

impl Default for Searcher {
    fn default() -> Self {
        Self::new()
    }
}

impl Searcher {
    /// Room for searches in any index.
    pub fn new() -> Self {
        Self { stack: Vec::with_capacity(STACK_CAPACITY), heap: BinaryHeap::with_capacity(HEAP_CAPACITY) }
    }

    /// The nearest window of `index` to `query`, the lowest of equally near ones. `features` must
    /// be those the index was made of. `hint`, if it is one of the index's windows, is tried first.
    pub fn nearest(
        &mut self,
        index: &Index,
        features: &Features<'_>,
        query: &[f64],
        hint: Option<usize>,
        budget: Budget,
    ) -> Answer {
        let hint = hint.filter(|window| index.windows().contains(window));
        match budget {
            Budget::Exact { eps } => nearest_exact(index, features, query, hint, eps, &mut self.stack),
            Budget::Bounded { candidates } => nearest_bounded(index, features, query, hint, candidates, &mut self.heap),
        }
    }
}

/// Relative rounding of a bound computed in single precision, with room to spare.
const RELATIVE_ROUNDING: f64 = 4e-6;
/// Rounding of a bound relative to the lengths of the vectors it is computed from.
const LENGTH_ROUNDING: f64 = 4e-7;

/// A search under way.
struct Search<'a> {
    index: &'a Index,
    features: &'a Features<'a>,
    query: &'a [f64],
    point: [f32; COORDINATES],
    length: f64,
    /// 1 / (1 + eps).
    tightening: f64,
    best: f64,
    window: usize,
    /// Distance beyond which a bound rules a window out, before the allowance for lengths.
    reach: f64,
    compared: u32,
}

impl<'a> Search<'a> {
    #[inline(always)]
    fn new(index: &'a Index, features: &'a Features<'a>, query: &'a [f64], hint: Option<usize>, eps: f64) -> Self {
        let (point, length) = index.axes.project(query);
        let window = index.first_window;
        let tightening = 1.0 / (1.0 + eps.max(0.0));
        let mut search = Self {
            index,
            features,
            query,
            point,
            length,
            tightening,
            best: f64::INFINITY,
            window,
            reach: f64::INFINITY,
            compared: 0,
        };
        if let Some(hint) = hint {
            search.compare(hint);
        }
        search
    }

    #[inline(always)]
    fn compare(&mut self, window: usize) {
        self.compared += 1;
        if let Some(distance) = self.features.distance(window, self.query, self.best)
            && (distance < self.best || window < self.window)
        {
            self.best = distance;
            self.window = window;
            self.reach = distance.sqrt() * self.tightening * (1.0 + RELATIVE_ROUNDING);
        }
    }

    /// Squared bound above which nothing can be nearer, for vectors up to `radius` long.
    #[inline(always)]
    fn limit(&self, radius: f32) -> f32 {
        let limit = self.reach + LENGTH_ROUNDING * (self.length + f64::from(radius));
        (limit * limit) as f32
    }

    #[inline(always)]
    fn visit_leaf(&mut self, leaf: &Leaf) {
        let mut bounds = [0.0f32; LANES];
        self.compared += LANES as u32;
        if !leaf_bounds(&leaf.points, &self.point, self.limit(leaf.radius), &mut bounds) {
            return;
        }
        for (lane, bound) in bounds.iter().enumerate() {
            if *bound <= self.limit(leaf.radius) && leaf.windows[lane] != u32::MAX {
                self.compare(leaf.windows[lane] as usize);
            }
        }
    }

    /// Hands every child of `node` that may hold something nearer to `found`, with its bound.
    #[inline(always)]
    fn visit_node(&mut self, node: &Node, mut found: impl FnMut(f32, Child)) {
        self.compared += LANES as u32;
        let mut bounds = [0.0f32; LANES];
        let limit = self.limit(self.index.tree.radius);
        if box_bounds(&node.low, &node.high, &self.point, limit, &mut bounds) {
            for (bound, child) in bounds.iter().zip(&node.children).take(node.count) {
                if *bound <= limit {
                    found(*bound, *child);
                }
            }
        }
    }

    #[inline(always)]
    fn answer(&self) -> Answer {
        Answer { window: self.window, distance_squared: self.best, compared: self.compared }
    }
}

/// Depth first, nearest child first.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2", "aarch64+neon"))]
fn nearest_exact(
    index: &Index,
    features: &Features<'_>,
    query: &[f64],
    hint: Option<usize>,
    eps: f64,
    stack: &mut Vec<(f32, Child)>,
) -> Answer {
    let mut search = Search::new(index, features, query, hint, eps);
    stack.clear();
    stack.push((0.0, index.tree.root));
    while let Some((bound, child)) = stack.pop() {
        if bound > search.limit(index.tree.radius) {
            continue;
        }
        match child {
            Child::Leaf(leaf) => search.visit_leaf(&index.tree.leaves[leaf as usize]),
            Child::Node(node) => {
                let base = stack.len();
                search.visit_node(&index.tree.nodes[node as usize], |bound, child| {
                    stack.push((bound, child));
                    let mut at = stack.len() - 1;
                    while at > base && stack[at - 1].0 < bound {
                        stack.swap(at - 1, at);
                        at -= 1;
                    }
                });
            }
        }
    }
    search.answer()
}

/// Best first, until the work allowed is done.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2", "aarch64+neon"))]
fn nearest_bounded(
    index: &Index,
    features: &Features<'_>,
    query: &[f64],
    hint: Option<usize>,
    candidates: u32,
    heap: &mut BinaryHeap<Reverse<(u32, u32)>>,
) -> Answer {
    let mut search = Search::new(index, features, query, hint, 0.0);
    heap.clear();
    let mut next = Some((0.0f32.to_bits(), packed(index.tree.root)));
    while let Some((bits, child)) = next {
        if f32::from_bits(bits) > search.limit(index.tree.radius) {
            break;
        }
        // Until something is found, straight down to the nearest leaf: there is always an answer.
        let mut straight_down = None;
        match unpacked(child) {
            Child::Leaf(leaf) => search.visit_leaf(&index.tree.leaves[leaf as usize]),
            Child::Node(node) => {
                let descending = search.best == f64::INFINITY;
                search.visit_node(&index.tree.nodes[node as usize], |bound, child| {
                    let mut found = (bound.to_bits(), packed(child));
                    if descending && straight_down.is_none_or(|nearest| found < nearest) {
                        match straight_down.replace(found) {
                            Some(farther) => found = farther,
                            None => return,
                        }
                    }
                    if heap.len() < HEAP_CAPACITY {
                        heap.push(Reverse(found));
                    }
                });
            }
        }
        if search.compared >= candidates && search.best.is_finite() {
            break;
        }
        next = straight_down.or_else(|| heap.pop().map(|Reverse(nearest)| nearest));
    }
    search.answer()
}

const LEAF_BIT: u32 = 1 << 31;

fn packed(child: Child) -> u32 {
    match child {
        Child::Node(node) => node,
        Child::Leaf(leaf) => leaf | LEAF_BIT,
    }
}

fn unpacked(child: u32) -> Child {
    if child & LEAF_BIT == 0 { Child::Node(child) } else { Child::Leaf(child & !LEAF_BIT) }
}

/// Coordinates after which it is checked whether any lane is still of use.
const STAGES: [usize; 4] = [0, 4, 8, COORDINATES];

/// Squared distances of sixteen points; false, and not complete, once all exceed `limit`.
#[inline(always)]
fn leaf_bounds(points: &Block, query: &[f32; COORDINATES], limit: f32, bounds: &mut [f32; LANES]) -> bool {
    for stage in STAGES.windows(2) {
        for d in stage[0]..stage[1] {
            for lane in 0..LANES {
                let difference = points[d][lane] - query[d];
                bounds[lane] += difference * difference;
            }
        }
        if !any_within(bounds, limit) {
            return false;
        }
    }
    true
}

/// Squared distances to sixteen boxes; false, and not complete, once all exceed `limit`.
#[inline(always)]
fn box_bounds(low: &Block, high: &Block, query: &[f32; COORDINATES], limit: f32, bounds: &mut [f32; LANES]) -> bool {
    for stage in STAGES.windows(2) {
        for d in stage[0]..stage[1] {
            for lane in 0..LANES {
                let below = low[d][lane] - query[d];
                let above = query[d] - high[d][lane];
                let outside = if below > above { below } else { above };
                let outside = if outside > 0.0 { outside } else { 0.0 };
                bounds[lane] += outside * outside;
            }
        }
        if !any_within(bounds, limit) {
            return false;
        }
    }
    true
}

#[inline(always)]
fn any_within(bounds: &[f32; LANES], limit: f32) -> bool {
    let mut within = 0u32;
    for bound in bounds {
        within |= u32::from(*bound <= limit);
    }
    within != 0
}
