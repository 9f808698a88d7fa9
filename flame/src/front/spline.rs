//! The field between its voxels: uniform cubic B-splines as a smoothing kernel (Chadwick & James 2011, §3, eq. 7-8).

/// Weights of the taps -1, 0, 1, 2 at fraction `t` (0-1) of a cell.
fn weights(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    let outer = |t: f64| t * t * t / 6.0;
    let inner = |t: f64| (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0;
    [outer(s), inner(t), inner(s), outer(t)]
}

/// First derivatives of [`weights`].
fn slopes(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-0.5 * s * s, 1.5 * t * t - 2.0 * t, 2.0 * s - 1.5 * s * s, 0.5 * t * t]
}

/// Second derivatives of [`weights`].
fn second_derivative(t: f64) -> [f64; 4] {
    [1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t]
}

/// Conversion from the taps of a cell to the Bézier coefficients of the same cubic.
const BEZIER: [[f64; 4]; 4] = [
    [1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0, 0.0],
    [0.0, 4.0 / 6.0, 2.0 / 6.0, 0.0],
    [0.0, 2.0 / 6.0, 4.0 / 6.0, 0.0],
    [0.0, 1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0],
];

/// The 4×4×4 voxels that define the spline in the cell between voxels 1 and 2 of each axis (x slowest).
#[derive(Debug, Clone)]
pub(super) struct Patch {
    pub coefficients: [f64; 64],
}

impl Patch {
    /// Bounds of the spline in the cell: those of its Bézier coefficients, whose convex hull contains it.
    pub fn bounds(&self) -> (f64, f64) {
        let mut bezier = [0.0; 64];
        transform(&self.coefficients, &BEZIER, &mut bezier);
        bezier.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
    }

    /// Gradient and Hessian at fractions `t` (0-1 each) of the cell, per index and per index squared.
    pub fn derivatives(&self, t: [f64; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
        let kernels = t.map(|t| [weights(t), slopes(t), second_derivative(t)]);
        let sum =
            |taps: &[f64], kernel: &[f64; 4]| taps.iter().zip(kernel).map(|(tap, weight)| tap * weight).sum::<f64>();
        // Orders of the derivatives along y and z that add up to at most two.
        const ORDERS: [(usize, usize); 6] = [(0, 0), (1, 0), (0, 1), (2, 0), (0, 2), (1, 1)];
        let mut along_x = [[0.0; 4]; 6];
        for (x, plane) in self.coefficients.chunks_exact(16).enumerate() {
            let mut lines = [[0.0; 4]; 3];
            for (y, line) in plane.chunks_exact(4).enumerate() {
                for (order, lines) in lines.iter_mut().enumerate() {
                    lines[y] = sum(line, &kernels[2][order]);
                }
            }
            for ((y, z), along_x) in ORDERS.into_iter().zip(&mut along_x) {
                along_x[x] = sum(&lines[z], &kernels[1][y]);
            }
        }
        let at = |order: usize, yz: usize| sum(&along_x[yz], &kernels[0][order]);
        let (xy, xz, yz) = (at(1, 1), at(1, 2), at(0, 5));
        let hessian = [[at(2, 0), xy, xz], [xy, at(0, 3), yz], [xz, yz, at(0, 4)]];
        ([at(1, 0), at(0, 1), at(0, 2)], hessian)
    }
}

/// Most steps along an edge.
pub(super) const MAX_REFINE: usize = 16;

/// The points at which a cell's spline is sampled: `refine` steps along each edge, including both ends.
#[derive(Debug, Clone)]
pub(super) struct Lattice {
    weights: Vec<[f64; 4]>,
    /// Samples of the last cell, x slowest.
    pub values: Vec<f64>,
}

impl Lattice {
    pub fn new(refine: usize) -> Self {
        let mut table: Vec<[f64; 4]> = (0..refine).map(|step| weights(step as f64 / refine as f64)).collect();
        // The neighbouring cell's first weights: both cells then get the same numbers on their common face.
        let [a, b, c, _] = weights(0.0);
        table.push([0.0, a, b, c]);
        let values = vec![0.0; (refine + 1).pow(3)];
        Self { weights: table, values }
    }

    pub fn sample(&mut self, patch: &Patch) {
        transform(&patch.coefficients, &self.weights, &mut self.values);
    }
}

/// Applies one table of weights along all three axes of a cube of 4×4×4.
fn transform(cube: &[f64; 64], table: &[[f64; 4]], out: &mut [f64]) {
    let size = table.len();
    // One plane at a time, so that a large table needs no more memory than its output.
    let mut lines = [0.0; 4 * (MAX_REFINE + 1)];
    let lines = &mut lines[..4 * size];
    for (x, plane_out) in table.iter().zip(out.chunks_exact_mut(size * size)) {
        let mut plane = [0.0; 16];
        for (yz, value) in plane.iter_mut().enumerate() {
            *value = x[0] * cube[yz] + x[1] * cube[16 + yz] + x[2] * cube[32 + yz] + x[3] * cube[48 + yz];
        }
        for (y, line) in table.iter().zip(lines.chunks_exact_mut(4)) {
            for (z, value) in line.iter_mut().enumerate() {
                *value = y[0] * plane[z] + y[1] * plane[4 + z] + y[2] * plane[8 + z] + y[3] * plane[12 + z];
            }
        }
        for (line, line_out) in lines.chunks_exact(4).zip(plane_out.chunks_exact_mut(size)) {
            for (z, value) in table.iter().zip(line_out) {
                *value = z[0] * line[0] + z[1] * line[1] + z[2] * line[2] + z[3] * line[3];
            }
        }
    }
}
