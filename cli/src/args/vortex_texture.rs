//! Options of `pyrophone vortex-texture`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Options of `pyrophone vortex-texture`.
#[derive(Debug, Args)]
pub struct VortexTextureArgs {
    /// Flow speeds in m/s, 0.1-100, in geometric steps; one row each, 1-256
    #[arg(long, value_name = "LOW:HIGH:COUNT", value_parser = speeds)]
    pub speeds: (f64, f64, usize),
    /// Period of the rows, 0.25-60
    #[arg(long, value_name = "S", default_value_t = 4.0, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Voxels of the box, vertical axis last, 8-128 each
    #[arg(long, value_name = "NXxNYxNZ", default_value = "16x16x24", value_parser = voxels)]
    pub voxels: [usize; 3],
    /// Edge of a voxel in m, 0.001-0.2
    #[arg(long, value_name = "M", default_value_t = 0.02, allow_negative_numbers = true)]
    pub voxel_size: f64,
    /// Inflow at the bottom
    #[arg(long, value_enum, default_value_t = FlowKind::Fire)]
    pub kind: FlowKind,
    /// Random part of the inflow, 0-1
    #[arg(long, value_name = "X", default_value_t = 0.1, allow_negative_numbers = true)]
    pub perturbation: f64,
    /// Steps per second of the rows, 2000-16000
    #[arg(long, value_name = "HZ", default_value_t = 4_000.0, allow_negative_numbers = true)]
    pub rate: f64,
    /// Random seed
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub seed: u64,
    /// Integrate as published, over the 27 voxels around each one; these cancel except at the sides of the box
    #[arg(long)]
    pub paper: bool,
    /// File to write
    #[arg(long, value_name = "OUT.vtx")]
    pub output: PathBuf,
}

/// Values of `--kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FlowKind {
    /// A uniform flow with random perturbations
    Wind,
    /// The same with hot, rising gas
    Fire,
    /// A narrow, fast flow in the middle
    Jet,
}

/// Reads `LOW:HIGH:COUNT`.
fn speeds(text: &str) -> Result<(f64, f64, usize), String> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [low, high, count] = parts[..] else {
        return Err("it must be LOW:HIGH:COUNT, as in 1:16:12".into());
    };
    let speed = |text: &str| text.parse().map_err(|_| format!("'{text}' is not a speed"));
    Ok((speed(low)?, speed(high)?, count.parse().map_err(|_| format!("'{count}' is not a number of rows"))?))
}

/// Reads `NXxNYxNZ`.
fn voxels(text: &str) -> Result<[usize; 3], String> {
    let sizes: Result<Vec<usize>, _> = text.split('x').map(|size| size.trim().parse()).collect();
    sizes.ok().and_then(|sizes| sizes.try_into().ok()).ok_or("it must be NXxNYxNZ, as in 16x16x24".into())
}
