//! Steps between frames: what they are made of, how loud they are, and that shards tell the same.

use pyrophone_flame::flux::Changes;
use pyrophone_flame::grid::{Grid, Transform};
use pyrophone_flame::scenes::{Options, Scene, Simulation};
use pyrophone_flame::upsample::{Method, Upsampler, VoxelSources};
use pyrophone_flame::velocity::{Placement, Velocity};
use pyrophone_flame::{Frame, Front};

/// Voxels along an edge.
const SIZE: usize = 24;

/// A ball of flame in a flow, both told by the place in voxels from the middle.
fn ball(radius: f64, shift: [f64; 3], flow: impl Fn([f64; 3]) -> [f64; 3], origin: [f64; 3]) -> Frame {
    let transform = Transform::uniform(0.1, origin).unwrap();
    let count = SIZE * SIZE * SIZE;
    let middle = 0.5 * (SIZE - 1) as f64;
    let place = |n: usize| -> [f64; 3] {
        let index = [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE];
        std::array::from_fn(|axis| index[axis] as f64 - middle + (origin[axis] / 0.1).round())
    };
    let away = |n: usize| place(n).iter().zip(shift).map(|(x, shift)| (x - shift).powi(2)).sum::<f64>().sqrt();
    let field: Vec<[f32; 1]> = (0..count).map(|n| [(0.5 + 0.5 * (radius - away(n))).clamp(0.0, 1.0) as f32]).collect();
    let velocity: Vec<[f32; 3]> = (0..count).map(|n| flow(place(n)).map(|x| x as f32)).collect();
    Frame {
        number: 0,
        field: Grid::dense([SIZE; 3], &field, transform).unwrap(),
        velocity: Velocity::Vectors(Grid::dense([SIZE; 3], &velocity, transform).unwrap(), Placement::Collocated),
    }
}

fn outwards(place: [f64; 3]) -> [f64; 3] {
    place
}

fn source(frame: &Frame) -> VoxelSources {
    VoxelSources::of_front(frame, 0.5).unwrap()
}

/// Sources inside and flux through the surface are one, by Gauss's theorem.
#[test]
fn sources_sum_up_to_the_flux() {
    let swirl = |[x, y, z]: [f64; 3]| [x + (0.9 * y).sin(), 0.3 * y - (0.7 * z).cos(), 2.0 * z + (0.8 * x).sin()];
    for radius in [3.3, 5.0, 7.7] {
        let frame = ball(radius, [0.3, -0.2, 0.4], swirl, [0.0; 3]);
        let flux = Front::new(0.5, 4).unwrap().measure(&frame).unwrap().flux;
        let total = source(&frame).total();
        // A ball of three voxels is not as smooth to sums over voxels as to its triangles.
        assert!((total / flux - 1.0).abs() < 0.03, "radius {radius}: {total}, {flux}");
    }
    let wind = ball(5.0, [0.0; 3], |_| [3.0, -1.0, 0.5], [0.0; 3]);
    assert!(source(&wind).total().abs() < 1e-6, "an even wind brings nothing: {}", source(&wind).total());
}

#[test]
fn a_field_alone_is_summed_in_world_units() {
    let frame = ball(5.0, [0.0; 3], outwards, [0.0; 3]);
    let volume: f64 = frame.field.blocks().flat_map(|(_, block)| block.iter()).map(|[x]| 1e-3 * f64::from(*x)).sum();
    let source = VoxelSources::of_field(&frame.field).unwrap();
    assert!((source.total() / volume - 1.0).abs() < 1e-6);
    assert_eq!(source.difference(&source), 0.0);
    let transform = Transform::uniform(1.0, [0.0; 3]).unwrap();
    assert!(VoxelSources::of_field(&Grid::new([1.0], transform)).is_err(), "it has no bounds");
}

/// A box that is cropped anew for every frame, as adaptive domains are, does not move what is in it.
#[test]
fn boxes_that_move_by_whole_voxels_keep_their_places() {
    let here = source(&ball(5.0, [0.0; 3], outwards, [0.0; 3]));
    let moved = source(&ball(5.0, [0.0; 3], outwards, [-0.2, 0.1, 0.3]));
    let all = here.difference(&VoxelSources::default());
    assert!(all > 0.0 && here.difference(&moved) < 1e-3 * all, "{} of {all}", here.difference(&moved));
}

/// A flame that changes in all its parts: balls of random sizes.
fn changing(frames: usize) -> Vec<VoxelSources> {
    let size = |n: usize| 6.0 + 1.5 * ((n * n * 7) as f64).sin();
    (0..frames)
        .map(|n| source(&ball(size(n), [(n as f64).sin(), 0.0, (2.0 * n as f64).cos()], outwards, [0.0; 3])))
        .collect()
}

fn changes(upsampler: &Upsampler, sources: &[VoxelSources], numbers: std::ops::Range<usize>) -> Changes {
    numbers
        .filter(|n| n + 1 < sources.len())
        .map(|n| (n as i64, upsampler.change(n as i64, &sources[n], &sources[n + 1])))
        .collect()
}

#[test]
fn steps_go_through_the_frames_and_move_between_them() {
    let sources = changing(24);
    let values: Vec<f64> = sources.iter().map(VoxelSources::total).collect();
    let rough = |series: &[f64]| series.windows(3).map(|x| (x[0] - 2.0 * x[1] + x[2]).powi(2)).sum::<f64>();
    let made = |method, seed| {
        let upsampler = Upsampler::new(method, 15, seed).unwrap();
        let changes = changes(&upsampler, &sources, 0..24);
        upsampler.series(&values, 0, &changes)
    };
    let cubic = made(Method::Cubic, 1);
    assert_eq!(cubic.len(), 24 * 15);
    assert!(cubic.iter().step_by(15).zip(&values).all(|(step, frame)| (step / frame - 1.0).abs() < 1e-12));
    for method in [Method::Flips, Method::Noise] {
        let one = made(method, 1);
        assert_eq!(one, made(method, 1), "{method:?} repeats");
        assert_ne!(one, made(method, 2), "{method:?} has a seed");
        assert!(rough(&one) > 4.0 * rough(&cubic), "{method:?}: {} of {}", rough(&one), rough(&cubic));
        let mean = |series: &[f64]| series.iter().sum::<f64>() / series.len() as f64;
        assert!((mean(&one) / mean(&cubic) - 1.0).abs() < 0.1, "{method:?}");
    }
}

/// A still flame in a steady flow has nothing between its frames.
#[test]
fn nothing_is_added_where_nothing_changes() {
    let still = vec![source(&ball(5.0, [0.0; 3], outwards, [0.0; 3])); 12];
    let values = vec![still[0].total(); 12];
    for method in [Method::Flips, Method::Noise, Method::Cubic] {
        let upsampler = Upsampler::new(method, 15, 1).unwrap();
        let series = upsampler.series(&values, 0, &changes(&upsampler, &still, 0..12));
        assert!(series.iter().all(|step| (step / values[0] - 1.0).abs() < 1e-12), "{method:?}");
    }
}

#[test]
fn shards_tell_what_one_run_tells() {
    let sources = changing(16);
    let upsampler = Upsampler::new(Method::Flips, 6, 5).unwrap();
    let whole = changes(&upsampler, &sources, 0..16);
    let mut parts = changes(&upsampler, &sources, 7..16);
    parts.extend(changes(&upsampler, &sources, 0..7));
    assert_eq!(parts, whole);
    assert!(whole.values().all(|change| change.iter().all(|number| number.is_finite())));
}

#[test]
fn upsampler_is_parsed_from_a_parts_settings() {
    for method in [Method::Flips, Method::Release, Method::Noise, Method::Cubic] {
        let upsampler = Upsampler::new(method, 15, u64::MAX).unwrap();
        assert_eq!(Upsampler::of_settings(&format!("iso 0.5, refine 3, upsample {upsampler}")), Some(upsampler));
    }
    for settings in ["iso 0.5", "upsample", "upsample flips, 0 steps, seed 1", "upsample what, 3 steps, seed 1"] {
        assert_eq!(Upsampler::of_settings(settings), None, "{settings}");
    }
    assert!(Upsampler::new(Method::Flips, 0, 1).is_err());
}

/// Frames of a burning scene give back the loudness of all its steps, and when it was loud.
#[test]
fn frames_of_a_flame_tell_when_and_how_loud_it_was() {
    const EVERY: usize = 15;
    let options = Options { resolution: 16, ..Options::default() };
    let mut simulation = Simulation::new(Scene::Torch, options).unwrap();
    let (mut flux, mut sources) = (vec![], vec![]);
    for step in 0..EVERY * 120 + 1 {
        simulation.step();
        let frame = simulation.frame().unwrap();
        flux.push(Front::new(0.5, 2).unwrap().measure(&frame).unwrap().flux);
        if step % EVERY == 0 {
            sources.push(source(&frame));
        }
    }
    let values: Vec<f64> = flux.iter().copied().step_by(EVERY).collect();
    // Loudness at every frame, in dB, of what is faster than the frames.
    let loudness_db = |series: &[f64]| -> Vec<f64> {
        let bends: Vec<f64> = series.windows(3).map(|x| (x[0] - 2.0 * x[1] + x[2]).powi(2)).collect();
        bends.chunks(EVERY).map(|bends| 10.0 * bends.iter().sum::<f64>().log10()).collect()
    };
    let truth = loudness_db(&flux);
    for method in [Method::Flips, Method::Noise] {
        let upsampler = Upsampler::new(method, EVERY, 1).unwrap();
        let made = upsampler.series(&values, 0, &changes(&upsampler, &sources, 0..values.len()));
        let made = loudness_db(&made[..flux.len()]);
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
        let centred = |x: &[f64]| -> Vec<f64> { x.iter().map(|value| value - mean(x)).collect() };
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (a, b) = (centred(&made), centred(&truth));
        let correlation = product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt();
        println!("{method:?}: {correlation:.2}, {:.1} dB", mean(&made) - mean(&truth));
        assert!(correlation > 0.6, "{method:?}: {correlation}");
        assert!((mean(&made) - mean(&truth)).abs() < 4.0, "{method:?}: {} dB", mean(&made) - mean(&truth));
    }
}
