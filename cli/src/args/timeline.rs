//! Options for the timeline of a flux signal, shared by commands.

use std::path::PathBuf;

use clap::Args;

use crate::film_time::{FilmRate, Timecode};

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
