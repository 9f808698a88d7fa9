//! A flame's pressure for those who have none at hand: simulated here, at a resolution that takes less than a minute.

use std::io::{IsTerminal, Write};

use anyhow::Result;
use pyrophone_flame::Front;
use pyrophone_flame::pressure::{self, Options as PressureOptions};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};

/// What burns: it has blasts and pauses, and so shows what follows a flame.
pub const SCENE: Scene = Scene::Dragon;

/// Cells along the box, and parts of a cell in which the front is looked for.
const RESOLUTION: usize = 32;
const REFINE: usize = 2;

/// Length of the demo's signal in seconds.
pub const SECONDS: f64 = 8.0;

/// Pressure of a simulated flame over `seconds`, mono.
pub fn simulate(sample_rate_hz: u32, seconds: f64) -> Result<Vec<f32>> {
    let mut simulation = Simulation::new(SCENE, Options { resolution: RESOLUTION, ..Options::default() })?;
    let front = Front::new(0.5, REFINE)?;
    let pre_roll = (SCENE.default_pre_roll_s() * STEP_RATE_HZ) as u64;
    let total = pre_roll + (seconds * STEP_RATE_HZ) as u64;
    let shown = std::io::stderr().is_terminal();
    let mut flux = vec![];
    while simulation.steps() < total {
        simulation.step();
        if simulation.steps() > pre_roll {
            flux.push(front.measure(&simulation.frame()?)?.flux);
        }
        if shown && simulation.steps().is_multiple_of(36) {
            eprint!("\rsimulating a flame: {:3} %", 100 * simulation.steps() / total);
            std::io::stderr().flush()?;
        }
    }
    if shown {
        eprintln!();
    }
    Ok(pressure::render(&flux, &PressureOptions { sample_rate_hz, ..PressureOptions::default() })?.samples)
}

#[cfg(test)]
mod tests {
    use super::super::analysis::Spectrum;
    use super::*;

    #[test]
    fn the_flame_is_low_and_bursty() {
        let flame = simulate(48_000, 2.0).unwrap();
        let spectrum = Spectrum::of(std::slice::from_ref(&flame), 48_000);
        let share = spectrum.power(30.0, 180.0) / spectrum.power(1.0, 24_000.0);
        assert!(share > 0.7, "{share} of the power is at 30-180 Hz");
        let rms = (flame.iter().map(|x| f64::from(x * x)).sum::<f64>() / flame.len() as f64).sqrt();
        let peak = flame.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        assert!(f64::from(peak) > 4.0 * rms, "crest {}", f64::from(peak) / rms);
    }
}
