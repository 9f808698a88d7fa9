//! Options of `pyrophone simulate`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use pyrophone_flame::scenes::Scene;

use super::sound::SoundArgs;

/// Options of `pyrophone simulate`.
#[derive(Debug, Args)]
pub struct SimulateArgs {
    /// Scene to simulate
    #[arg(value_name = "SCENE", value_parser = scenes())]
    pub scene: Scene,
    /// Length of the signal, 0.01-3600
    #[arg(long, value_name = "S", default_value_t = 5.0, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Voxels along the longest side of the box, 8-512, rounded to a multiple of 8 (below 32, of 2) [default: 64]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub resolution: Option<usize>,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Amount and speed of the fuel, 0-4
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub intensity: f64,
    /// Strength of the wind, and of the burning object's motion, 0-4
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub wind: f64,
    /// Strength of the turbulence, 0-4
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub turbulence: f64,
    /// Seconds to simulate before the signal starts, 0-60 [default: 0.5; 0 for flame_jet and explosion]
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub pre_roll: Option<f64>,
    /// Subdivisions of each voxel edge for finding the front, 1-16 [default: 3; 2 or 1 for a large front]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub refine: Option<usize>,
    /// Also write every frame, for `pyrophone flux` and other programs: DIR/SCENE_NUMBER.npz
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// Also write a speed field for vortex sound: the speeds of the gas by place and time
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// Conversion of the flux to sound.
    #[command(flatten)]
    pub sound: SoundArgs,
}

/// Parser of scene names.
fn scenes() -> impl TypedValueParser<Value = Scene> {
    let named = Scene::ALL.map(|scene| PossibleValue::new(scene.name()).help(scene.summary()));
    PossibleValuesParser::new(named).try_map(|name| Scene::from_name(&name).ok_or("there is no such scene"))
}
