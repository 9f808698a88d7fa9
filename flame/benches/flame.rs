//! Cost of a flame: seconds per simulated second, and milliseconds per front.
//!
//! `cargo bench -p pyrophone-flame --bench flame -- [SCENE] [RESOLUTION] [STEPS]`

use std::time::{Duration, Instant};

use pyrophone_flame::Front;
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};

/// Steps before anything is timed: a flame that has just been lit is small.
const WARM_UP_STEPS: u64 = 60;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let number = |index: usize, usual: usize| arguments.get(index).and_then(|text| text.parse().ok()).unwrap_or(usual);
    let named = arguments.first().and_then(|name| Scene::from_name(name));
    // The campfire's box is 64×64×96 at this resolution.
    let (resolution, steps) = (number(1, 96), number(2, 36));
    println!("{:<14}{:>14}{:>16}{:>16}{:>16}", "scene", "box", "s per second", "ms per step", "ms per front");
    for scene in named.map_or(vec![Scene::Campfire], |scene| vec![scene]) {
        let options = Options { resolution, ..Options::default() };
        let mut simulation = Simulation::new(scene, options).expect("the options are the scene's own");
        let front = Front::new(0.5, 3).expect("the usual refinement");
        for _ in 0..WARM_UP_STEPS {
            simulation.step();
        }
        let (mut stepping, mut measuring) = (Duration::ZERO, Duration::ZERO);
        for _ in 0..steps {
            let began = Instant::now();
            simulation.step();
            stepping += began.elapsed();
            let began = Instant::now();
            let frame = simulation.front_frame().expect("a box has a transform");
            front.measure(&frame).expect("the flame has bounds");
            measuring += began.elapsed();
        }
        let per_step_ms = 1000.0 * stepping.as_secs_f64() / steps as f64;
        let [x, y, z] = simulation.solver().domain().shape();
        println!(
            "{:<14}{:>14}{:>16.1}{:>16.1}{:>16.1}",
            scene.name(),
            format!("{x}×{y}×{z}"),
            per_step_ms * STEP_RATE_HZ / 1000.0,
            per_step_ms,
            1000.0 * measuring.as_secs_f64() / steps as f64,
        );
    }
}
