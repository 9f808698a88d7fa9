//! Options of `pyrophone flux-merge`.

use std::path::PathBuf;

use clap::Args;

use super::flux::UpAxis;
use super::sound::SoundArgs;
use super::timeline::TimelineArgs;

/// Options of `pyrophone flux-merge`.
#[derive(Debug, Args)]
pub struct FluxMergeArgs {
    /// Parts written by flux --partial, in any order, or folders that hold them
    #[arg(value_name = "SHARD", required = true)]
    pub shards: Vec<PathBuf>,
    /// Also write a speed field, from parts measured with --partial-with speed-field
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// Axis of the simulation that points up, for the speed field
    #[arg(long, value_enum, value_name = "AXIS", default_value_t = UpAxis::Z, requires = "speed_field")]
    pub up: UpAxis,
    /// Timeline of the steps.
    #[command(flatten)]
    pub timeline: TimelineArgs,
    /// Conversion of the flux to sound.
    #[command(flatten)]
    pub sound: SoundArgs,
}
