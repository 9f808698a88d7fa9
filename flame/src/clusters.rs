//! The separate flames of a simulation: the connected parts of its front, followed from step to step.
//!
//! ```text
//! step ─ parts of the front ─ overlap with the step before ─ tracks ─ hand-over ─ one series of flux each
//! ```
//!
//! A part continues as the part of the next step that overlaps it most, otherwise as the nearest one. The remaining
//! parts begin or end there. The series add up to the flux of the whole.

use std::collections::{BTreeMap, BTreeSet};

use crate::front::Cluster;

/// Farthest move of a part in one step without overlap, in sums of both steps' radii.
const REACH: f64 = 2.0;

/// Beginning of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Birth {
    /// Present from the first step.
    Start,
    /// Nothing burned there before.
    Ignited,
    /// Split off another track.
    Split(usize),
}

/// End of a track.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Death {
    /// Present until the last step.
    End,
    /// Nothing burns there any more.
    Extinguished,
    /// Merged into another track.
    Merged(usize),
}

/// One step of a track, in world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Velocity flux, volume per second.
    pub flux: f64,
    /// Area of the front.
    pub area: f64,
    /// Mean position of the front.
    pub centroid: [f64; 3],
}

/// One flame from its first step to its last. Tracks are counted from 0 in the order of their first steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// Its steps.
    pub points: BTreeMap<i64, Point>,
    /// Its beginning.
    pub birth: Birth,
    /// Its end.
    pub death: Death,
}

impl Track {
    /// Sum of all changes of its flux, up and down: a measure of its audibility.
    pub fn variation(&self) -> f64 {
        let fluxes = || self.points.values().map(|point| point.flux);
        fluxes().zip(fluxes().skip(1)).map(|(before, after)| (after - before).abs()).sum()
    }
}

/// Follows parts of a front from step to step.
#[derive(Debug, Clone, Default)]
pub struct Tracker {
    tracks: Vec<Track>,
    /// Parts of the last step with their tracks.
    last: Vec<(usize, Cluster)>,
    has_begun: bool,
}

impl Tracker {
    /// Adds the parts of a step; steps must ascend.
    pub fn add(&mut self, step: i64, clusters: Vec<Cluster>) {
        let overlaps = overlaps(&self.last, &clusters);
        let mut tracks = self.continued(&clusters, &overlaps);
        // An unclaimed part was split off the previous step's part that it overlaps most.
        for (now, track) in tracks.iter_mut().enumerate().filter(|(_, track)| track.is_none()) {
            let origin = strongest(&overlaps, |(before, other)| (*other == now).then_some(*before));
            let birth = match origin {
                _ if !self.has_begun => Birth::Start,
                Some(before) => Birth::Split(self.last[before].0),
                None => Birth::Ignited,
            };
            *track = Some(self.tracks.len());
            self.tracks.push(Track { points: BTreeMap::new(), birth, death: Death::End });
        }
        let tracks: Vec<usize> = tracks.into_iter().flatten().collect();
        let alive: BTreeSet<usize> = tracks.iter().copied().collect();
        for (before, (track, _)) in self.last.iter().enumerate().filter(|(_, (track, _))| !alive.contains(track)) {
            let heir = strongest(&overlaps, |(other, now)| (*other == before).then_some(*now));
            self.tracks[*track].death = heir.map_or(Death::Extinguished, |now| Death::Merged(tracks[now]));
        }
        for (track, Cluster { flux, area, centroid, .. }) in tracks.iter().zip(&clusters) {
            let point = Point { flux: *flux, area: *area, centroid: *centroid };
            self.tracks[*track].points.insert(step, point);
        }
        self.last = tracks.into_iter().zip(clusters).collect();
        self.has_begun = true;
    }

    /// The tracks so far.
    pub fn finish(self) -> Vec<Track> {
        self.tracks
    }

    /// The track that continues in each part, if any.
    fn continued(&self, clusters: &[Cluster], overlaps: &BTreeMap<(usize, usize), f64>) -> Vec<Option<usize>> {
        let mut pairs: Vec<((usize, usize), f64)> = overlaps.iter().map(|(pair, shared)| (*pair, -shared)).collect();
        let overlapping: BTreeSet<usize> = overlaps.keys().map(|(before, _)| *before).collect();
        let mut far = vec![];
        for (before, (_, old)) in self.last.iter().enumerate().filter(|(before, _)| !overlapping.contains(before)) {
            for (now, new) in clusters.iter().enumerate() {
                let away =
                    (0..3).map(|axis| maths::square(new.centroid[axis] - old.centroid[axis])).sum::<f64>().sqrt();
                if away <= REACH * (old.radius() + new.radius()) {
                    far.push(((before, now), away));
                }
            }
        }
        // Largest overlap first, then the nearest of the parts without overlap.
        pairs.sort_by(|a, b| a.1.total_cmp(&b.1));
        far.sort_by(|a, b| a.1.total_cmp(&b.1));
        let mut tracks = vec![None; clusters.len()];
        let mut is_claimed = vec![false; self.last.len()];
        for ((before, now), _) in pairs.into_iter().chain(far) {
            if !is_claimed[before] && tracks[now].is_none() {
                is_claimed[before] = true;
                tracks[now] = Some(self.last[before].0);
            }
        }
        tracks
    }
}

/// Area that parts of two steps share in the same cubes of space: in each cube, the smaller of the two.
fn overlaps(last: &[(usize, Cluster)], clusters: &[Cluster]) -> BTreeMap<(usize, usize), f64> {
    let mut there: BTreeMap<[i64; 3], Vec<(usize, f64)>> = BTreeMap::new();
    for (before, (_, cluster)) in last.iter().enumerate() {
        for (cube, area) in &cluster.cubes {
            there.entry(*cube).or_default().push((before, *area));
        }
    }
    let mut overlaps = BTreeMap::new();
    for (now, cluster) in clusters.iter().enumerate() {
        for (cube, area) in &cluster.cubes {
            for (before, other) in there.get(cube).into_iter().flatten() {
                *overlaps.entry((*before, now)).or_insert(0.0) += area.min(*other);
            }
        }
    }
    overlaps
}

/// The result of `pick` for the pair with the largest overlap, among the pairs for which there is one.
fn strongest(
    overlaps: &BTreeMap<(usize, usize), f64>,
    pick: impl Fn(&(usize, usize)) -> Option<usize>,
) -> Option<usize> {
    let found = overlaps.iter().filter_map(|(pair, shared)| Some((pick(pair)?, shared)));
    found.max_by(|a, b| a.1.total_cmp(b.1)).map(|(picked, _)| picked)
}

/// Flux of every track at its own steps and, during a hand-over, at those of the track that it was split off or merges
/// into. A part's whole flux would appear at once where a front splits, with a click, so it passes gradually over
/// `handover` steps. The sum over all tracks is that of their points.
pub fn series(tracks: &[Track], handover: u64) -> Vec<BTreeMap<i64, f64>> {
    let mut series = vec![BTreeMap::new(); tracks.len()];
    let mut give = |track: usize, step: i64, flux: f64| {
        if let Some(series) = series.get_mut(track) {
            *series.entry(step).or_insert(0.0) += flux;
        }
    };
    for (own, track) in tracks.iter().enumerate() {
        let (Some(first), Some(last)) = (track.points.keys().next(), track.points.keys().next_back()) else { continue };
        // Without hand-over steps, all of it belongs to the track itself at once.
        let share = |steps: u64| ((steps as f64 + 1.0) / (handover as f64 + 1.0)).min(1.0);
        for (step, Point { flux, .. }) in &track.points {
            let mut kept = *flux;
            if let Birth::Split(parent) = track.birth {
                let passed = (1.0 - share(step.abs_diff(*first))) * kept;
                give(parent, *step, passed);
                kept -= passed;
            }
            if let Death::Merged(heir) = track.death {
                let passed = (1.0 - share(step.abs_diff(*last))) * kept;
                give(heir, *step, passed);
                kept -= passed;
            }
            give(own, *step, kept);
        }
    }
    series
}
