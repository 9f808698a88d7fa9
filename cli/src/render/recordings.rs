//! The recordings that the engines learn from: `--training`, otherwise the preset's own, and `--recording-b`.

use std::path::{Path, PathBuf};

use pyrophone_recording::{Cut, Recording};
use pyrophone_settings::{Id, Preset, Values};
use pyrophone_synthesis::chain::Chain;
use pyrophone_training::IMPULSIVE;

use super::training;
use crate::args::RenderArgs;
use crate::error::Error;
use crate::input;
use crate::progress::{Work, note};

/// Slot of `--recording-b`.
const SECOND: usize = 1;

/// Recordings by slot.
pub struct Recordings(Vec<Given>);

/// A recording for one slot.
struct Given {
    slot: usize,
    path: PathBuf,
    cut: Cut,
    /// Where its region was stated, for messages.
    region: &'static str,
    /// True if the preset names it.
    is_presets: bool,
}

impl Recordings {
    /// Recordings from the options, and the preset's if there is no `--training`.
    pub fn new(args: &RenderArgs, preset: &Preset, values: &Values) -> Self {
        let first = match (&args.training.file, &preset.recording) {
            (Some(path), _) => {
                let (region_s, gain_db) = (args.training.region, args.training.gain_db);
                let cut = Cut { region_s, gain_db, normalise: args.training.normalise };
                Some(Given { slot: 0, path: path.clone(), cut, region: "--training-region", is_presets: false })
            }
            (None, Some(recording)) => {
                let pyrophone_settings::session::Cut { region_s, gain_db, normalise } = recording.cut;
                let (slot, cut) = (values.get(Id::RecordingSlot) as usize, Cut { region_s, gain_db, normalise });
                let path = recording.file.clone();
                Some(Given { slot, path, cut, region: "the preset's region_s", is_presets: true })
            }
            (None, None) => None,
        };
        let second = args.recording_b.clone().map(|path| {
            let cut = Cut::default();
            Given { slot: SECOND, path, cut, region: "", is_presets: false }
        });
        // What was asked for explicitly wins.
        let first = first.filter(|first| second.as_ref().is_none_or(|second| second.slot != first.slot));
        Self(first.into_iter().chain(second).collect())
    }

    /// Files that are read.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.0.iter().map(|given| given.path.as_path())
    }

    /// True if there is one besides `--recording-b`.
    pub fn has_first(&self) -> bool {
        self.0.iter().any(|given| given.is_presets || given.slot != SECOND)
    }

    /// Loads the recordings into the engines.
    pub fn load(&self, chain: &mut Chain, values: &Values, work: &Work) -> Result<(), Error> {
        let (rate_hz, structure) = (chain.sample_rate_hz(), values.structure());
        for Given { slot, path, cut, region, is_presets } in &self.0 {
            let recording = input::load(path, work).map_err(|error| match error {
                Error::Recording(error) if *is_presets => {
                    let message =
                        format!("the preset's recording cannot be used: {error}; or give one with --training");
                    Error::Conflict(message)
                }
                error => error,
            })?;
            check_region(cut.region_s, region, &recording, path)?;
            let dictionary = training::dictionary(&recording, path, cut, rate_hz, &structure, work)?;
            if dictionary.is_impulsive() && !values.controls().texture.scaling_auto {
                note(&format!("{}: {IMPULSIVE}", path.display()));
            }
            drop(chain.swap_slot(*slot, Some(dictionary)));
        }
        Ok(())
    }
}

/// Rejects a region outside the recording; notes one that extends beyond it.
fn check_region(region_s: Option<[f64; 2]>, name: &str, recording: &Recording, path: &Path) -> Result<(), Error> {
    let duration_s = recording.len_samples() as f64 / f64::from(recording.sample_rate_hz);
    let Some([start_s, end_s]) = region_s.filter(|[_, end_s]| *end_s > duration_s) else { return Ok(()) };
    let found = format!("{name} is {start_s}-{end_s} s, but {} has {duration_s:.3} s", path.display());
    if start_s >= duration_s {
        return Err(Error::Conflict(format!("{found}; choose a part inside it")));
    }
    note(&format!("{found}; only the part that exists is used"));
    Ok(())
}
