//! State of one recording in the loader.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyrophone_recording::Recording;
use pyrophone_settings::{FactoryFire, PresetRecording};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_training::DictionaryKey;

use pyrophone_analysis::RecordingOverview;

/// Recording to be fetched.
pub enum Pending {
    /// The user's choice; on failure, the old one stays.
    File(PathBuf),
    /// A preset's; on failure, the old one stays.
    Preset(PresetRecording),
    /// The session's; on failure, there is none.
    Session,
}

/// One slot.
pub struct Slot {
    /// Recording to be fetched.
    pub pending: Option<Pending>,
    /// The decoded recording.
    pub recording: Option<Arc<Recording>>,
    /// Picture of the recording, and whether it is outdated.
    pub overview: Option<Arc<RecordingOverview>>,
    /// See `overview`.
    pub overview_is_due: bool,
    /// The dictionary built last.
    pub dictionary: Option<(DictionaryKey, Arc<RecordingDictionary>)>,
    /// True if the dictionary was built here and is not on disk yet.
    pub is_unkept: Cell<bool>,
    /// Key of a dictionary that could not be built, so that it is not tried again.
    pub failed: Option<DictionaryKey>,
    /// True if the engine has the dictionary.
    pub is_sent: bool,
}

impl Default for Slot {
    fn default() -> Self {
        Self {
            pending: None,
            recording: None,
            overview: None,
            overview_is_due: false,
            dictionary: None,
            is_unkept: Cell::new(false),
            failed: None,
            // There is nothing to send.
            is_sent: true,
        }
    }
}

impl Slot {
    /// The recording's description: name, length, rate, channels. `path` is the session's path: the same bytes may have
    /// been read from another path before, under another name.
    pub fn description(&self, path: Option<&str>) -> Option<String> {
        let recording = self.recording.as_ref()?;
        // A factory fire has a title instead.
        let file = path.map(Path::new).filter(|path| !FactoryFire::is_meant_by(path));
        let name = file.and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        let name = name.as_deref().unwrap_or(&recording.name);
        let (seconds, kilohertz) = (recording.duration_s(), f64::from(recording.sample_rate_hz) / 1000.0);
        let channels = match recording.channels.len() {
            1 => "mono".to_owned(),
            2 => "stereo".to_owned(),
            count => format!("{count} channels"),
        };
        Some(format!("{name}: {seconds:.1} s, {kilohertz} kHz, {channels}"))
    }
}
