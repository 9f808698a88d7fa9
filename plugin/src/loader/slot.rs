//! What the loader has of one recording.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyrophone_recording::Recording;
use pyrophone_synthesis::texture::Dictionary;
use pyrophone_training::DictionaryKey;

use crate::analysis::Portrait;

/// A recording that is to be fetched.
pub enum Pending {
    /// The user's choice; where it fails, the old one stays.
    File(PathBuf),
    /// The session's; where it fails, there is none.
    Session,
}

/// One slot.
pub struct Slot {
    /// What is to be fetched.
    pub pending: Option<Pending>,
    /// The decoded recording.
    pub recording: Option<Arc<Recording>>,
    /// What is drawn of it, and whether that is not what it should be.
    pub portrait: Option<Arc<Portrait>>,
    /// See `portrait`.
    pub portrait_is_due: bool,
    /// The dictionary that was made last.
    pub dictionary: Option<(DictionaryKey, Arc<Dictionary>)>,
    /// Whether the dictionary was made here and is not kept yet.
    pub is_unkept: Cell<bool>,
    /// What could not be indexed, so that it is not tried again.
    pub failed: Option<DictionaryKey>,
    /// Whether the engine has the dictionary.
    pub is_sent: bool,
}

impl Default for Slot {
    fn default() -> Self {
        Self {
            pending: None,
            recording: None,
            portrait: None,
            portrait_is_due: false,
            dictionary: None,
            is_unkept: Cell::new(false),
            failed: None,
            // There is nothing to be sent.
            is_sent: true,
        }
    }
}

impl Slot {
    /// The recording as it is shown: name, length, rate, channels. `path` is where the session has it from: the same bytes
    /// may have been read from another place before, under another name.
    pub fn description(&self, path: Option<&str>) -> Option<String> {
        let recording = self.recording.as_ref()?;
        let name = path.and_then(|path| Path::new(path).file_name()).map(|name| name.to_string_lossy().into_owned());
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
