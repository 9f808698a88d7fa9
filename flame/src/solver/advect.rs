//! Advection: transport of quantities by the flow (MacCormack's scheme, limited; Selle, Fedkiw, Kim, Liu & Rossignac
//! 2008).

use rayon::prelude::*;

use super::activity::{Activity, SEGMENT};
use super::domain::{Domain, FaceRow, Side, cell_index};
use super::lattice::{LANES, Lattice, Positions};
use super::parallel::{largest, planes, wide};

/// Displacement of the gas at every centre in one step, backwards and forwards, in cells.
#[derive(Debug, Default)]
pub(crate) struct Trajectories {
    velocity: Vec<[f32; 4]>,
    came: Vec<[f32; 4]>,
    goes: Vec<[f32; 4]>,
}

/// Regions that need little or no accuracy in advection.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Neglect<'a> {
    /// If present, everything outside it keeps the value of the outside air.
    pub activity: Option<&'a Activity>,
    /// Differences between neighbouring samples below which their mean is accurate enough.
    pub difference: f32,
}

impl Trajectories {
    /// Longest path along any axis in cells, at least 0.
    pub fn longest(&self) -> f32 {
        largest(self.came.as_flattened()).max(largest(self.goes.as_flattened()))
    }

    /// Traces `velocity` (at the centres) over a step in which a speed of 1 crosses `cells_per_speed` cells: midpoint
    /// rule, in both directions.
    pub fn trace(&mut self, domain: &Domain, velocity: &[[f32; 4]], cells_per_speed: f32) {
        let lattice = Lattice::centres(domain);
        let [_, ny, nz] = domain.shape();
        let Self { velocity: scaled, came, goes } = self;
        scaled.clear();
        scaled.extend(velocity.iter().map(|value| value.map(|v| v * cells_per_speed)));
        came.resize(scaled.len(), [0.0; 4]);
        goes.resize(scaled.len(), [0.0; 4]);
        let scaled = scaled.as_slice();
        planes(came, ny * nz).zip(planes(goes, ny * nz)).enumerate().for_each(|(i, (came, goes))| {
            wide(|| {
                for (j, (came, goes)) in came.chunks_exact_mut(nz).zip(goes.chunks_exact_mut(nz)).enumerate() {
                    let row = cell_index(domain.shape(), i, j, 0);
                    let parts = came.chunks_mut(LANES).zip(goes.chunks_mut(LANES));
                    for (part, (came, goes)) in parts.enumerate() {
                        let first = part * LANES;
                        let here = &scaled[row + first..][..came.len()];
                        let half = positions(here.len(), |lane| {
                            let position = lattice.position(i, j, first + lane);
                            std::array::from_fn(|axis| position[axis] - 0.5 * here[lane][axis])
                        });
                        let found = lattice.sample_lanes(scaled, &half);
                        for (((came, goes), here), found) in came.iter_mut().zip(goes).zip(here).zip(found) {
                            *came = found;
                            // The midpoint rule the other way, to the same order: half a step on, the flow is as much
                            // faster than here as it was slower half a step back.
                            *goes = std::array::from_fn(|axis| 2.0 * here[axis] - found[axis]);
                        }
                    }
                }
            })
        });
    }
}

/// Positions of up to [`LANES`] samples; unused lanes repeat the last one.
#[inline(always)]
fn positions(count: usize, of: impl Fn(usize) -> [f32; 3]) -> Positions {
    let mut lanes = [[0.0; LANES]; 3];
    for lane in 0..LANES {
        for (lanes, coordinate) in lanes.iter_mut().zip(of(lane.min(count - 1))) {
            lanes[lane] = coordinate;
        }
    }
    lanes
}

/// Position of samples relative to the cells whose trajectories they share.
#[derive(Debug, Clone, Copy)]
pub(crate) enum SampleSite {
    /// At the centres.
    Centres,
    /// Between two cells along an axis.
    Faces(usize),
}

/// Working memory of one advection.
#[derive(Debug, Default)]
pub(crate) struct Scratch<const N: usize> {
    carried: Vec<[f32; N]>,
    ranges: Vec<[[f32; N]; 2]>,
    before: Vec<[f32; N]>,
}

/// Advects `field` along its paths. A value from beyond an end of the box is the one given in `entering`, if any;
/// otherwise that at the end.
pub(crate) fn advect<const N: usize>(
    field: &mut [[f32; N]],
    domain: &Domain,
    site: SampleSite,
    paths: &Trajectories,
    entering: &InflowBoundary<N>,
    neglect: Neglect,
    scratch: &mut Scratch<N>,
) {
    let lattice = match site {
        SampleSite::Centres => Lattice::centres(domain),
        SampleSite::Faces(axis) => Lattice::faces(domain, axis),
    };
    let [_, ny, nz] = lattice.shape;
    let plane = ny * nz;
    let Scratch { carried, ranges, before } = scratch;
    carried.resize(field.len(), [0.0; N]);
    ranges.resize(field.len(), [[0.0; N]; 2]);
    before.clear();
    before.extend_from_slice(field);
    let before = before.as_slice();
    let advection = Advection { domain, site, lattice, paths, entering, neglect };

    planes(carried, plane).zip(planes(ranges, plane)).enumerate().for_each(|(i, (carried, ranges))| {
        wide(|| {
            for (j, (carried, ranges)) in carried.chunks_exact_mut(nz).zip(ranges.chunks_exact_mut(nz)).enumerate() {
                advection.predict_row(before, [i, j], carried, ranges);
            }
        })
    });
    let (carried, ranges) = (carried.as_slice(), ranges.as_slice());
    planes(field, plane).enumerate().for_each(|(i, field)| {
        wide(|| {
            for (j, field) in field.chunks_exact_mut(nz).enumerate() {
                advection.correct_row(carried, ranges, [i, j], field);
            }
        })
    });
}

/// One advection: everything that its rows share.
struct Advection<'a, const N: usize> {
    domain: &'a Domain,
    site: SampleSite,
    lattice: Lattice,
    paths: &'a Trajectories,
    entering: &'a InflowBoundary<N>,
    neglect: Neglect<'a>,
}

// Rows are inlined into `wide`, which compiles them for the machine's widest vectors.
impl<const N: usize> Advection<'_, N> {
    /// Writes what the flow has carried to a row of samples, and the range of the values around each one's origin.
    #[inline(always)]
    fn predict_row(
        &self,
        before: &[[f32; N]],
        [i, j]: [usize; 2],
        carried: &mut [[f32; N]],
        ranges: &mut [[[f32; N]; 2]],
    ) {
        let row = PathRow::new(self.domain, self.site, i, j);
        let busy = self.neglect.activity.map(|activity| activity.row(i, j));
        for (part, (carried, ranges)) in carried.chunks_mut(LANES).zip(ranges.chunks_mut(LANES)).enumerate() {
            if busy.is_some_and(|busy| !busy[part]) {
                carried.fill(self.entering.value);
                ranges.fill([self.entering.value; 2]);
                continue;
            }
            let first = part * LANES;
            let departures = positions(carried.len(), |lane| {
                let position = self.lattice.position(i, j, first + lane);
                let path = row.path(&self.paths.came, first + lane);
                std::array::from_fn(|axis| position[axis] - path[axis])
            });
            let (found, [low, high]) = self.lattice.sample_lanes_with_range(before, &departures);
            let outside = self.entering.comes_in(&departures);
            for (lane, (carried, range)) in carried.iter_mut().zip(ranges).enumerate() {
                (*carried, *range) = if outside[lane] {
                    (self.entering.value, [self.entering.value; 2])
                } else {
                    (found[lane], [low[lane], high[lane]])
                };
            }
        }
    }

    /// Writes a row of the result: what was carried there, less half of the error of a step forwards and back.
    #[inline(always)]
    fn correct_row(&self, carried: &[[f32; N]], ranges: &[[[f32; N]; 2]], [i, j]: [usize; 2], field: &mut [[f32; N]]) {
        let row = PathRow::new(self.domain, self.site, i, j);
        let start = cell_index(self.lattice.shape, i, j, 0);
        let is_even = |[low, high]: &[[f32; N]; 2]| (0..N).all(|n| high[n] - low[n] <= self.neglect.difference);
        for (part, values) in field.chunks_mut(LANES).enumerate() {
            let first = part * LANES;
            let here = start + first..start + first + values.len();
            let (firsts, ranges) = (&carried[here.clone()], &ranges[here]);
            if ranges.iter().all(is_even) {
                values.copy_from_slice(firsts);
                continue;
            }
            let arrivals = positions(values.len(), |lane| {
                let position = self.lattice.position(i, j, first + lane);
                let path = row.path(&self.paths.goes, first + lane);
                std::array::from_fn(|axis| position[axis] + path[axis])
            });
            let back = self.lattice.sample_lanes(carried, &arrivals);
            for (lane, (value, first)) in values.iter_mut().zip(firsts).enumerate() {
                let [low, high] = &ranges[lane];
                *value = if is_even(&ranges[lane]) {
                    *first
                } else {
                    // Limited, so that no new extremes arise.
                    std::array::from_fn(|n| (first[n] + 0.5 * (value[n] - back[lane][n])).max(low[n]).min(high[n]))
                };
            }
        }
    }
}

/// Segments are processed as a whole.
const _: () = assert!(SEGMENT == LANES);

/// Paths of a row of samples: each that of its cell, or the mean of those of the cells on both sides.
enum PathRow {
    Centres(usize),
    Faces(FaceRow),
}

impl PathRow {
    #[inline(always)]
    fn new(domain: &Domain, site: SampleSite, i: usize, j: usize) -> Self {
        match site {
            SampleSite::Centres => Self::Centres(cell_index(domain.shape(), i, j, 0)),
            SampleSite::Faces(axis) => Self::Faces(domain.face_row(axis, i, j)),
        }
    }

    #[inline(always)]
    fn path(&self, paths: &[[f32; 4]], k: usize) -> [f32; 3] {
        match self {
            Self::Centres(row) => {
                let [x, y, z, _] = paths[row + k];
                [x, y, z]
            }
            Self::Faces(row) => {
                let (before, after) = row.cells(k);
                let (before, after) = (paths[before], paths[after]);
                std::array::from_fn(|axis| 0.5 * (before[axis] + after[axis]))
            }
        }
    }
}

/// Inflow at the ends of the box.
#[derive(Debug, Clone)]
pub(crate) struct InflowBoundary<const N: usize> {
    /// Positions in cells beyond which samples come from outside.
    low: [f32; 3],
    high: [f32; 3],
    value: [f32; N],
}

impl<const N: usize> InflowBoundary<N> {
    /// The boundary at which `value` enters through those sides that let it in, and nothing through the others.
    pub fn from_sides(domain: &Domain, value: [f32; N], lets_in: impl Fn(Side) -> bool) -> Self {
        let sides = domain.sides();
        Self {
            low: std::array::from_fn(|axis| if lets_in(sides[axis][0]) { -0.5 } else { f32::NEG_INFINITY }),
            high: std::array::from_fn(|axis| {
                if lets_in(sides[axis][1]) { domain.shape()[axis] as f32 - 0.5 } else { f32::INFINITY }
            }),
            value,
        }
    }

    /// True for positions outside the box from which gas flows in.
    #[inline(always)]
    fn comes_in(&self, positions: &Positions) -> [bool; LANES] {
        let mut outside = [false; LANES];
        for (positions, (low, high)) in positions.iter().zip(self.low.iter().zip(&self.high)) {
            for (outside, position) in outside.iter_mut().zip(positions) {
                *outside |= position < low || position > high;
            }
        }
        outside
    }
}
