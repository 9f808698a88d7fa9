//! Main input of the chain: a file, standard input, or silence of a given length.

use std::path::{Path, PathBuf};

use pyrophone_recording::{Broadcast, MAX_SAMPLES, MAX_SECONDS, Recording};
use pyrophone_settings::table::DRIVE_MODES;
use pyrophone_settings::{Automation, Id, Values};

use crate::args::RenderArgs;
use crate::error::Error;
use crate::input::{self, in_range};
use crate::progress::Work;

/// Shortest length allowed for `--seconds`.
const LEAST_SECONDS: f64 = 0.01;

/// Channels of an output without an input: a stereo track, as in a host.
const CHANNELS: usize = 2;

/// The main input.
pub struct Source {
    /// Its sound.
    pub recording: Recording,
    /// Timeline position that its file states.
    pub broadcast: Option<Broadcast>,
    /// Its name in messages.
    pub name: PathBuf,
}

impl Source {
    /// Reads `--input`, or generates silence for `--seconds`.
    pub fn load(args: &RenderArgs, values: &Values, automation: &Automation, work: &Work) -> Result<Self, Error> {
        let Some(path) = &args.input else {
            return Self::silence(args, values, automation);
        };
        let (recording, broadcast) = input::load_with_time_reference(path, work)?;
        input::check_rate(&recording, path)?;
        Ok(Self { recording, broadcast, name: path.clone() })
    }

    fn silence(args: &RenderArgs, values: &Values, automation: &Automation) -> Result<Self, Error> {
        let seconds = args.seconds.unwrap_or_default();
        in_range("--seconds", seconds, LEAST_SECONDS, f64::from(MAX_SECONDS))?;
        in_range("--sample-rate", f64::from(args.sample_rate), 8_000.0, 384_000.0)?;
        check_needs_none(args, values, automation)?;
        let channels = args.channels.unwrap_or(CHANNELS).clamp(1, CHANNELS);
        let samples = ((seconds * f64::from(args.sample_rate)).round() as usize).max(1);
        let total = samples.saturating_mul(args.channels.unwrap_or(CHANNELS).max(1));
        if total > MAX_SAMPLES {
            let message = format!(
                "--seconds {seconds} makes {total} samples over all channels, but at most {MAX_SAMPLES} are allowed; choose fewer seconds or channels, or a lower rate"
            );
            return Err(Error::Conflict(message));
        }
        let recording = Recording {
            channels: vec![vec![0.0; samples]; channels],
            sample_rate_hz: args.sample_rate,
            name: "--seconds".into(),
            content_hash: String::new(),
            notes: vec![],
        };
        Ok(Self { recording, broadcast: None, name: Path::new("--seconds").to_owned() })
    }
}

/// Rejects settings that would be silent without an input.
fn check_needs_none(args: &RenderArgs, values: &Values, automation: &Automation) -> Result<(), Error> {
    let sounds = |mode: f64| match DRIVE_MODES.get(mode as usize) {
        Some(&"flame") => true,
        Some(&"envelope") => args.sidechain.is_some(),
        _ => false,
    };
    let events = automation.events(f64::from(args.sample_rate));
    let mut modes = events.iter().filter(|event| event.parameter == Id::DriveMode as usize);
    let mode = values.get(Id::DriveMode);
    if sounds(mode) || modes.any(|event| sounds(event.value)) {
        return Ok(());
    }
    Err(Error::Conflict(format!(
        "--seconds replaces the input, but preset {} needs one (its drive_mode is {}); add --input, or --set drive_mode=flame",
        args.preset,
        Id::DriveMode.parameter().to_text(mode)
    )))
}
