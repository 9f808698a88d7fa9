//! Cost of flames, as rows of `docs/performance.md`: milliseconds per front, CPU seconds per simulated second.

use std::path::{Path, PathBuf};
use std::time::Instant;

use pyrophone_flame::grid::{Grid, Transform};
use pyrophone_flame::import::{Selection, Sequence};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};
use pyrophone_flame::velocity::{Placement, Velocity};
use pyrophone_flame::{Frame, Front};

/// Frames of the reference cache that are measured.
const FRAMES: usize = 24;
/// Edge of the large frame in voxels.
const LARGE: usize = 256;
/// Steps before a scene is timed, and steps timed.
const WARM_UP_STEPS: u64 = 60;
const STEPS: u64 = 36;

fn main() {
    println!("| row | goal | found |\n|---|---|---|");
    println!("| flux, reference cache, ms per frame on one core | 4 | {} |", reference());
    println!("| flux, one frame of {LARGE}³ voxels, ms on one core; on two | both cores | {} |", large());
    println!("| simulate campfire at 64 cells, CPU s per simulated s | 12 | {} |", campfire());
}

fn front() -> Front {
    Front::new(0.5, 3).expect("the usual refinement")
}

/// Milliseconds that `work` takes at least, on so many threads.
fn shortest_ms(threads: usize, mut work: impl FnMut() + Send) -> f64 {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        (0..5).fold(f64::INFINITY, |least, _| {
            let began = Instant::now();
            work();
            least.min(1000.0 * began.elapsed().as_secs_f64())
        })
    })
}

fn reference() -> String {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from).join("flame_cache");
    let Ok(sequence) = Sequence::open(&folder) else { return "no reference data".to_owned() };
    let frames: Vec<Frame> = (0..sequence.len())
        .step_by(sequence.len().div_ceil(FRAMES).max(1))
        .filter_map(|index| sequence.read(index, &Selection::default()).ok())
        .collect();
    let front = front();
    let ms = shortest_ms(1, || frames.iter().for_each(|frame| drop(front.measure(frame))));
    let triangles: u64 = frames.iter().filter_map(|frame| front.measure(frame).ok()).map(|found| found.triangles).sum();
    format!("{:.2}; {:.0} ns per triangle", ms / frames.len() as f64, 1e6 * ms / triangles as f64)
}

/// A ball with a rough surface in a flow that is not even.
fn large() -> String {
    let transform = Transform::uniform(1.0 / LARGE as f64, [0.0; 3]).expect("a sane voxel");
    let middle = LARGE as f64 / 2.0;
    let values: Vec<[f64; 3]> =
        (0..LARGE.pow(3)).map(|n| [n / (LARGE * LARGE), n / LARGE % LARGE, n % LARGE].map(|i| i as f64)).collect();
    let field: Vec<[f32; 1]> = values
        .iter()
        .map(|[x, y, z]| {
            let distance = ((x - middle).powi(2) + (y - middle).powi(2) + (z - middle).powi(2)).sqrt();
            let rough = 6.0 * (0.3 * x).sin() * (0.25 * y).sin() * (0.35 * z).sin();
            [(0.5 + 0.05 * (0.35 * LARGE as f64 + rough - distance)).clamp(0.0, 1.0) as f32]
        })
        .collect();
    let flow: Vec<[f32; 3]> = values
        .iter()
        .map(|[x, y, z]| [(0.02 * y).sin() as f32, 1.0 + (0.03 * x).cos() as f32, (0.01 * z) as f32])
        .collect();
    let shape = [LARGE; 3];
    let frame = Frame {
        number: 1,
        field: Grid::dense(shape, &field, transform).expect("a whole array"),
        velocity: Velocity::Vectors(
            Grid::dense(shape, &flow, transform).expect("a whole array"),
            Placement::Collocated,
        ),
    };
    let front = front();
    let [one, two] = [1, 2].map(|threads| shortest_ms(threads, || drop(front.measure(&frame))));
    format!("{one:.1}; {two:.1}")
}

fn campfire() -> String {
    let options = Options { resolution: 64, ..Options::default() };
    let mut simulation = Simulation::new(Scene::Campfire, options).expect("the scene's own options");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        for _ in 0..WARM_UP_STEPS {
            simulation.step();
        }
        let began = Instant::now();
        for _ in 0..STEPS {
            simulation.step();
        }
        format!("{:.1}", began.elapsed().as_secs_f64() * STEP_RATE_HZ / STEPS as f64)
    })
}
