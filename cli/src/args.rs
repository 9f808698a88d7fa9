//! The command line: its flags are a promise to scripts.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args, Parser, Subcommand, ValueEnum};
use pyrophone_flame::scenes::Scene;
use pyrophone_settings::Id;

use crate::film_time::{FilmRate, Timecode};
use crate::frame_list::FrameList;

/// Turns a low-frequency flame signal into the full-band sound of fire.
///
/// Reads WAV, AIFF, CAF, FLAC, Ogg Vorbis and MP3 files, or WAV from standard input (`-`). Writes 32-bit float WAV at
/// the input's sample rate and length, neither normalised nor dithered; 24-bit FLAC if the output's name ends in .flac;
/// WAV to standard output if it is `-`.
#[derive(Debug, Parser)]
#[command(name = "pyrophone", version = env!("PYROPHONE_VERSION"), subcommand_required = true, arg_required_else_help = false)]
#[command(after_help = EXIT_CODES)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
    /// Print a JSON summary to standard output, or to standard error if the sound goes to standard output
    #[arg(long, global = true, display_order = 900)]
    pub json: bool,
    /// Format of progress reports
    #[arg(long, global = true, value_enum, value_name = "KIND", default_value_t = Progress::Auto, hide = true)]
    pub progress: Progress,
    /// Print errors only, without progress or notes
    #[arg(long, short, global = true, display_order = 901)]
    pub quiet: bool,
}

/// Values of `--progress`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Progress {
    /// A bar on a terminal, an occasional line elsewhere
    Auto,
    /// Lines for Open Job Description's engines: openjd_progress: 42
    Openjd,
}

/// Exit codes, for scripts.
const EXIT_CODES: &str = "Exit codes: 0: success, the output was written. 1: failure; one line on standard error gives \
    the reason, and no partial output is left. 2: invalid command line. Ctrl-C (130), SIGTERM (143) and SIGHUP (129) stop \
    the command: it cleans up and then ends by that signal, so that shell loops stop too.";

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run the published texture synthesis: offline, exact, ungated, levels unchanged
    Texture(TextureArgs),
    /// Extend a flame signal's spectrum with noise
    Extend(ExtendArgs),
    /// Render through the plug-in's whole signal chain
    Render(RenderArgs),
    /// Measure a simulation's flame signal: flux through the flame front, frame by frame, and its pressure
    Flux(Box<FluxArgs>),
    /// Merge parts written by `flux --partial` into one flame signal
    FluxMerge(FluxMergeArgs),
    /// Write a render-farm job that measures a simulation in parts and merges them
    FluxPlan(FluxPlanArgs),
    /// Simulate a built-in scene and write its flame signal
    Simulate(SimulateArgs),
    /// Record a vortex-sound texture: the sound of a small turbulent region over a range of flow speeds
    VortexTexture(VortexTextureArgs),
    /// List the factory presets and your own
    Presets,
    /// List all parameters, for presets, automation and --set, with their ranges
    Parameters,
    /// Write shell completions to standard output
    Completions(CompletionsArgs),
    /// Write manual pages, one for each command
    Man(ManArgs),
}

/// Options of `pyrophone completions`.
#[derive(Debug, Args)]
pub struct CompletionsArgs {
    /// Shell to write completions for
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// Options of `pyrophone man`.
#[derive(Debug, Args)]
pub struct ManArgs {
    /// Folder to write to; created if it does not exist
    #[arg(long, value_name = "DIR")]
    pub output: PathBuf,
}

/// Options of `pyrophone texture`.
#[derive(Debug, Args)]
pub struct TextureArgs {
    /// Flame signal; several channels are averaged
    #[arg(long, value_name = "IN.wav")]
    pub input: PathBuf,
    /// Fire recording to learn from, resampled to the input's rate; it also sets the number of output channels
    #[arg(long, visible_alias = "recording", value_name = "T.wav")]
    pub training: PathBuf,
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// Pyramid levels, 3-8
    #[arg(long, value_name = "N", default_value_t = 6, allow_negative_numbers = true)]
    pub levels: usize,
    /// Half-width of a window in samples of its level, 2-16
    #[arg(long, value_name = "N", default_value_t = 4, allow_negative_numbers = true)]
    pub window: usize,
    /// Half-width of a feature in windows, 1-6
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true)]
    pub feature: usize,
    /// Falloff of the weights exp(-falloff * distance) of a feature's samples, 0-1
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_negative_numbers = true)]
    pub falloff: f64,
    /// Leave the recording's dynamic range unchanged
    #[arg(long)]
    pub no_dynamic_range: bool,
    /// Degree to which the recording's dynamic range is mapped onto the input's, 0-1
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub scaling_alpha: f64,
    /// Tolerance of the search: accepts windows up to (1 + eps) times as distant as the nearest; 0 is exact
    #[arg(long, value_name = "X", default_value_t = 0.0, allow_negative_numbers = true)]
    pub eps: f64,
}

/// Options of `pyrophone extend`.
#[derive(Debug, Args)]
pub struct ExtendArgs {
    /// Flame signal; its channels are averaged, and the output has the same number
    #[arg(long, value_name = "IN.wav")]
    pub input: PathBuf,
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// Slope of the noise, whose power falls as frequency^(-alpha), 0-6
    #[arg(long, value_name = "X", default_value_t = 2.5, allow_negative_numbers = true)]
    pub alpha: f64,
    /// Corner frequency of the envelope's low-pass [default: 180]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub cutoff: Option<f64>,
    /// Half-width of a window in samples (without --reference: at 44.1 kHz, 100-2000)
    #[arg(long, value_name = "N", default_value_t = 500, allow_negative_numbers = true)]
    pub half_width: usize,
    /// Centre of the band in which the noise is fitted [default: 180 with --reference, else the cutoff]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub fit_center: Option<f64>,
    /// Width of that band, three standard deviations
    #[arg(long, value_name = "HZ", default_value_t = 30.0, allow_negative_numbers = true)]
    pub fit_width: f64,
    /// Frequency where the input starts to fade [default: 165 with --reference, else the cutoff - 15]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub blend_start: Option<f64>,
    /// Frequency where the input has faded out [default: 195 with --reference, else the cutoff + 15]
    #[arg(long, value_name = "HZ", allow_negative_numbers = true)]
    pub blend_end: Option<f64>,
    /// Gain factor of the fitted noise
    #[arg(long, value_name = "X", default_value_t = 1.0, allow_negative_numbers = true)]
    pub noise_amplitude: f64,
    /// Noise seed
    #[arg(long, value_name = "N", default_value_t = 42, allow_negative_numbers = true)]
    pub seed: u64,
    /// Also write each window's fitted factor, as window,time_s,beta
    #[arg(long, value_name = "FILE.csv")]
    pub betas: Option<PathBuf>,
    /// Compute as published: over the whole signal at once, 6.02 dB lower
    #[arg(long)]
    pub reference: bool,
}

/// Options of `pyrophone render`.
#[derive(Debug, Args)]
#[group(skip)]
#[command(group = ArgGroup::new("length").args(["input", "seconds"]).required(true).multiple(false))]
pub struct RenderArgs {
    /// Factory preset or one of your own, by name or title in any case (`pyrophone presets` lists them), or a preset
    /// file
    #[arg(long, value_name = "FILE|NAME")]
    pub preset: String,
    /// Main input
    #[arg(long, value_name = "IN.wav")]
    pub input: Option<PathBuf>,
    /// Length of the output, in place of --input, for presets that need no input, 0.01-3600
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub seconds: Option<f64>,
    /// Sample rate of the output, with --seconds
    #[arg(long, value_name = "HZ", default_value_t = 48_000, requires = "seconds", conflicts_with = "input")]
    pub sample_rate: u32,
    /// Sound whose envelope drives the engines, with drive_mode=envelope
    #[arg(long, value_name = "S.wav")]
    pub sidechain: Option<PathBuf>,
    /// Fire recording for texture to learn from
    #[arg(long, visible_alias = "recording", value_name = "T.wav")]
    pub training: Option<PathBuf>,
    /// Part of the recording to learn from, in seconds
    #[arg(long, alias = "recording-region", value_name = "START-END", requires = "training", value_parser = region)]
    pub training_region: Option<[f64; 2]>,
    /// Gain of the recording in dB
    #[arg(
        long,
        alias = "recording-gain",
        value_name = "DB",
        default_value_t = 0.0,
        requires = "training",
        allow_negative_numbers = true
    )]
    pub training_gain: f64,
    /// Normalise the selected part of the recording to full scale first
    #[arg(long, alias = "recording-normalise", requires = "training")]
    pub training_normalise: bool,
    /// Second fire recording, in slot 2: --set recording_blend=50 mixes half of it in, recording_slot=2 plays it alone
    #[arg(long, value_name = "B.wav")]
    pub recording_b: Option<PathBuf>,
    /// Source of the input's loudness distribution, instead of the preset's choice
    #[arg(long, value_enum)]
    pub dynamic_range: Option<DynamicRange>,
    /// File to learn that distribution from, instead of a first pass over the input
    #[arg(long, value_name = "FILE.wav")]
    pub learn: Option<PathBuf>,
    /// Parameter automation: rows of time_s,id,value or sample,id,value, optionally with ,curve (step or linear)
    #[arg(long, value_name = "FILE.csv")]
    pub automation: Option<PathBuf>,
    /// Speed field for vortex sound, written by simulate or flux; used while vortex_flow is field
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// Parameter to set after loading the preset; may be repeated
    #[arg(long = "set", value_name = "id=value")]
    pub settings: Vec<String>,
    /// Number of output channels [default: as the input; 2 without one]
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub channels: Option<usize>,
}

/// Reads a time range in seconds, as in `1.5-4`.
fn region(text: &str) -> Result<[f64; 2], String> {
    let parts =
        text.split_once('-').and_then(|(start, end)| Some([start.trim().parse().ok()?, end.trim().parse().ok()?]));
    match parts {
        Some([start_s, end_s]) if start_s >= 0.0 && start_s < end_s && end_s < f64::INFINITY => Ok([start_s, end_s]),
        _ => Err("it must be START-END in seconds, as in 1.5-4".to_owned()),
    }
}

/// Values of `--dynamic-range`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DynamicRange {
    /// No mapping
    Off,
    /// From --learn, or from a first pass over the input
    Learned,
    /// Estimated during playback
    Running,
}

impl DynamicRange {
    /// The parameter's id and the text of this value.
    pub fn as_setting(self) -> (&'static str, &'static str) {
        let text = match self {
            Self::Off => "off",
            Self::Learned => "learned",
            Self::Running => "running",
        };
        (Id::DynamicRange.parameter().id, text)
    }
}

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
    /// Grid (or grids) of the velocity; `velocity` matches any of the usual names
    #[arg(long, value_name = "NAME", default_value = "velocity")]
    pub velocity: String,
    /// Position of the velocity's components in a voxel
    #[arg(long, value_enum, default_value_t = Placement::Collocated)]
    pub placement: Placement,
    /// Factor that converts the velocity to world units per second [default: 1; 2.5 voxels for Blender's files]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub velocity_scale: Option<f64>,
    /// Quantity to measure in each frame
    #[arg(long, value_enum, default_value_t = Measure::Flux)]
    pub measure: Measure,
    /// Value of the field at the flame front [default: 0.5; 0 for a level set]
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    pub iso: Option<f64>,
    /// Subdivisions of each voxel edge, 1-16
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true)]
    pub refine: usize,
    /// Frames to measure, ends included: 7, 1-100, -5--1, 1-8x2 (every second), 1,5-9
    #[arg(long, value_name = "LIST", value_parser = FrameList::parse, allow_hyphen_values = true)]
    pub frames: Option<FrameList>,
    /// Write the frames' flux to a part file for flux-merge
    #[arg(long, value_name = "FILE.csv")]
    pub partial: Option<PathBuf>,
    /// Additional data to measure for flux-merge, stored in FILE.csv.extra
    #[arg(long, value_enum, value_name = "KIND", value_delimiter = ',', requires = "partial")]
    pub partial_with: Vec<PartialWith>,
    /// Frames of all parts together, for --partial-with [default: all frames]
    #[arg(long, value_name = "LIST", value_parser = FrameList::parse, allow_hyphen_values = true, requires = "partial_with")]
    pub partial_of: Option<FrameList>,
    /// Interpolate missing or unreadable frames instead of failing
    #[arg(long)]
    pub skip_bad: bool,
    /// Also write the flame fronts: DIR/front_NUMBER.ply
    #[arg(long, value_name = "DIR")]
    pub mesh: Option<PathBuf>,
    /// Write every N-th front
    #[arg(long, value_name = "N", default_value_t = 1, requires = "mesh", value_parser = clap::value_parser!(u64).range(1..))]
    pub mesh_every: u64,
    /// Format of the flame-front files
    #[arg(long, value_enum, value_name = "KIND", default_value_t = MeshKind::Ply, requires = "mesh")]
    pub mesh_kind: MeshKind,
    /// Also write a speed field for vortex sound: the speeds of the gas by place and time
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// Axis of the simulation that points up, for the speed field and the listener
    #[arg(long, value_enum, value_name = "AXIS", default_value_t = UpAxis::Z, requires = "upright")]
    pub up: UpAxis,
    /// Also write a drive and its positions for each flame (connected front): DIR/cluster_001.wav and .csv
    #[arg(long, value_name = "DIR", conflicts_with = "partial")]
    pub per_cluster: Option<PathBuf>,
    /// Number of flames with separate drives, 1-256; the quietest share one
    #[arg(long, value_name = "N", default_value_t = 16, requires = "per_cluster", allow_negative_numbers = true)]
    pub clusters: usize,
    /// Also write all flames as a listener at X,Y,Z hears them, in the files' axes: DIR/ambisonic.wav (first order, AmbiX)
    #[arg(long, value_name = "X,Y,Z", requires = "per_cluster", allow_hyphen_values = true, value_parser = position)]
    pub listener: Option<[f64; 3]>,
    /// Method of filling in steps, up to 360 per second, if the simulation has fewer than 200
    #[arg(long, value_enum, default_value_t = Upsample::Auto)]
    pub upsample: Upsample,
    /// Random seed of the filled-in steps
    #[arg(long, value_name = "N", default_value_t = 1, allow_negative_numbers = true)]
    pub upsample_seed: u64,
    /// Timeline of the steps.
    #[command(flatten)]
    pub timeline: TimelineArgs,
    /// Conversion of the flux to sound.
    #[command(flatten)]
    pub sound: SoundArgs,
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
    /// flips below 200 steps per second, otherwise off
    Auto,
    /// No filling in
    Off,
    /// As flips, but from the burning field alone
    Release,
    /// Parts of the flame switch from one frame to the next at random times
    Flips,
    /// Noise that falls with frequency and scales with the change between frames
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

/// Options of `pyrophone flux-plan`.
#[derive(Debug, Args)]
pub struct FluxPlanArgs {
    /// Folder of numbered frames, or a pattern for their names
    #[arg(long, value_name = "DIR")]
    pub input: PathBuf,
    /// Frames per part
    #[arg(long, value_name = "N", default_value_t = 30, allow_negative_numbers = true)]
    pub chunk: u64,
    /// Scheduler that runs the job
    #[arg(long, value_enum)]
    pub format: FarmFormat,
    /// Sound file that the job writes; its parts go to a folder beside it
    #[arg(long, value_name = "OUT.wav")]
    pub output: PathBuf,
    /// File to write the job to [default: standard output]
    #[arg(long, value_name = "FILE")]
    pub job: Option<PathBuf>,
    /// Frames per second, passed to flux
    #[arg(long, value_name = "HZ")]
    pub rate: Option<String>,
    /// Interpolate missing or unreadable frames, passed to flux
    #[arg(long)]
    pub skip_bad: bool,
    /// Option to pass to flux-merge, as in --merge-option=--peak-db=-12; may be repeated
    #[arg(long = "merge-option", value_name = "OPTION", allow_hyphen_values = true)]
    pub merge_options: Vec<String>,
    /// Speed field for the job to write as well
    #[arg(long, value_name = "FILE.field")]
    pub speed_field: Option<PathBuf>,
    /// Folder of a report for the job to write as well
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Further options to pass to flux, after --
    #[arg(last = true, value_name = "FLUX OPTIONS")]
    pub flux_options: Vec<String>,
}

/// Values of `flux-plan --format`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum FarmFormat {
    /// Open Job Description with chunks of tasks: AWS Deadline Cloud, `openjd run`
    Openjd,
    /// A script that submits a job array, and a merge job that waits for it
    Slurm,
    /// A script that runs the parts one after another
    Shell,
}

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

/// Options for turning flux into sound.
#[derive(Debug, Args)]
pub struct SoundArgs {
    /// File to write
    #[arg(long, value_name = "OUT.wav")]
    pub output: Option<PathBuf>,
    /// Sample rate of the output
    #[arg(long, value_name = "HZ", default_value_t = 44_100, allow_negative_numbers = true)]
    pub sample_rate: u32,
    /// Signal to write
    #[arg(long = "as", value_enum, default_value_t = SoundKind::Pressure)]
    pub kind: SoundKind,
    /// Level of the loudest sample, -100 to 0
    #[arg(long, value_name = "DB", default_value_t = -6.0, allow_negative_numbers = true)]
    pub peak_db: f64,
    /// File with the scale shared by all flames of a shot, instead of --peak-db; the first flame writes it
    #[arg(long, value_name = "FILE", conflicts_with = "peak_db")]
    pub scale_file: Option<PathBuf>,
    /// Corner frequency of the pressure's high-pass, 0-1000; 0 turns it off
    #[arg(long, value_name = "HZ", default_value_t = 30.0, allow_negative_numbers = true)]
    pub high_pass: f64,
    /// Position of the first sample on the timeline, for the file's BWF time stamp
    #[arg(long, value_name = "SAMPLES")]
    pub time_reference: Option<u64>,
    /// Also write each frame's flux and area, as frame,flux,area
    #[arg(long, value_name = "FILE.csv")]
    pub flux_csv: Option<PathBuf>,
    /// Also write a report with pictures and figures: DIR/index.html
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
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

/// Values of `--as`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SoundKind {
    /// The flux's derivative, high-passed: the low-frequency sound
    Pressure,
    /// The flux's magnitude, smoothed: an envelope for the plug-in's envelope drive
    Envelope,
}

/// Reads frames per second: `24`, `23.976`, `24000/1001`.
fn rate(text: &str) -> Result<f64, String> {
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| format!("'{text}' is not a number"));
    match text.split_once('/') {
        Some((frames, seconds)) => Ok(number(frames)? / number(seconds)?),
        None => number(text),
    }
}

/// Options for the timeline of a flux signal's steps.
#[derive(Debug, Clone, Args)]
pub struct TimelineArgs {
    /// Frames per second of simulated time [default: as stated by the frames or the series]
    #[arg(long, value_name = "HZ", value_parser = rate, allow_hyphen_values = true)]
    pub rate: Option<f64>,
    /// Frame number at which the timeline starts, instead of --time-reference
    #[arg(long, value_name = "FRAME", conflicts_with = "time_reference", allow_negative_numbers = true)]
    pub start_frame: Option<i64>,
    /// Frames per second of the film; positions are then in film frames, and the rate is written to iXML
    #[arg(long, value_name = "HZ", value_parser = FilmRate::parse, conflicts_with_all = ["start_frame", "time_reference"])]
    pub film_rate: Option<FilmRate>,
    /// Film frame of the simulation's first frame [default: its own number, if both rates are the same]
    #[arg(long, value_name = "FRAME", requires = "film_rate", allow_negative_numbers = true)]
    pub film_frame: Option<i64>,
    /// Film frame at which the timeline starts
    #[arg(long, value_name = "FRAME", default_value_t = 0, requires = "film_rate", allow_negative_numbers = true)]
    pub timeline_start: i64,
    /// Timecode of the timeline's start, such as 01:00:00:00; drop-frame: 01:00:00;00
    #[arg(long, value_name = "HH:MM:SS:FF", value_parser = Timecode::parse, requires = "film_rate")]
    pub timecode: Option<Timecode>,
    /// Retiming curve: rows of film frame,simulation frame
    #[arg(long, value_name = "FILE.csv", requires = "film_rate", conflicts_with = "film_frame")]
    pub retime: Option<PathBuf>,
    /// Name of the scene, for iXML
    #[arg(long, value_name = "NAME")]
    pub scene: Option<String>,
    /// Name of the take, for iXML
    #[arg(long, value_name = "NAME")]
    pub take: Option<String>,
    /// Write the date and time to the file, which then differs from run to run
    #[arg(long)]
    pub dated: bool,
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
    /// Subdivisions of each voxel edge for finding the front, 1-16
    #[arg(long, value_name = "N", default_value_t = 3, allow_negative_numbers = true)]
    pub refine: usize,
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

/// Parser of scene names.
fn scenes() -> impl TypedValueParser<Value = Scene> {
    let named = Scene::ALL.map(|scene| PossibleValue::new(scene.name()).help(scene.summary()));
    PossibleValuesParser::new(named).try_map(|name| Scene::from_name(&name).ok_or("there is no such scene"))
}
