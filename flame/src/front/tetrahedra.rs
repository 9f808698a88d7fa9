//! The surface in one cell: marching tetrahedra, which have no ambiguous case and need no table of cubes.

/// Six tetrahedra of a cube around its diagonal 0-7 (Kuhn), all of positive volume. The number of a corner is 4x + 2y +
/// z. Neighbouring cubes meet in the same triangles, so the surface is closed.
const KUHN: [[usize; 4]; 6] = [[0, 4, 6, 7], [0, 6, 2, 7], [0, 2, 3, 7], [0, 3, 1, 7], [0, 1, 5, 7], [0, 5, 4, 7]];

/// For each set of corners inside (bit n: corner n of the tetrahedron): the corners with those inside first, in an even
/// permutation, which preserves the tetrahedron's orientation.
const INSIDE_FIRST: [[usize; 4]; 16] = [
    [0, 1, 2, 3],
    [0, 1, 2, 3],
    [1, 0, 3, 2],
    [0, 1, 2, 3],
    [2, 0, 1, 3],
    [0, 2, 3, 1],
    [1, 2, 0, 3],
    [0, 1, 2, 3],
    [3, 0, 2, 1],
    [0, 3, 1, 2],
    [1, 3, 2, 0],
    [1, 0, 3, 2],
    [2, 3, 0, 1],
    [0, 2, 3, 1],
    [1, 3, 2, 0],
    [0, 1, 2, 3],
];

/// Number of tetrahedron edges in a cube: edges of the cube, diagonals of its faces, and the cube's own diagonal.
const EDGES: usize = 19;

/// Number of the edge between each corner and each higher-numbered corner.
const EDGE: [[u8; 8]; 8] = {
    let mut numbers = [[0; 8]; 8];
    let (mut from, mut number) = (0, 0);
    while from < 8 {
        let mut to = from + 1;
        while to < 8 {
            // One corner lies beyond the other along all axes in which they differ.
            if from & to == from {
                numbers[from][to] = number;
                number += 1;
            }
            to += 1;
        }
        from += 1;
    }
    assert!(number as usize == EDGES);
    numbers
};

/// Crossing of the surface with an edge of the lattice.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossing {
    /// The edge's lower end: steps of the lattice from the cell's corner.
    pub low: [usize; 3],
    /// The edge's upper end, as a corner 1-7 of the cube at `low`.
    pub direction: usize,
    /// Position along the edge, 0-1.
    pub share: f64,
}

/// Computes the bits for [`march`]: for every row along z of `(refine + 1)^3` values, bit z is set if the value is
/// above `level`.
pub(super) fn mark(values: &[f64], refine: usize, level: f64, rows: &mut Vec<u32>) {
    let bits = |row: &[f64]| row.iter().enumerate().fold(0, |bits, (z, value)| bits | u32::from(*value > level) << z);
    rows.clear();
    rows.extend(values.chunks_exact(refine + 1).map(bits));
}

/// Visits every triangle of the surface `values = level` in a cell of `refine` steps, whose `(refine + 1)^3` values
/// have x slowest and are marked in `rows`. Inside is above the level; the triangles are counter-clockwise as seen from
/// outside. `point` converts a crossing to a triangle corner, once for all triangles of a cube.
pub(super) fn march<P: Copy + Default>(
    values: &[f64],
    rows: &[u32],
    refine: usize,
    level: f64,
    mut point: impl FnMut(Crossing) -> P,
    mut triangle: impl FnMut([P; 3]),
) {
    let row = refine + 1;
    let plane = row * row;
    let cubes = (1u32 << refine) - 1;
    for (x, y) in (0..refine).flat_map(|x| (0..refine).map(move |y| (x, y))) {
        let sides = [rows[x * row + y], rows[x * row + y + 1], rows[(x + 1) * row + y], rows[(x + 1) * row + y + 1]];
        let any = sides.iter().fold(0, |any, side| any | side);
        let all = sides.iter().fold(u32::MAX, |all, side| all & side);
        let mut cut = (any | any >> 1) & !(all & all >> 1) & cubes;
        while cut != 0 {
            let z = cut.trailing_zeros() as usize;
            cut &= cut - 1;
            let inside = sides.iter().rev().fold(0, |set, side| set << 2 | (side >> z & 3) as usize);
            let at = x * plane + y * row + z;
            let corners: [f64; 8] =
                std::array::from_fn(|c| values[at + (c >> 2) * plane + ((c >> 1) & 1) * row + (c & 1)]);
            march_cube([x, y, z], &corners, inside, level, &mut point, &mut triangle);
        }
    }
}

fn march_cube<P: Copy + Default>(
    low: [usize; 3],
    corners: &[f64; 8],
    inside: usize,
    level: f64,
    point: &mut impl FnMut(Crossing) -> P,
    triangle: &mut impl FnMut([P; 3]),
) {
    let (mut points, mut known) = ([P::default(); EDGES], 0u32);
    // Always from the lower end, so that all cubes at an edge find the same point on it.
    let mut crossing = |one: usize, other: usize| {
        let (from, to) = (one.min(other), one.max(other));
        let edge = usize::from(EDGE[from][to]);
        if known >> edge & 1 == 0 {
            known |= 1 << edge;
            let low = std::array::from_fn(|axis| low[axis] + ((from >> (2 - axis)) & 1));
            let share = (level - corners[from]) / (corners[to] - corners[from]);
            points[edge] = point(Crossing { low, direction: to - from, share });
        }
        points[edge]
    };
    for tetrahedron in KUHN {
        let set = tetrahedron.iter().enumerate().fold(0, |set, (bit, corner)| set | (((inside >> corner) & 1) << bit));
        let [a, b, c, d] = INSIDE_FIRST[set].map(|corner| tetrahedron[corner]);
        match set.count_ones() {
            1 => triangle([crossing(a, b), crossing(a, c), crossing(a, d)]),
            2 => {
                let quad = [crossing(a, c), crossing(a, d), crossing(b, d), crossing(b, c)];
                triangle([quad[0], quad[1], quad[2]]);
                triangle([quad[0], quad[2], quad[3]]);
            }
            3 => triangle([crossing(a, d), crossing(b, d), crossing(c, d)]),
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(number: usize) -> [f64; 3] {
        [(number >> 2) as f64, ((number >> 1) & 1) as f64, (number & 1) as f64]
    }

    fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|axis| a[axis] - b[axis])
    }

    fn volume([a, b, c, d]: [[f64; 3]; 4]) -> f64 {
        crate::grid::dot(crate::grid::cross(sub(b, a), sub(c, a)), sub(d, a))
    }

    #[test]
    fn six_tetrahedra_of_positive_volume_fill_the_cube() {
        let volumes = KUHN.map(|tetrahedron| volume(tetrahedron.map(corner)));
        assert_eq!(volumes, [1.0; 6]);
    }

    #[test]
    fn corners_inside_come_first_in_an_even_permutation() {
        for (set, order) in INSIDE_FIRST.iter().enumerate() {
            let inside = order.map(|corner| (set >> corner) & 1);
            assert!(inside.is_sorted_by(|a, b| a >= b), "{set}: {order:?}");
            let swaps = (0..4).flat_map(|i| (0..i).map(move |j| (j, i))).filter(|(j, i)| order[*j] > order[*i]).count();
            assert_eq!(swaps % 2, 0, "{set}: {order:?}");
        }
    }

    /// All 254 ways to cut a cube: triangles face outwards and enclose the volume inside.
    #[test]
    fn triangles_face_outwards() {
        for inside in 1..255usize {
            let corners: [f64; 8] = std::array::from_fn(|c| if (inside >> c) & 1 == 1 { 1.0 } else { -1.0 });
            let mut cuts = 0;
            march_cube([0; 3], &corners, inside, 0.0, &mut |crossing| crossing, &mut |triangle: [Crossing; 3]| {
                cuts += 1;
                let points = triangle.map(|crossing| {
                    assert_eq!(crossing.share, 0.5);
                    let (low, step) = (crossing.low.map(|x| x as f64), corner(crossing.direction));
                    std::array::from_fn(|axis| low[axis] + crossing.share * step[axis])
                });
                let normal = crate::grid::cross(sub(points[1], points[0]), sub(points[2], points[0]));
                // The field is linear along every edge: across the triangle it falls along the normal.
                for crossing in triangle {
                    let from = crossing.low.iter().fold(0, |c, x| 2 * c + x);
                    let falls = corners[from] - corners[from + crossing.direction];
                    assert!(falls * crate::grid::dot(normal, corner(crossing.direction)) >= 0.0, "{inside}");
                }
            });
            assert!(cuts > 0, "{inside}");
        }
    }
}
