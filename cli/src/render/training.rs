//! The dictionary that texture learns from a recording.

use std::path::Path;
use std::sync::Arc;

use pyrophone_recording::{Cut, Recording};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_training::{DictionaryKey, Stage, Store, build};

use crate::error::Error;
use crate::progress::{Work, note};
use crate::texture::{check_windows, note_if_cancelling};

/// The dictionary of a region of the recording from `path`: the stored one if there is one, otherwise a new one, which
/// is then stored.
pub fn dictionary(
    recording: &Recording,
    path: &Path,
    cut: &Cut,
    rate_hz: f64,
    structure: &EngineConfig,
    work: &Work,
) -> Result<Arc<RecordingDictionary>, Error> {
    note_if_cancelling(recording);
    let key = DictionaryKey::new(&recording.content_hash, cut, rate_hz, structure);
    let store = Store::of_user();
    if let Some(kept) = store.as_ref().and_then(|store| store.read(&key)) {
        // The plug-in keeps a part too short for a window, too: there, extension replaces texture.
        check_windows(kept.windows(), path)?;
        return Ok(Arc::new(kept));
    }
    let shown = work.stage("learning");
    let progress = |stage: Stage, done: f32| match stage {
        Stage::Resampling => shown.report(0.2 * done),
        Stage::Indexing => shown.report(0.2 + 0.8 * done),
    };
    let made = build(recording, cut, rate_hz, structure, &progress).map_err(|error| match error {
        pyrophone_training::Error::Cancelled => Error::Cancelled,
        pyrophone_training::Error::Recording(error) => error.into(),
        pyrophone_training::Error::Engine { source, .. } => Error::of_file(path)(source),
    })?;
    check_windows(made.windows(), path)?;
    if let Some(Err(error)) = store.map(|store| store.write(&key, &made)) {
        note(&format!("the dictionary of {} cannot be stored for next time: {error}", path.display()));
    }
    Ok(Arc::new(made))
}
