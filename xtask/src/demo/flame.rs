//! A flame's pressure for users without one: simulated here, at a resolution that needs less than a minute.

use anyhow::Result;
use pyrophone_flame::pressure::{self, Options as PressureOptions};
use pyrophone_flame::scenes::{Options, Scene};

use crate::simulated::{self, RESOLUTION};

/// The scene: its blasts and pauses show how well a result follows the flame.
pub const SCENE: Scene = Scene::Dragon;

/// Length of the demo's signal in seconds.
pub const SECONDS: f64 = 8.0;

/// Pressure of a simulated flame over `seconds`, mono.
pub fn simulate(sample_rate_hz: u32, seconds: f64) -> Result<Vec<f32>> {
    simulate_at(RESOLUTION, sample_rate_hz, seconds)
}

fn simulate_at(resolution: usize, sample_rate_hz: u32, seconds: f64) -> Result<Vec<f32>> {
    let options = Options { resolution, ..Options::default() };
    let flux = simulated::flux(SCENE, options, SCENE.default_pre_roll_s(), seconds, "a flame")?;
    Ok(pressure::render(&flux, &PressureOptions { sample_rate_hz, ..PressureOptions::default() })?.samples)
}

#[cfg(test)]
mod tests {
    use super::*;
    use pyrophone_analysis::Spectrum;

    #[test]
    fn the_flame_is_low_and_bursty() {
        // Coarser than what is shown, which takes minutes.
        let flame = simulate_at(RESOLUTION / 2, 48_000, 2.0).unwrap();
        let spectrum = Spectrum::of_channels(std::slice::from_ref(&flame), 48_000);
        let share = spectrum.power(30.0, 180.0) / spectrum.power(1.0, 24_000.0);
        assert!(share > 0.7, "{share} of the power is at 30-180 Hz");
        let rms = (flame.iter().map(|x| f64::from(x * x)).sum::<f64>() / flame.len() as f64).sqrt();
        let peak = flame.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        assert!(f64::from(peak) > 4.0 * rms, "crest {}", f64::from(peak) / rms);
    }
}
