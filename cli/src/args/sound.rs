//! Options for turning flux into sound, shared by commands.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

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

/// Values of `--as`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SoundKind {
    /// The flux's derivative, high-passed: the low-frequency sound
    Pressure,
    /// The flux's magnitude, smoothed: an envelope for the plug-in's envelope drive
    Envelope,
}
