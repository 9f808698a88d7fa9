//! The command line: its flags are a promise to scripts.

mod extend;
mod flux;
mod flux_merge;
mod flux_plan;
#[cfg(windows)]
mod install;
mod render;
mod shell;
mod simulate;
mod sound;
mod texture;
mod timeline;
mod vortex_texture;

use clap::{Parser, Subcommand, ValueEnum};

pub use extend::ExtendArgs;
pub use flux::{FluxArgs, Measure, MeshKind, PartialWith, Placement, UpAxis, Upsample};
pub use flux_merge::FluxMergeArgs;
pub use flux_plan::{FarmFormat, FluxPlanArgs};
#[cfg(windows)]
pub use install::InstallArgs;
pub use render::{DynamicRange, RenderArgs};
pub use shell::{CompletionsArgs, ManArgs};
pub use simulate::SimulateArgs;
pub use sound::{SoundArgs, SoundKind};
pub use texture::TextureArgs;
pub use timeline::TimelineArgs;
pub use vortex_texture::{FlowKind, VortexTextureArgs};

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
    /// Install plug-in, program and presets from the unpacked package that this program lies in
    #[cfg(windows)]
    Install(InstallArgs),
    /// Remove what `install` has put in place
    #[cfg(windows)]
    Uninstall(InstallArgs),
}
