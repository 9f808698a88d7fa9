//! Options of `pyrophone render`.

use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};
use pyrophone_settings::Id;

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
    /// Recording to learn from.
    #[command(flatten)]
    pub training: TrainingArgs,
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

/// Options for the recording.
#[derive(Debug, Args)]
pub struct TrainingArgs {
    /// Fire recording for texture to learn from, or a factory fire such as factory:hearth [default: the one that the preset
    /// names, if any]
    #[arg(id = "training", long = "training", visible_alias = "recording", value_name = "T.wav")]
    pub file: Option<PathBuf>,
    /// Part of the recording to learn from, in seconds
    #[arg(id = "training_region", long = "training-region", alias = "recording-region", value_name = "START-END", requires = "training", value_parser = region)]
    pub region: Option<[f64; 2]>,
    /// Gain of the recording in dB
    #[arg(
        id = "training_gain",
        long = "training-gain",
        alias = "recording-gain",
        value_name = "DB",
        default_value_t = 0.0,
        requires = "training",
        allow_negative_numbers = true
    )]
    pub gain_db: f64,
    /// Normalise the selected part of the recording to full scale first
    #[arg(
        id = "training_normalise",
        long = "training-normalise",
        alias = "recording-normalise",
        requires = "training"
    )]
    pub normalise: bool,
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
