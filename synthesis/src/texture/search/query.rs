//! Finding the nearest window: exactly, or with a bound on the work.

use super::Index;
use super::axes::Projection;
use super::block::box_bounds;
use super::coded::Coded;
use super::frontier::Frontier;
use super::lanes::{Lanes, Machine, Work};
use super::shells::{SHELLS, Shell};
use super::sizes::{AXES_MAX, LANES};
use super::tree::{Child, NodeKind};
use crate::texture::feature::Features;

/// Amount of work that a search may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Budget {
    /// Until the window found is at most (1 + eps) times as far away as the nearest; 0 = exact.
    Exact {
        /// Relative error allowed, 0 or more.
        eps: f64,
    },
    /// At most this many windows and boxes compared, but no fewer than [`Budget::LEAST`].
    Bounded {
        /// Windows and boxes; one compared in full counts as [`COMPARISON_COST`].
        candidates: u32,
    },
}

impl Budget {
    /// Enough to find something in any recording: one descent of the tree, and all of a leaf in full.
    pub const LEAST: u32 = COMPARISON_COST + STOREYS as u32 * LANES as u32 + LEAF_COST_MAX;
}

/// Result of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchResult {
    /// Window number.
    pub window: usize,
    /// Windows and boxes compared, those in full as often as they cost.
    pub compared: u32,
    /// Windows compared in full.
    pub compared_in_full: u32,
}

/// Storeys of the largest tree: 16^7 leaves hold 2^32 windows.
const STOREYS: usize = 8;
/// Cost of a leaf, in bounds of boxes: its windows' bounds are integers.
const LEAF_COST: u32 = 8;
/// Most that one leaf or node can cost: all bounds, and all of a leaf's windows in full.
const LEAF_COST_MAX: u32 = LEAF_COST + COMPARISON_COST * LANES as u32;
/// Cost of comparing a window in full, in bounds of windows or boxes.
pub const COMPARISON_COST: u32 = 4;
/// Number of boxes that a bounded search remembers; more than any budget can fill.
const FRONTIER_CAPACITY: usize = 1 << 13;

/// Working memory of searches, one for each searching thread. Nothing allocates after `new`.
#[derive(Debug)]
pub struct Searcher {
    machine: Machine,
    stack: Vec<(f32, Child)>,
    frontier: Frontier,
}

impl Default for Searcher {
    fn default() -> Self {
        Self::new()
    }
}

impl Searcher {
    /// Working memory for searches in any index, with the fastest arithmetic of this machine.
    pub fn new() -> Self {
        Self::with(Machine::best())
    }

    /// The same for every kind of arithmetic of this machine: all find the same windows.
    pub fn every() -> Vec<Self> {
        Machine::all().into_iter().map(Self::with).collect()
    }

    fn with(machine: Machine) -> Self {
        Self { machine, stack: Vec::with_capacity((STOREYS + 1) * LANES), frontier: Frontier::new(FRONTIER_CAPACITY) }
    }

    /// The nearest window of `index` to `query`, the lowest of equally near ones. `features` must be those of the
    /// index. `hint`, if it is one of the index's windows, is tried first.
    pub fn nearest(
        &mut self,
        index: &Index,
        features: &Features<'_>,
        query: &[f64],
        hint: Option<usize>,
        budget: Budget,
    ) -> SearchResult {
        let hint = hint.filter(|window| index.windows().contains(window));
        let task = Task { index, features, query, hint };
        match budget {
            Budget::Exact { eps } => self.machine.run(Exact { task, eps, stack: &mut self.stack }),
            Budget::Bounded { candidates } => {
                let candidates = candidates.max(Budget::LEAST);
                self.machine.run(Bounded { task, candidates, frontier: &mut self.frontier })
            }
        }
    }
}

/// The search's target.
#[derive(Clone, Copy)]
struct Task<'a> {
    index: &'a Index,
    features: &'a Features<'a>,
    query: &'a [f64],
    hint: Option<usize>,
}

/// Relative rounding of a bound computed in single precision, with margin.
const RELATIVE_ROUNDING: f64 = 8e-6;
/// Rounding of a bound relative to the lengths of the vectors it is computed from.
const LENGTH_ROUNDING: f64 = 8e-7;
/// Relative rounding of a distance summed in another order than the reference's.
const ORDER_ROUNDING: f64 = 1e-12;

/// Value for no group of leaves.
const NO_GROUP: u32 = u32::MAX;
/// A bound on a difference of lengths in single precision, rounded down.
const LENGTH_BOUND: f32 = 1.0 - 1e-6;

/// A search in progress.
struct Search<'a, L> {
    lanes: L,
    task: Task<'a>,
    projection: Projection,
    /// Length of the query, and for every shell a bound on the distance of its windows.
    bounds: [f32; SHELLS],
    /// Shells not yet entered, one bit each.
    left: u32,
    /// The shell that is searched, and the query's point in it.
    shell: &'a Shell,
    point: [f32; AXES_MAX],
    /// The group to whose frame the query was last converted.
    group: u32,
    coded: Coded,
    /// Largest result of `Lanes::closeness` for a window of the group within reach.
    closeness_limit: i32,
    /// Largest rounding error of a bound in the shell.
    rounding: f64,
    /// (1 + rounding) / (1 + eps).
    tightening: f64,
    best: f64,
    window: usize,
    /// Distance beyond which a bound rules a window out.
    reach: f32,
    compared: u32,
    /// Of a different width from the budget's counter: two counters written together and read separately cost more than
    /// the counting.
    compared_in_full: u64,
}

impl<'a, L: Lanes> Search<'a, L> {
    #[inline(always)]
    fn new(lanes: L, task: Task<'a>, eps: f64) -> Self {
        let projection = task.index.axes.begin(task.query);
        let length = task.query.iter().map(|x| x * x).sum::<f64>().sqrt() as f32;
        let shells = &task.index.shells;
        let mut bounds = [f32::INFINITY; SHELLS];
        for (bound, shell) in bounds.iter_mut().zip(shells) {
            let least = shell.bound(length) * LENGTH_BOUND - length * (1.0 - LENGTH_BOUND);
            // A length beyond single precision rules nothing out.
            *bound = if least.is_finite() { least } else { 0.0 };
        }
        let mut search = Self {
            lanes,
            task,
            projection,
            bounds,
            left: (1 << shells.len()) - 1,
            shell: &shells[0],
            point: [0.0; AXES_MAX],
            group: NO_GROUP,
            coded: Coded::new(),
            closeness_limit: i32::MAX,
            rounding: 0.0,
            tightening: (1.0 + RELATIVE_ROUNDING) / (1.0 + eps.max(0.0)),
            best: f64::INFINITY,
            window: task.index.first_window,
            reach: f32::INFINITY,
            compared: 0,
            compared_in_full: 0,
        };
        if let Some(hint) = task.hint {
            search.compare(hint);
        }
        search
    }

    /// Enters the shell whose windows may be nearest among those not yet entered; returns it and its bound.
    #[inline(always)]
    fn next_shell(&mut self) -> Option<(usize, f32)> {
        let (mut nearest, mut shell) = (f32::INFINITY, None);
        let mut left = self.left;
        while left != 0 {
            let at = left.trailing_zeros() as usize;
            left &= left - 1;
            if self.bounds[at] < nearest {
                (nearest, shell) = (self.bounds[at], Some(at));
            }
        }
        let shell = shell?;
        self.left &= !(1 << shell);
        self.enter(shell);
        Some((shell, nearest))
    }

    /// Postpones all shells not yet entered.
    #[inline(always)]
    fn postpone_shells(&mut self, frontier: &mut Frontier) {
        // The farthest first, because the latest one postponed is the next to be searched.
        while self.left != 0 {
            let (mut farthest, mut shell) = (f32::NEG_INFINITY, 0);
            let mut left = self.left;
            while left != 0 {
                let at = left.trailing_zeros() as usize;
                left &= left - 1;
                if self.bounds[at] >= farthest {
                    (farthest, shell) = (self.bounds[at], at);
                }
            }
            self.left &= !(1 << shell);
            let bound = farthest.max(0.0);
            frontier.push(bound * bound, (shell as u8, self.task.index.shells[shell].tree.root));
        }
    }

    /// Switches to another shell.
    #[inline(always)]
    fn enter(&mut self, shell: usize) {
        self.shell = &self.task.index.shells[shell];
        self.task.index.axes.extend(&mut self.projection, self.task.query, self.shell.axes);
        self.point = self.projection.point(self.shell.axes);
        self.rounding = LENGTH_ROUNDING * (self.projection.length + f64::from(self.shell.radius));
        self.group = NO_GROUP;
        self.set_reach();
    }

    #[inline(always)]
    fn set_reach(&mut self) {
        self.reach = (self.best.sqrt() * self.tightening + self.rounding) as f32;
        self.closeness_limit = self.coded.limit(self.reach);
    }

    /// Compares a window in full. Only if rounding might change the order does the reference's own arithmetic decide.
    #[inline(always)]
    fn compare(&mut self, window: usize) {
        self.compared += COMPARISON_COST;
        // The hint is met again in its place, and leaves that are not full repeat a window.
        if window == self.window && self.best < f64::INFINITY {
            return;
        }
        self.compared_in_full += 1;
        let Task { features, query, .. } = self.task;
        let distance = match features.in_place(window) {
            Some(feature) if features.unweighted => distance_in_any_order(self.lanes, feature, query),
            Some(feature) => weighted_distance_in_any_order(self.lanes, feature, features.weights, query),
            None => features.distance(window, query),
        };
        if distance > self.best * (1.0 + ORDER_ROUNDING) {
            return;
        }
        if distance >= self.best * (1.0 - ORDER_ROUNDING) && !is_nearer(&self.task, window, self.window) {
            return;
        }
        self.best = distance;
        self.window = window;
        self.set_reach();
    }

    /// Squared bound above which nothing can be nearer.
    #[inline(always)]
    fn limit(&self) -> f32 {
        self.reach * self.reach
    }

    #[inline(always)]
    fn visit_leaf(&mut self, leaf: usize) {
        self.compared += LEAF_COST;
        let tree = &self.shell.tree;
        let leaf = tree.leaf(leaf);
        if leaf.group != self.group {
            self.group = leaf.group;
            self.coded.set(self.lanes, tree.frame(leaf.group), &self.point);
            self.closeness_limit = self.coded.limit(self.reach);
        }
        let ([codes, other_codes], [squares, other_squares]) = (leaf.codes, leaf.squares);
        let (steps, other_steps) = self.coded.steps.split_at(codes.len());
        let mut closeness = self.lanes.closeness(codes, steps, self.lanes.load_integers(squares));
        if !other_codes.is_empty() {
            if self.lanes.at_most(closeness, self.coded.first_limit(self.closeness_limit)) == 0 {
                return;
            }
            let squares = self.lanes.add_integers(closeness, self.lanes.load_integers(other_squares));
            closeness = self.lanes.closeness(other_codes, other_steps, squares);
        }
        let mut within = self.lanes.at_most(closeness, self.closeness_limit);
        if within == 0 {
            return;
        }
        let closeness = self.lanes.integers(closeness);
        // A single window is compared at once: only others have time to arrive from memory meanwhile.
        if within & (within - 1) != 0 {
            self.prefetch(leaf.windows, within);
        }
        while within != 0 {
            // The nearest first: it rules out others.
            let (mut nearest, mut rest) = (within.trailing_zeros() as usize, within & (within - 1));
            while rest != 0 {
                let lane = rest.trailing_zeros() as usize;
                rest &= rest - 1;
                if closeness[lane] < closeness[nearest] {
                    nearest = lane;
                }
            }
            if closeness[nearest] > self.closeness_limit {
                return;
            }
            within &= !(1 << nearest);
            self.compare(leaf.windows[nearest] as usize);
        }
    }

    /// Prefetches the samples of a leaf's windows that will be compared.
    #[inline(always)]
    fn prefetch(&self, windows: &[u32; LANES], mut within: u32) {
        while within != 0 {
            let window = windows[within.trailing_zeros() as usize] as usize;
            within &= within - 1;
            if let Some([causal, coarse]) = self.task.features.in_place(window) {
                self.lanes.prefetch(causal);
                self.lanes.prefetch(coarse);
            }
        }
    }

    /// Passes every child of `node` that may contain something nearer to `found`, with its bound.
    #[inline(always)]
    fn visit_node(&mut self, node: usize, mut found: impl FnMut(f32, Child)) {
        self.compared += LANES as u32;
        let node = self.shell.tree.node(node);
        let (mut within, bounds) = box_bounds(self.lanes, node.faces, &self.point, self.limit());
        if within == 0 {
            return;
        }
        let bounds = self.lanes.array(bounds);
        while within != 0 {
            let lane = within.trailing_zeros() as usize;
            within &= within - 1;
            if node.children[lane] == Child::NONE {
                break;
            }
            found(bounds[lane], node.children[lane]);
        }
    }

    #[inline(always)]
    fn answer(&self) -> SearchResult {
        SearchResult { window: self.window, compared: self.compared, compared_in_full: self.compared_in_full as u32 }
    }
}

/// True if `new` is nearer than `old`, or as near and lower.
#[cold]
#[inline(never)]
fn is_nearer(Task { features, query, .. }: &Task<'_>, new: usize, old: usize) -> bool {
    let (distance, best) = (features.distance(new, query), features.distance(old, query));
    distance < best || distance == best && new < old
}

/// Squared distance of a feature's halves to `query`.
#[inline(always)]
fn distance_in_any_order<L: Lanes>(lanes: L, [causal, coarse]: [&[f64]; 2], query: &[f64]) -> f64 {
    let (query_causal, query_coarse) = query.split_at(causal.len());
    let mut sums = lanes.zeros();
    let mut rest = 0.0;
    for (xs, qs) in [(causal, query_causal), (coarse, query_coarse)] {
        let ((xs, last_xs), (qs, last_qs)) = (xs.as_chunks::<8>(), qs.as_chunks::<8>());
        for (x, q) in xs.iter().zip(qs) {
            sums = lanes.add_square(x, q, sums);
        }
        for (x, q) in last_xs.iter().zip(last_qs) {
            rest += (x - q) * (x - q);
        }
    }
    rest + lanes.sum(sums)
}

/// The same for a feature that is still to be weighted.
#[inline(always)]
fn weighted_distance_in_any_order<L: Lanes>(
    lanes: L,
    [causal, coarse]: [&[f64]; 2],
    weights: &[f64],
    query: &[f64],
) -> f64 {
    let (query_causal, query_coarse) = query.split_at(causal.len());
    let (weights_causal, weights_coarse) = weights.split_at(causal.len());
    let mut sums = lanes.zeros();
    let mut rest = 0.0;
    for (xs, weights, qs) in [(causal, weights_causal, query_causal), (coarse, weights_coarse, query_coarse)] {
        let ((xs, last_xs), (qs, last_qs)) = (xs.as_chunks::<8>(), qs.as_chunks::<8>());
        let (weights, last_weights) = weights.as_chunks::<8>();
        for ((x, weight), q) in xs.iter().zip(weights).zip(qs) {
            sums = lanes.add_weighted_square(x, weight, q, sums);
        }
        for ((x, weight), q) in last_xs.iter().zip(last_weights).zip(last_qs) {
            let difference = x * weight - q;
            rest += difference * difference;
        }
    }
    rest + lanes.sum(sums)
}

/// Depth first, nearest child first.
struct Exact<'a> {
    task: Task<'a>,
    eps: f64,
    stack: &'a mut Vec<(f32, Child)>,
}

impl Work for Exact<'_> {
    type Output = SearchResult;

    #[inline(always)]
    fn with<L: Lanes>(self, lanes: L) -> SearchResult {
        let mut search = Search::new(lanes, self.task, self.eps);
        let stack = self.stack;
        while let Some((_, bound)) = search.next_shell()
            && bound <= search.reach
        {
            let tree = &search.shell.tree;
            stack.clear();
            stack.push((0.0, tree.root));
            while let Some((bound, child)) = stack.pop() {
                if bound > search.limit() {
                    continue;
                }
                match child.kind() {
                    NodeKind::Leaf(leaf) => search.visit_leaf(leaf),
                    NodeKind::Node(node) => {
                        let (mut nearest, mut at) = (f32::INFINITY, usize::MAX);
                        search.visit_node(node, |bound, child| {
                            stack.push((bound, child));
                            tree.prefetch(lanes, child);
                            if bound < nearest {
                                nearest = bound;
                                at = stack.len() - 1;
                            }
                        });
                        if at < stack.len() {
                            let last = stack.len() - 1;
                            stack.swap(at, last);
                        }
                    }
                }
            }
        }
        search.answer()
    }
}

/// Best-first search, until the allowed work is done. It goes from each box straight on to the nearest box in it, down to
/// a leaf, and continues with the nearest of all postponed boxes. Finding that one costs more than it saves if the search
/// will finish anyway, as nearly all do, so for the first half of the work the latest postponed box is used instead.
struct Bounded<'a> {
    task: Task<'a>,
    candidates: u32,
    frontier: &'a mut Frontier,
}

impl Work for Bounded<'_> {
    type Output = SearchResult;

    #[inline(always)]
    fn with<L: Lanes>(self, lanes: L) -> SearchResult {
        let mut search = Search::new(lanes, self.task, 0.0);
        let frontier = self.frontier;
        frontier.clear();
        // The first shell is entered regardless of its bound, so that something is found.
        let (mut shell, _) = search.next_shell().unwrap_or_default();
        search.postpone_shells(frontier);
        let mut next = search.shell.tree.root;
        loop {
            let mut nearest = (f32::INFINITY, Child::NONE);
            let tree = &search.shell.tree;
            match next.kind() {
                NodeKind::Leaf(leaf) => search.visit_leaf(leaf),
                NodeKind::Node(node) => search.visit_node(node, |bound, child| {
                    tree.prefetch(lanes, child);
                    let mut farther = (bound, child);
                    if bound < nearest.0 {
                        std::mem::swap(&mut nearest, &mut farther);
                    }
                    if farther.1 != Child::NONE {
                        frontier.push(farther.0, (shell as u8, farther.1));
                    }
                }),
            }
            // The descent to the first leaf fits any budget, so something has been found by now.
            if search.compared + LEAF_COST_MAX > self.candidates {
                break;
            }
            next = nearest.1;
            if next == Child::NONE {
                let within = search.limit();
                let easy = search.compared < self.candidates / 2;
                let left = if easy { frontier.pop_latest(within) } else { frontier.pop_nearest(within) };
                let Some((_, (of_shell, child))) = left else { break };
                if usize::from(of_shell) != shell {
                    shell = usize::from(of_shell);
                    search.enter(shell);
                }
                next = child;
            }
        }
        search.answer()
    }
}
