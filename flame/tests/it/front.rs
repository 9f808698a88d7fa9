//! The flame front against closed forms, brute force and the reference flame.

use crate::common::{field, flow, frame, wind};
use proptest::prelude::*;
use pyrophone_flame::front::{Front, Measure, Mesh, Refinement};
use pyrophone_flame::grid::{Grid, Transform};
use pyrophone_flame::velocity::{Placement, Velocity};
use pyrophone_flame::{Error, Frame};

fn unit() -> Transform {
    Transform::uniform(1.0, [0.0; 3]).unwrap()
}

fn measure(frame: &Frame) -> Measure {
    Front::new(0.5, 3).unwrap().measure_with_curvature(frame).unwrap()
}

/// Nothing, its curvature asked for.
fn nothing_found() -> Measure {
    Measure { mean_curvature: Some(0.0), ..Measure::default() }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt()
}

/// A ball of radius 1 whose field falls linearly through 0.5 at its surface, in voxels of `1 / radius`; every voxel
/// flows outwards at the speed 2.
fn ball(radius: usize) -> Frame {
    let size = 2 * radius + 17;
    let h = 1.0 / radius as f64;
    let middle = [radius as f64 + 8.3, radius as f64 + 7.9, radius as f64 + 8.1];
    let transform = Transform::uniform(h, [-1.0, 2.0, 3.0]).unwrap();
    let burning = field(size, transform, |at| (0.5 + (radius as f64 - distance(at, middle)) * 0.05).max(0.0));
    let velocity = flow(size, transform, |at| {
        let away = distance(at, middle).max(1e-9);
        std::array::from_fn(|axis| 2.0 * (at[axis] - middle[axis]) / away)
    });
    frame(burning, velocity)
}

#[test]
fn an_expanding_ball_has_its_flux_area_and_curvature() {
    let area = 4.0 * std::f64::consts::PI;
    let mut errors = vec![];
    for radius in [8, 16, 32] {
        let found = measure(&ball(radius));
        errors.push((found.flux / (2.0 * area) - 1.0).abs());
        if radius >= 16 {
            assert!((found.flux / (2.0 * area) - 1.0).abs() < 0.005, "{radius}: {found:?}");
            assert!((found.area / area - 1.0).abs() < 0.005, "{radius}: {found:?}");
            assert!((found.mean_curvature.unwrap() - 1.0).abs() < 0.005, "{radius}: {found:?}");
        }
    }
    // Second order: half the voxel, a quarter of the error.
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!((3.5..4.5).contains(&ratio), "{errors:?}");
    }
}

/// Blobs whose field is smooth noise inside a box of `size` voxels, zero at its edge.
fn blobs(size: usize, spots: &[([f64; 3], f64)], transform: Transform) -> Grid<1> {
    field(size, transform, |at| {
        let edge = at.iter().map(|i| i.min((size - 1) as f64 - i)).fold(f64::INFINITY, f64::min);
        let sum: f64 = spots
            .iter()
            .map(|(centre, radius)| {
                let centre = centre.map(|c| c * (size - 1) as f64);
                (-(distance(at, centre) / radius).powi(2)).exp()
            })
            .sum();
        sum * (edge / 3.0).clamp(0.0, 1.0)
    })
}

fn spots() -> impl Strategy<Value = Vec<([f64; 3], f64)>> {
    proptest::collection::vec((proptest::array::uniform3(0.1f64..0.9), 1.0f64..4.0), 1..7)
}

/// Any invertible matrix that is not too flat.
fn transforms() -> impl Strategy<Value = Transform> {
    (proptest::array::uniform3(proptest::array::uniform3(-2.0f64..2.0)), proptest::array::uniform3(-10.0f64..10.0))
        .prop_filter_map("flat", |(rows, translation)| {
            let determinant: f64 = (0..3)
                .map(|i| {
                    rows[0][i]
                        * (rows[1][(i + 1) % 3] * rows[2][(i + 2) % 3] - rows[1][(i + 2) % 3] * rows[2][(i + 1) % 3])
                })
                .sum();
            Transform::new(rows, translation).ok().filter(|_| determinant.abs() > 0.2)
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Gauss: what flows in flows out, however the flame and its grid are shaped.
    #[test]
    fn an_even_wind_has_no_flux(
        spots in spots(),
        to in transforms(),
        wind_of in proptest::array::uniform3(-5f32..5.0),
    ) {
        let found = measure(&frame(blobs(20, &spots, to), wind(wind_of)));
        let speed = distance(wind_of.map(f64::from), [0.0; 3]);
        prop_assert!(found.flux.abs() <= 1e-10 * speed * found.area, "{:?}", found);
    }

    /// A flow u = x has divergence 3: its flux is three times the volume, whatever turns or stretches the grid. Both
    /// sides are exact for the triangles, but for the rule of one point per triangle.
    #[test]
    fn flux_of_a_divergent_flow_is_volume(spots in spots(), to in transforms()) {
        let found = Front::new(0.5, 3).unwrap();
        let grid = blobs(20, &spots, to);
        let mesh = found.mesh(&grid).unwrap();
        // u(x) = x is linear in the index: a grid over all indices of the field holds it exactly.
        let velocity = flow(20, to, |at| to.to_world(at));
        let flux = found.measure(&frame(grid, velocity)).unwrap().flux;
        let expected = 3.0 * volume(&mesh);
        // The values are f32.
        prop_assert!((flux - expected).abs() <= 1e-4 * (1.0 + expected.abs()), "{} {}", flux, expected);
    }

    /// Every edge of the surface belongs to two triangles, once in each direction.
    #[test]
    fn the_surface_is_closed(spots in spots(), to in transforms(), refine in 1usize..5) {
        let mesh = Front::new(0.5, refine).unwrap().mesh(&blobs(20, &spots, to)).unwrap();
        prop_assert!(is_closed(&mesh));
        prop_assert!(volume(&mesh) >= 0.0);
    }

    /// The area of a turned and shifted grid stays, its flux stays when the flow turns with it.
    #[test]
    fn a_turned_grid_measures_the_same(
        spots in spots(),
        angle in 0f64..std::f64::consts::TAU,
        shift in proptest::array::uniform3(-50f64..50.0),
    ) {
        let (sin, cos) = angle.sin_cos();
        let turned = Transform::new([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]], shift).unwrap();
        let swirl = |at: [f64; 3]| [(0.3 * at[1]).sin(), 0.1 * at[0], (0.2 * at[0]).cos()];
        let plain = measure(&frame(blobs(20, &spots, unit()), flow(20, unit(), swirl)));
        let there = measure(&frame(blobs(20, &spots, turned), flow(20, turned, |at| turned.turn(swirl(at)))));
        let numbers = |found: &Measure| [found.flux, found.area, found.mean_curvature.unwrap()];
        for (a, b) in numbers(&plain).into_iter().zip(numbers(&there)) {
            prop_assert!((a - b).abs() <= 1e-5 * (1.0 + plain.area), "{:?} {:?}", plain, there);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// Cells that are passed over hold no surface: every cell is looked at here.
    #[test]
    fn passing_over_cells_misses_nothing(spots in spots(), refine in 1usize..4, iso in 0.1f64..0.9) {
        let grid = blobs(12, &spots, unit());
        let mesh = Front::new(iso, refine).unwrap().mesh(&grid).unwrap();
        // A voxel at the iso value itself does not burn, whatever rounding says.
        let (triangles, area) = brute(&grid, iso * (1.0 + 2f64.powi(-30)), refine);
        prop_assert_eq!(mesh.triangles.len(), triangles);
        let found: f64 = mesh.triangles.iter().map(|t| triangle_area(t.map(|v| mesh.vertices[v as usize]))).sum();
        prop_assert!((found - area).abs() <= 1e-9 * (1.0 + area), "{} {}", found, area);
    }
}

fn volume(mesh: &Mesh) -> f64 {
    let sixfold = |[a, b, c]: [[f64; 3]; 3]| {
        (0..3).map(|i| a[i] * (b[(i + 1) % 3] * c[(i + 2) % 3] - b[(i + 2) % 3] * c[(i + 1) % 3])).sum::<f64>()
    };
    mesh.triangles.iter().map(|t| sixfold(t.map(|v| mesh.vertices[v as usize]))).sum::<f64>() / 6.0
}

fn is_closed(mesh: &Mesh) -> bool {
    let mut edges = std::collections::HashMap::new();
    for [a, b, c] in &mesh.triangles {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((from, to)).or_insert(0) += 1;
        }
    }
    edges.iter().all(|((from, to), count)| *count == 1 && edges.get(&(*to, *from)) == Some(&1))
}

fn triangle_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let (p, q, r) = (distance(a, b), distance(b, c), distance(c, a));
    // Heron's formula in Kahan's order.
    let mut sides = [p, q, r];
    sides.sort_by(|a, b| b.total_cmp(a));
    let [p, q, r] = sides;
    0.25 * ((p + (q + r)) * (r - (p - q)) * (r + (p - q)) * (p + (q - r))).max(0.0).sqrt()
}

/// The spline's value at a lattice point, straight from its definition: all 64 voxels.
fn spline(grid: &Grid<1>, point: [i32; 3], refine: i32) -> f64 {
    let kernel = |x: f64| match x.abs() {
        a if a < 1.0 => (4.0 - 6.0 * a * a + 3.0 * a * a * a) / 6.0,
        a if a < 2.0 => (2.0 - a).powi(3) / 6.0,
        _ => 0.0,
    };
    let at = point.map(|p| f64::from(p) / f64::from(refine));
    let base = at.map(|x| x.floor() as i32);
    let mut sum = 0.0;
    for n in 0..64 {
        let index: [i32; 3] = std::array::from_fn(|axis| base[axis] + [n >> 4, (n >> 2) & 3, n & 3][axis] - 1);
        let weight: f64 = (0..3).map(|axis| kernel(at[axis] - f64::from(index[axis]))).product();
        sum += weight * f64::from(grid.value(index)[0]);
    }
    sum
}

/// Triangles and area by tetrahedra in every cube of the lattice; points in a tetrahedron are sorted by walking the
/// axes in every order, which gives Kuhn's six.
fn brute(grid: &Grid<1>, iso: f64, refine: usize) -> (usize, f64) {
    let refine = refine as i32;
    let (low, high) = (-3 * refine, 15 * refine);
    let size = (high - low + 2) as usize;
    let mut values = vec![0.0; size * size * size];
    for (n, value) in values.iter_mut().enumerate() {
        *value = spline(grid, [n / (size * size), n / size % size, n % size].map(|i| i as i32 + low), refine);
    }
    let value = |p: [i32; 3]| values[p.iter().fold(0, |n, i| n * size + (i - low) as usize)];
    let (mut count, mut area) = (0, 0.0);
    for n in 0..(size - 1).pow(3) {
        let corner =
            [n / ((size - 1) * (size - 1)), n / (size - 1) % (size - 1), n % (size - 1)].map(|i| i as i32 + low);
        for axes in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
            let mut points = [corner; 4];
            for (step, axis) in axes.into_iter().enumerate() {
                for point in &mut points[step + 1..] {
                    point[axis] += 1;
                }
            }
            let (inside, outside): (Vec<[i32; 3]>, Vec<[i32; 3]>) = points.iter().partition(|p| value(**p) > iso);
            let cut = |a: [i32; 3], b: [i32; 3]| -> [f64; 3] {
                let share = (iso - value(a)) / (value(b) - value(a));
                std::array::from_fn(|i| (f64::from(a[i]) + share * f64::from(b[i] - a[i])) / f64::from(refine))
            };
            match (inside.len(), outside.len()) {
                (1, 3) | (3, 1) => {
                    let (alone, others) = if inside.len() == 1 { (inside[0], outside) } else { (outside[0], inside) };
                    area += triangle_area([cut(alone, others[0]), cut(alone, others[1]), cut(alone, others[2])]);
                    count += 1;
                }
                (2, 2) => {
                    let [a, b] = [inside[0], inside[1]]
                        .map(|inside| outside.iter().map(|out| cut(inside, *out)).collect::<Vec<_>>());
                    area += triangle_area([a[0], a[1], b[1]]) + triangle_area([a[0], b[1], b[0]]);
                    count += 2;
                }
                _ => {}
            }
        }
    }
    (count, area)
}

#[test]
fn tiles_measure_as_their_voxels_do() {
    // A tile of 32 voxels and one of 8 on its side, the same voxel by voxel.
    let mut tiles = Grid::new([0.0], unit());
    tiles.add_tile([0, 0, 0], 5, [1.0]);
    tiles.add_tile([32, 8, 16], 3, [0.8]);
    let mut voxels = Grid::new([0.0], unit());
    for x in 0..4 {
        for y in 0..4 {
            for z in 0..4 {
                voxels.block_mut([x, y, z]).fill([1.0]);
            }
        }
    }
    voxels.block_mut([4, 1, 2]).fill([0.8]);
    let velocity = || flow(48, unit(), |at| [at[0] * 0.1, (at[1] * 0.2).sin(), at[2]]);
    let (found, expected) = (measure(&frame(tiles, velocity())), measure(&frame(voxels, velocity())));
    assert_eq!(found, expected);
    assert!(expected.area > 5000.0);
}

#[test]
fn tiles_too_large_to_be_meant_are_refused_at_once() {
    let mut grid = Grid::new([0.0], unit());
    for x in 0..40 {
        grid.add_tile([x << 12, 0, 0], 12, [1.0]);
    }
    let error = Front::new(0.5, 3).unwrap().measure(&frame(grid, wind([0.0; 3]))).unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error}");
    for (origin, log2) in [([1 << 30, 0, 0], 3), ([0, -(1 << 30), 0], 12)] {
        let mut grid = Grid::new([0.0], unit());
        grid.add_tile(origin, log2, [1.0]);
        let error = Front::new(0.5, 3).unwrap().measure(&frame(grid, wind([0.0; 3]))).unwrap_err();
        assert!(matches!(error, Error::TooFar { .. } | Error::TooLarge { .. }), "{error}");
    }
}

#[test]
fn plateaus_at_the_iso_value_make_no_surface_of_rounding() {
    for iso in [0.5, 0.3, 0.1, 1e-3] {
        let grid =
            field(
                24,
                unit(),
                |at| if at.iter().all(|i| (4.0..20.0).contains(i)) { f64::from(iso as f32) } else { 0.0 },
            );
        let front = Front::new(f64::from(iso as f32), 3).unwrap();
        let found = front.measure(&frame(grid, wind([1.0; 3]))).unwrap();
        assert_eq!(found, Measure::default(), "{iso}");
    }
}

#[test]
fn no_flame_is_nothing_and_an_endless_one_an_error() {
    let nothing = measure(&frame(Grid::new([0.0], unit()), wind([1.0; 3])));
    assert_eq!(nothing, nothing_found());
    let below = measure(&frame(field(12, unit(), |_| 0.49), wind([1.0; 3])));
    assert_eq!(below, nothing_found());
    let front = Front::new(0.5, 3).unwrap();
    let endless = front.measure(&frame(Grid::new([1.0], unit()), wind([1.0; 3])));
    assert!(matches!(endless, Err(Error::Unbounded { .. })));
    let broken = front.measure(&frame(field(12, unit(), |_| f64::NAN), wind([1.0; 3])));
    assert_eq!(broken, Err(Error::NotFinite { what: "field" }));
    let broken = front.measure(&frame(Grid::new([0.0], unit()), wind([f32::INFINITY; 3])));
    assert_eq!(broken, Err(Error::NotFinite { what: "velocity" }));
    for (iso, refine) in [(f64::NAN, 3), (0.5, 0), (0.5, 17), (f64::INFINITY, 3)] {
        assert!(matches!(Front::new(iso, refine), Err(Error::OutOfRange { .. })));
    }
}

/// Staggered components and grids of their own sample the same linear flow.
#[test]
fn placements_agree_on_a_linear_flow() {
    let linear = |at: [f64; 3]| [0.5 * at[0] + at[1], 0.25 * at[2] - at[0], 0.125 * at[1] + 2.0 * at[2]];
    let grid = || blobs(20, &[([0.5; 3], 4.0)], unit());
    let expected = measure(&frame(grid(), flow(20, unit(), linear))).flux;
    let component = |axis: usize, at: [f64; 3]| {
        let mut on_face = at;
        on_face[axis] -= 0.5;
        linear(on_face)[axis]
    };
    let Velocity::Vectors(faces, _) = flow(20, unit(), |at| std::array::from_fn(|axis| component(axis, at))) else {
        unreachable!()
    };
    let staggered = measure(&frame(grid(), Velocity::Vectors(faces, Placement::Staggered))).flux;
    let split: [Grid<1>; 3] = std::array::from_fn(|axis| {
        let mut origin = [0.0; 3];
        origin[axis] = -0.5;
        field(20, Transform::uniform(1.0, origin).unwrap(), |at| component(axis, at))
    });
    let components = measure(&frame(grid(), Velocity::Components(Box::new(split)))).flux;
    assert!(expected.abs() > 100.0);
    assert!((staggered / expected - 1.0).abs() < 1e-5 && (components / expected - 1.0).abs() < 1e-5);
}

/// Flux, the same by absolute values, and area, triangle by triangle in world units.
fn sum_of_triangles(frame: &Frame, refine: usize) -> [f64; 3] {
    let mesh = Front::new(0.5, refine).unwrap().mesh(&frame.field).unwrap();
    let mut sums = [0.0; 3];
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])) {
        let (ab, ac): ([f64; 3], [f64; 3]) =
            (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
        let surface: [f64; 3] =
            std::array::from_fn(|i| 0.5 * (ab[(i + 1) % 3] * ac[(i + 2) % 3] - ab[(i + 2) % 3] * ac[(i + 1) % 3]));
        let velocity = frame.velocity.velocity_at(std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0));
        let flux: f64 = (0..3).map(|i| velocity[i] * surface[i]).sum();
        sums = [sums[0] + flux, sums[1] + flux.abs(), sums[2] + distance(surface, [0.0; 3])];
    }
    sums
}

#[test]
fn measures_equal_the_sum_of_their_triangles() {
    let turned = Transform::new([[0.3, 0.1, 0.0], [-0.1, 0.4, 0.05], [0.0, -0.02, -0.25]], [5.0, -3.0, 1.0]).unwrap();
    let swirl = |at: [f64; 3]| [(0.7 * at[1]).sin(), 0.1 * at[0] - at[2], (0.5 * at[0]).cos()];
    let spots = [([0.3, 0.4, 0.5], 3.0), ([0.7, 0.6, 0.4], 4.0), ([0.6, 0.2, 0.8], 2.0)];
    for (of_field, of_flow) in [(unit(), unit()), (turned, turned), (unit(), turned)] {
        let Velocity::Vectors(vectors, _) = flow(24, of_flow, swirl) else { unreachable!() };
        let components = [0, 1, 2].map(|axis| field(24, of_flow, |at| swirl(at)[axis]));
        for velocity in [
            Velocity::Vectors(vectors.clone(), Placement::Collocated),
            Velocity::Vectors(vectors.clone(), Placement::Staggered),
            Velocity::Components(Box::new(components.clone())),
        ] {
            let frame = frame(blobs(24, &spots, of_field), velocity);
            for refine in [1, 3] {
                let found = Front::new(0.5, refine).unwrap().measure(&frame).unwrap();
                let [flux, passing, area] = sum_of_triangles(&frame, refine);
                assert!(found.triangles > 100 && found.mean_curvature.is_none());
                assert!((found.area / area - 1.0).abs() < 1e-9, "{refine}: {found:?}, area {area}");
                assert!((found.flux - flux).abs() <= 1e-9 * passing, "{refine}: {found:?}, flux {flux} of {passing}");
            }
        }
    }
}

#[test]
fn any_number_of_threads_measures_the_same() {
    let frame = ball(32);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| Front::new(0.5, 3).unwrap().measure(&frame).unwrap())
    };
    assert_eq!(on(2), Front::new(0.5, 3).unwrap().measure_on_this_thread(&frame).unwrap());
    assert_eq!(on(1), on(4));
}

#[test]
fn meshes_are_written_whole() {
    let mesh = Front::new(0.5, 1).unwrap().mesh(&blobs(20, &[([0.5; 3], 4.0)], unit())).unwrap();
    assert!(mesh.triangles.len() > 100 && is_closed(&mesh));
    let mut obj = vec![];
    mesh.write_obj(&mut obj).unwrap();
    let obj = String::from_utf8(obj).unwrap();
    let vertices: Vec<[f64; 3]> = obj
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap())
        .collect();
    assert_eq!(vertices, mesh.vertices);
    let faces = obj.lines().filter_map(|line| line.strip_prefix("f "));
    let faces: Vec<[u32; 3]> = faces
        .map(|line| line.split(' ').map(|x| x.parse::<u32>().unwrap() - 1).collect::<Vec<u32>>().try_into().unwrap())
        .collect();
    assert_eq!(faces, mesh.triangles);
    let mut ply = vec![];
    mesh.write_ply(&mut ply).unwrap();
    let head = b"end_header\n";
    let body = ply.windows(head.len()).position(|window| window == head).unwrap() + head.len();
    assert_eq!(ply.len() - body, 12 * mesh.vertices.len() + 13 * mesh.triangles.len());
    let text = String::from_utf8(ply[..body].to_vec()).unwrap();
    assert!(text.contains(&format!("element vertex {}\n", mesh.vertices.len())));
    assert!(text.contains(&format!("element face {}\n", mesh.triangles.len())));
    assert_eq!(&ply[body..body + 4], &(mesh.vertices[0][0] as f32).to_le_bytes());
    assert_eq!(ply[body + 12 * mesh.vertices.len()], 3);
}

#[test]
fn large_fronts_are_sampled_less_finely() {
    let measured = |frame: &Frame, refinement: Refinement| Front::new(0.5, refinement).unwrap().measure(frame).unwrap();
    // A ball of so many voxels that grows by as much everywhere.
    let growing = |radius: usize| {
        let size = 2 * radius + 17;
        let middle = [0.5 * size as f64; 3];
        let burning = field(size, unit(), |at| (0.5 + 0.05 * (radius as f64 - distance(at, middle))).max(0.0));
        let coarse = Transform::uniform(size as f64 / 10.0, [0.0; 3]).unwrap();
        frame(burning, flow(12, coarse, |at| at.map(|i| i - 5.0)))
    };
    let small = growing(16);
    assert_eq!(measured(&small, Refinement::BySize), measured(&small, Refinement::Fixed(3)));
    let all = [Refinement::Fixed(3), Refinement::Fixed(2), Refinement::BySize];
    let [fine, coarse, chosen] = all.map(|refinement| measured(&growing(78), refinement));
    assert_eq!(chosen, coarse);
    assert!(
        (chosen.flux / fine.flux - 1.0).abs() < 1e-4 && chosen.triangles < fine.triangles / 2,
        "{chosen:?} {fine:?}"
    );
    // Between the sizes at which one gives way to the other, both count.
    let [fine, coarse, chosen] = all.map(|refinement| measured(&growing(66), refinement));
    assert_eq!(chosen.triangles, fine.triangles + coarse.triangles);
    let share = (chosen.flux - fine.flux) / (coarse.flux - fine.flux);
    assert!((0.05..0.95).contains(&share), "{share}");
}
