//! Options of `pyrophone flux`.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};

use super::sound::SoundArgs;
use super::timeline::TimelineArgs;
use crate::frame_list::FrameList;

/// Options of `pyrophone flux`.
#[derive(Debug, Args)]
#[group(skip)]
#[command(group = ArgGroup::new("upright").args(["speed_field", "listener"]).multiple(true))]
pub struct FluxArgs {
    /// Folder of numbered .vdb, .npz or .npy frames, a pattern for their names (fire.####.vdb), one .vdb or .npz frame,
    /// or a series of flux: CSV, .npy, or a sound file whose samples are the steps
    #[arg(long, value_name = "DIR|FILE")]
    pub input: PathBuf,
    /// Grid of the burning field; `flame` matches any of the usual names
    #[arg(long, value_name = "NAME", default_value = "flame")]
    pub field: String,
    /// Velocity of the gas.
    #[command(flatten)]
    pub velocity: VelocityArgs,
    /// Quantity to measure in each frame
    #[arg(long, value_enum, default_value_t = Measure::Flux)]
    pub measure: Measure,
    /// Value of the field at the flame front [default: 0.5; 0 for a level set]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub iso: Option<f64>,
    /// Subdivisions of each voxel edge, 1-16 [default: 3; 2 or 1 for a large front]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub refine: Option<usize>,
    /// Frames to measure, ends included: 7, 1-100, -5--1, 1-8x2 (every second), 1,5-9
    #[arg(long, value_name = "LIST", value_parser = FrameList::parse, allow_hyphen_values = true)]
    pub frames: Option<FrameList>,
    /// Part of a simulation.
    #[command(flatten)]
    pub partial: PartialArgs,
    /// Interpolate missing or unreadable frames instead of failing
    #[arg(long)]
    pub skip_bad: bool,
    /// Files of the flame fronts.
    #[command(flatten)]
    pub mesh: MeshArgs,
    /// Also write a speed field for vortex sound: the speeds of the gas by place and time
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// Axis of the simulation that points up, for the speed field and the listener
    #[arg(long, value_enum, value_name = "AXIS", default_value_t = UpAxis::Z, requires = "upright")]
    pub up: UpAxis,
    /// Flames apart.
    #[command(flatten)]
    pub clusters: ClusterArgs,
    /// Steps between frames.
    #[command(flatten)]
    pub upsample: UpsampleArgs,
    /// Timeline of the steps.
    #[command(flatten)]
    pub timeline: TimelineArgs,
    /// Conversion of the flux to sound.
    #[command(flatten)]
    pub sound: SoundArgs,
}

/// Options for the velocity.
#[derive(Debug, Args)]
pub struct VelocityArgs {
    /// Grid (or grids) of the velocity; `velocity` matches any of the usual names
    #[arg(id = "velocity", long = "velocity", value_name = "NAME", default_value = "velocity")]
    pub grid: String,
    /// Position of the velocity's components in a voxel
    #[arg(long, value_enum, default_value_t = Placement::Collocated)]
    pub placement: Placement,
    /// Factor that converts the velocity to world units per second [default: 1; 2.5 voxels for Blender's files]
    #[arg(id = "velocity_scale", long = "velocity-scale", value_name = "X", allow_negative_numbers = true)]
    pub scale: Option<f64>,
}

/// Options for measuring a part of a simulation.
#[derive(Debug, Args)]
pub struct PartialArgs {
    /// Write the frames' flux to a part file for flux-merge
    #[arg(id = "partial", long = "partial", value_name = "FILE.csv")]
    pub file: Option<PathBuf>,
    /// Additional data to measure for flux-merge, stored in FILE.csv.extra
    #[arg(
        id = "partial_with",
        long = "partial-with",
        value_enum,
        value_name = "KIND",
        value_delimiter = ',',
        requires = "partial"
    )]
    pub with: Vec<PartialWith>,
    /// Frames of all parts together, for --partial-with [default: all frames]
    #[arg(id = "partial_of", long = "partial-of", value_name = "LIST", value_parser = FrameList::parse, allow_hyphen_values = true, requires = "partial_with")]
    pub of: Option<FrameList>,
}

/// Options for writing flame fronts.
#[derive(Debug, Args)]
pub struct MeshArgs {
    /// Also write the flame fronts: DIR/front_NUMBER.ply
    #[arg(id = "mesh", long = "mesh", value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Write every N-th front
    #[arg(id = "mesh_every", long = "mesh-every", value_name = "N", default_value_t = 1, requires = "mesh", value_parser = clap::value_parser!(u64).range(1..))]
    pub every: u64,
    /// Format of the flame-front files
    #[arg(id = "mesh_kind", long = "mesh-kind", value_enum, value_name = "KIND", default_value_t = MeshKind::Ply, requires = "mesh")]
    pub kind: MeshKind,
}

/// Options for flames with drives of their own.
#[derive(Debug, Args)]
pub struct ClusterArgs {
    /// Also write a drive and its positions for each flame (connected front): DIR/cluster_001.wav and .csv
    #[arg(id = "per_cluster", long = "per-cluster", value_name = "DIR", conflicts_with = "partial")]
    pub folder: Option<PathBuf>,
    /// Number of flames with separate drives, 1-256; the quietest share one
    #[arg(
        id = "clusters",
        long = "clusters",
        value_name = "N",
        default_value_t = 16,
        requires = "per_cluster",
        allow_negative_numbers = true
    )]
    pub count: usize,
    /// Also write all flames as a listener at X,Y,Z hears them, in the files' axes: DIR/ambisonic.wav (first order, AmbiX)
    #[arg(long, value_name = "X,Y,Z", requires = "per_cluster", allow_hyphen_values = true, value_parser = position)]
    pub listener: Option<[f64; 3]>,
}

/// Options for filling in steps.
#[derive(Debug, Args)]
pub struct UpsampleArgs {
    /// Method of filling in steps, up to 360 per second, if the simulation has fewer than 200
    #[arg(id = "upsample", long = "upsample", value_enum, value_name = "UPSAMPLE", default_value_t = Upsample::Auto)]
    pub method: Upsample,
    /// Random seed of the filled-in steps
    #[arg(
        id = "upsample_seed",
        long = "upsample-seed",
        value_name = "N",
        default_value_t = 1,
        allow_negative_numbers = true
    )]
    pub seed: u64,
}

/// Values of `--partial-with`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PartialWith {
    /// The speed field, for flux-merge --speed-field
    SpeedField,
    /// Pictures and details, for flux-merge --report
    Report,
}

/// Values of `--measure`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Measure {
    /// Velocity flux through the flame front
    Flux,
    /// Rate of heat release: the sum of a field such as burn; needs neither front nor velocity
    Release,
    /// Expansion: the sum of the solver's divergence field
    Divergence,
    /// Amount by which the field changes from frame to frame
    Change,
}

/// Values of `--upsample`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Upsample {
    /// flips below 200 steps per second (noise for a series), otherwise off
    Auto,
    /// No filling in
    Off,
    /// As flips, but from the burning field alone
    Release,
    /// Parts of the flame switch from one frame to the next at random times
    Flips,
    /// Noise that falls with frequency, as loud as the flame
    Noise,
    /// A smooth curve through the frames' flux
    Cubic,
}

/// Three numbers separated by commas.
fn position(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').filter_map(|part| part.trim().parse().ok()).collect();
    match <[f64; 3]>::try_from(numbers) {
        Ok(position) if text.split(',').count() == 3 && position.iter().all(|x: &f64| x.is_finite()) => Ok(position),
        _ => Err("give three numbers, such as 0,-3,1.7".to_owned()),
    }
}

/// Values of `--up`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum UpAxis {
    /// As in Houdini
    Y,
    /// As in Blender and the built-in scenes
    Z,
}

/// Values of `--placement`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Placement {
    /// At the centre, regardless of the files
    Collocated,
    /// On the lower faces, regardless of the files
    Staggered,
    /// As the files say
    File,
}

/// Values of `--mesh-kind`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum MeshKind {
    /// Stanford PLY, binary
    Ply,
    /// Wavefront OBJ, text
    Obj,
}

impl MeshKind {
    /// File name extension.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Obj => "obj",
        }
    }
}
