//! Flux and motion of simulated flames.

use std::io::{IsTerminal, Write};

use anyhow::{Context, Result};
use pyrophone_flame::Front;
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};
use pyrophone_flame::speed_field::{Regions, stride};

/// Cells along the box above which more make hardly an audible difference, and parts of a cell for locating its front.
pub const RESOLUTION: usize = 40;
const REFINE: usize = 2;

/// Observations of a simulated flame.
pub struct SimulatedFlame {
    /// Flux at every step.
    pub flux: Vec<f64>,
    /// Speeds of the sub-volumes, [`MOTION_RATE_HZ`] times a second.
    pub motion: Vec<Vec<f32>>,
    /// Those sub-volumes.
    pub regions: Regions,
}

/// The scenes with these names; all if there are none.
pub fn scenes(names: &[String]) -> Result<Vec<Scene>> {
    let named = |name: &String| Scene::from_name(name).with_context(|| format!("there is no scene {name}"));
    let scenes: Vec<Scene> = names.iter().map(named).collect::<Result<_>>()?;
    Ok(if scenes.is_empty() { Scene::ALL.to_vec() } else { scenes })
}

/// Sampling rate of motion, per second.
pub const MOTION_RATE_HZ: f64 = 30.0;

/// Flux at every step over `seconds`, after `pre_roll_s` that are dropped.
pub fn flux(scene: Scene, options: Options, pre_roll_s: f64, seconds: f64, what: &str) -> Result<Vec<f64>> {
    Ok(burn(scene, options, pre_roll_s, seconds, what)?.flux)
}

/// Flux and motion over `seconds`, after `pre_roll_s` that are dropped; `what` is the name shown with progress.
pub fn burn(scene: Scene, options: Options, pre_roll_s: f64, seconds: f64, what: &str) -> Result<SimulatedFlame> {
    let mut simulation = Simulation::new(scene, options)?;
    let regions = Regions::of_solver(simulation.solver());
    let mut motion = vec![];
    let front = Front::new(0.5, REFINE)?;
    let steps = |seconds: f64| (seconds * STEP_RATE_HZ).round() as u64;
    let pre_roll = steps(pre_roll_s);
    let total = pre_roll + steps(seconds);
    let shown = std::io::stderr().is_terminal();
    let mut flux = vec![];
    while simulation.steps() < total {
        simulation.step();
        if simulation.steps() > pre_roll {
            if (flux.len() as u64).is_multiple_of(stride(STEP_RATE_HZ)) {
                motion.push(regions.mean_speeds(&simulation.frame()?.velocity));
            }
            flux.push(front.measure(&simulation.front_frame()?)?.flux);
        }
        if shown && simulation.steps().is_multiple_of(36) {
            eprint!("\rsimulating {what}: {:3} %", 100 * simulation.steps() / total);
            std::io::stderr().flush()?;
        }
    }
    if shown {
        eprintln!();
    }
    Ok(SimulatedFlame { flux, motion, regions })
}
