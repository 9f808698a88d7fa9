//! The connected parts of a flame front, each measured separately.

use std::collections::{BTreeMap, HashMap};

use super::measure::{Front, apply, area_vector};
use crate::error::Error;
use crate::frame::Frame;
use crate::grid::{cross, dot, length};
use crate::velocity::Probe;

/// Edge in voxels of the cubes that detect overlap between parts of successive steps: a front is a thin shell, and
/// moves by more than a voxel from step to step.
const CUBE_VOXELS: f64 = 4.0;

/// Relative rounding error of the net flux through a part, if as much flows in as out.
const ROUNDING: f64 = 1e-9;

/// A connected part of a front at one step, in world units.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Cluster {
    /// Velocity flux through the part, volume per second.
    pub flux: f64,
    /// The part's area.
    pub area: f64,
    /// Mean position of its surface, weighted by area.
    pub centroid: [f64; 3],
    /// Cubes of space that it passes through, with its area in each.
    pub(crate) cubes: BTreeMap<[i64; 3], f64>,
}

impl Cluster {
    /// Radius of the ball with the same area.
    pub(crate) fn radius(&self) -> f64 {
        (self.area / (4.0 * std::f64::consts::PI)).sqrt()
    }
}

/// Sums over a closed surface, collected during the walk.
struct Sums {
    /// The cluster; its centroid is not divided by the area yet.
    cluster: Cluster,
    passing: f64,
    /// Enclosed volume in voxels; negative for the wall of a hollow.
    volume: f64,
    /// A corner, the origin of the volume's sum.
    origin: [f64; 3],
    /// Lowest and highest index of its corners.
    bounds: [[f64; 3]; 2],
}

impl Front {
    /// The front's connected parts, largest first. Triangles that share a corner belong together, and hollows belong to
    /// the flame around them. The sums of fluxes and areas are those of
    /// [`measure`](Self::measure), if the subdivision is fixed.
    ///
    /// # Errors
    /// As [`measure`](Self::measure), and beyond 2^32 corners.
    pub fn clusters(&self, frame: &Frame) -> Result<Vec<Cluster>, Error> {
        if !frame.velocity.is_finite() {
            return Err(Error::NotFinite { what: "velocity" });
        }
        let mut corners = HashMap::new();
        let mut groups = Groups::default();
        let mut triangles = vec![];
        self.walk(&frame.field, |_, triangle, _| {
            let [a, b, c] = triangle.map(|corner| *corners.entry(corner.place).or_insert_with(|| groups.add()));
            groups.join(a, b);
            groups.join(b, c);
            triangles.push((a, triangle.map(|corner| corner.index)));
        })?;
        let transform = frame.field.transform();
        let sign = if transform.is_mirrored() { -1.0 } else { 1.0 };
        let cofactors = transform.cofactors().map(|row| row.map(|part| sign * part));
        let cube = CUBE_VOXELS * transform.voxel_edges().into_iter().fold(0.0, f64::max);
        let mut velocity = Probe::new(&frame.velocity, transform);
        let mut sums: BTreeMap<usize, Sums> = BTreeMap::new();
        for (corner, indices) in triangles {
            let surface = apply(area_vector(&indices), &cofactors);
            let centre = std::array::from_fn(|axis| indices.iter().map(|index| index[axis]).sum::<f64>() / 3.0);
            let flux = dot(velocity.velocity_at(centre), surface);
            let (area, middle) = (length(surface), transform.to_world(centre));
            let sums = sums.entry(groups.first_of(corner)).or_insert_with(|| Sums::at_corner(indices[0]));
            sums.enclose(&indices);
            sums.passing += flux.abs();
            sums.cluster.flux += flux;
            sums.cluster.area += area;
            (0..3).for_each(|axis| sums.cluster.centroid[axis] += area * middle[axis]);
            *sums.cluster.cubes.entry(middle.map(|x| (x / cube).floor() as i64)).or_default() += area;
        }
        let mut clusters: Vec<Cluster> =
            with_hollows(sums.into_values()).into_iter().filter_map(Sums::finished).collect();
        if clusters.iter().any(|cluster| !(cluster.flux.is_finite() && cluster.area.is_finite())) {
            return Err(Error::NotFinite { what: "flux" });
        }
        // Stable sort: among equals the order of the walk decides, which depends on the field alone.
        clusters.sort_by(|a, b| b.area.total_cmp(&a.area));
        Ok(clusters)
    }
}

/// Joins flames with the walls of their hollows: a flame is often a shell around fuel that does not burn yet.
fn with_hollows(sums: impl Iterator<Item = Sums>) -> Vec<Sums> {
    let (mut outer, hollows): (Vec<Sums>, Vec<Sums>) = sums.partition(|sums| sums.volume >= 0.0);
    let mut homeless = vec![];
    for hollow in hollows {
        // Inside several flames, a hollow belongs to the innermost.
        let around = outer.iter_mut().filter(|sums| sums.surrounds(&hollow));
        match around.min_by(|a, b| a.volume.total_cmp(&b.volume)) {
            Some(flame) => flame.add(hollow),
            None => homeless.push(hollow),
        }
    }
    outer.extend(homeless);
    outer
}

impl Sums {
    /// Empty sums, at a corner.
    fn at_corner(index: [f64; 3]) -> Self {
        Self { cluster: Cluster::default(), passing: 0.0, volume: 0.0, origin: index, bounds: [index; 2] }
    }

    /// Adds the volume between the first corner and a triangle.
    fn enclose(&mut self, triangle: &[[f64; 3]; 3]) {
        let [a, b, c] = triangle.map(|index| std::array::from_fn(|axis| index[axis] - self.origin[axis]));
        self.volume += dot(a, cross(b, c)) / 6.0;
        for index in triangle {
            for (axis, x) in index.iter().enumerate() {
                self.bounds[0][axis] = self.bounds[0][axis].min(*x);
                self.bounds[1][axis] = self.bounds[1][axis].max(*x);
            }
        }
    }

    fn surrounds(&self, other: &Self) -> bool {
        (0..3)
            .all(|axis| self.bounds[0][axis] <= other.bounds[0][axis] && other.bounds[1][axis] <= self.bounds[1][axis])
    }

    fn add(&mut self, other: Self) {
        self.passing += other.passing;
        self.cluster.flux += other.cluster.flux;
        self.cluster.area += other.cluster.area;
        (0..3).for_each(|axis| self.cluster.centroid[axis] += other.cluster.centroid[axis]);
        for (cube, area) in other.cluster.cubes {
            *self.cluster.cubes.entry(cube).or_default() += area;
        }
    }

    /// The finished part; none without area, since it has no position.
    fn finished(self) -> Option<Cluster> {
        let Self { mut cluster, passing, .. } = self;
        if cluster.flux.abs() <= ROUNDING * passing {
            cluster.flux = 0.0;
        }
        cluster.centroid = cluster.centroid.map(|sum| sum / cluster.area);
        (cluster.area != 0.0).then_some(cluster)
    }
}

/// Disjoint groups of numbers, each represented by one of its members (union-find with path halving).
#[derive(Default)]
struct Groups {
    above: Vec<usize>,
}

impl Groups {
    /// Adds a new number in its own group.
    fn add(&mut self) -> usize {
        self.above.push(self.above.len());
        self.above.len() - 1
    }

    fn first_of(&mut self, mut member: usize) -> usize {
        while self.above[member] != member {
            self.above[member] = self.above[self.above[member]];
            member = self.above[member];
        }
        member
    }

    /// The lower number represents both, so that groups are ordered as in the walk.
    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first_of(a), self.first_of(b));
        self.above[a.max(b)] = a.min(b);
    }
}
