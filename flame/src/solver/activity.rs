//! Active regions: most of a flame's box is ambient air, which needs no advection.

use rayon::prelude::*;

use super::domain::Domain;
use super::parallel::planes;

/// Cells of a segment, along z.
pub(crate) const SEGMENT: usize = 8;

/// Segments of a box that contain anything but ambient air, or may do so within a step.
#[derive(Debug, Default)]
pub(crate) struct Activity {
    rows: usize,
    segments: usize,
    busy: Vec<bool>,
    before: Vec<bool>,
}

impl Activity {
    /// Finds everything that is not `ambient`, and everything within `reach` cells of it.
    pub fn update(&mut self, domain: &Domain, scalars: &[[f32; 4]], ambient: [f32; 4], reach: usize) {
        let [nx, ny, nz] = domain.shape();
        (self.rows, self.segments) = (ny, nz.div_ceil(SEGMENT));
        let plane = ny * self.segments;
        self.busy.resize(nx * plane, false);
        planes(&mut self.busy, plane).zip(scalars.par_chunks(ny * nz)).for_each(|(busy, scalars)| {
            for (busy, row) in busy.chunks_exact_mut(self.segments).zip(scalars.chunks_exact(nz)) {
                for (busy, segment) in busy.iter_mut().zip(row.chunks(SEGMENT)) {
                    *busy = segment.iter().any(|scalar| *scalar != ambient);
                }
            }
        });
        self.widen([nx, ny, self.segments], [reach, reach, reach.div_ceil(SEGMENT)], domain);
    }

    /// Extends the busy region by `reach`, axis by axis.
    fn widen(&mut self, shape: [usize; 3], reach: [usize; 3], domain: &Domain) {
        let strides = [shape[1] * shape[2], shape[2], 1];
        for axis in 0..3 {
            self.before.clone_from(&self.busy);
            let (size, stride) = (shape[axis], strides[axis]);
            let reach = reach[axis].min(size);
            for index in (0..self.before.len()).filter(|index| self.before[*index]) {
                let at = index / stride % size;
                let first = index - at * stride;
                if domain.is_periodic(axis) {
                    (at + size - reach..=at + size + reach)
                        .for_each(|other| self.busy[first + other % size * stride] = true);
                } else {
                    let others = at.saturating_sub(reach)..=(at + reach).min(size - 1);
                    others.for_each(|other| self.busy[first + other * stride] = true);
                }
            }
        }
    }

    /// True for each busy segment of row (i, j).
    #[inline(always)]
    pub fn row(&self, i: usize, j: usize) -> &[bool] {
        let start = (i * self.rows + j) * self.segments;
        &self.busy[start..start + self.segments]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::domain::{Side, cell_index};

    const AIR: [f32; 4] = [0.0; 4];

    fn found(sides: [[Side; 2]; 3], cell: [usize; 3], reach: usize) -> Vec<[usize; 3]> {
        let shape = [12, 10, 24];
        let domain = Domain::new(shape, 0.1, sides).unwrap();
        let mut scalars = vec![AIR; domain.cells()];
        scalars[cell_index(shape, cell[0], cell[1], cell[2])] = [0.0, 0.5, 0.0, 0.0];
        let mut activity = Activity::default();
        // The previous state is forgotten.
        activity.update(&domain, &vec![[1.0; 4]; domain.cells()], AIR, reach);
        activity.update(&domain, &scalars, AIR, reach);
        let rows = (0..12).flat_map(|i| (0..10).map(move |j| (i, j)));
        rows.flat_map(|(i, j)| {
            let busy = activity.row(i, j).iter().enumerate().filter(|(_, busy)| **busy);
            busy.map(move |(segment, _)| [i, j, segment]).collect::<Vec<_>>()
        })
        .collect()
    }

    #[test]
    fn hot_cells_and_their_surroundings_are_active() {
        let found = found([[Side::Open; 2]; 3], [5, 0, 20], 2);
        let expected: Vec<[usize; 3]> =
            (3..=7).flat_map(|i| (0..=2).flat_map(move |j| (1..=2).map(move |k| [i, j, k]))).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_period_closes() {
        let mut sides = [[Side::Open; 2]; 3];
        sides[0] = [Side::Periodic; 2];
        let found = found(sides, [0, 5, 3], 1);
        assert!([11, 0, 1].iter().all(|i| found.contains(&[*i, 5, 0])) && !found.contains(&[10, 5, 0]), "{found:?}");
    }

    #[test]
    fn air_is_idle() {
        let domain = Domain::new([8; 3], 0.1, [[Side::Open; 2]; 3]).unwrap();
        let mut activity = Activity::default();
        activity.update(&domain, &vec![AIR; 512], AIR, 20);
        assert!((0..8).all(|i| (0..8).all(|j| activity.row(i, j) == [false])));
    }
}
