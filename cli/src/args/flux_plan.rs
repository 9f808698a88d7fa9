//! Options of `pyrophone flux-plan`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

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
