//! Decoding of recordings from a path or a session's reference.

use std::path::Path;
use std::sync::Arc;

use pyrophone_fires::{Source, read};
use pyrophone_recording::{Error, Recording, content_hash, decode_known, embed, unembed};
use pyrophone_settings::FactoryFire;
use pyrophone_settings::session::RecordingReference;

use super::cache::RECORDINGS;
use super::job::Job;

/// The file of a recording, not decoded yet.
pub struct Located {
    bytes: Vec<u8>,
    /// [`content_hash`] of its bytes.
    pub content_hash: String,
    name: String,
    /// Notice to the user although it was found.
    notice: Option<String>,
}

/// A recording that was found.
pub struct Found {
    /// The decoded recording, shared with other instances.
    pub recording: Arc<Recording>,
    /// Its reference in the session.
    pub reference: RecordingReference,
    /// Notice to the user although it was found.
    pub notice: Option<String>,
}

/// Reason why there is no recording.
#[derive(Debug, PartialEq)]
pub enum Failure {
    /// A later order made it useless.
    Cancelled,
    /// It cannot be used; message for the user.
    Message(String),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error {
            Error::Cancelled => Self::Cancelled,
            error => Self::Message(error.to_string()),
        }
    }
}

impl From<pyrophone_fires::Error> for Failure {
    fn from(error: pyrophone_fires::Error) -> Self {
        match error {
            pyrophone_fires::Error::Recording(error) => error.into(),
            error => Self::Message(error.to_string()),
        }
    }
}

impl From<pyrophone_training::Error> for Failure {
    fn from(error: pyrophone_training::Error) -> Self {
        match error {
            pyrophone_training::Error::Cancelled => Self::Cancelled,
            error => Self::Message(error.to_string()),
        }
    }
}

/// Opens the file or factory fire chosen by the user. With `keep`, the file itself is embedded in the reference where it
/// is small enough.
pub fn open(path: &Path, keep: bool, job: &Job) -> Result<Found, Failure> {
    let Source { bytes, name } = read(path, &|done| job.report("Kindling", done))?;
    let recording = decode(&bytes, &content_hash(&bytes), &name, job)?;
    let is_file = !FactoryFire::is_meant_by(path);
    let absolute = is_file.then(|| std::path::absolute(path).ok()).flatten();
    let path = absolute.unwrap_or_else(|| path.to_owned());
    let mut notice = notes(&recording);
    let embedded =
        if keep && is_file { embed(&bytes).map_err(|error| notice = Some(error.to_string())).ok() } else { None };
    let reference = RecordingReference {
        path: path.to_string_lossy().into_owned(),
        content_hash: recording.content_hash.clone(),
        embedded,
    };
    Ok(Found { recording, reference, notice })
}

/// Finds the file named by a session: the identical file at its path, otherwise the embedded one, otherwise whichever
/// file is now at that path.
pub fn locate(reference: &RecordingReference, job: &Job) -> Result<Located, Failure> {
    let path = Path::new(&reference.path);
    let hashed = |Source { bytes, name }| Located { content_hash: content_hash(&bytes), bytes, name, notice: None };
    let at_place = read(path, &|done| job.report("Kindling", done)).map(hashed);
    if at_place.as_ref().is_ok_and(|found| found.content_hash == reference.content_hash) {
        return Ok(at_place?);
    }
    if let Some(embedded) = &reference.embedded {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let embedded = hashed(Source { bytes: unembed(embedded)?, name });
        if embedded.content_hash == reference.content_hash {
            return Ok(embedded);
        }
    }
    let what = if FactoryFire::is_meant_by(path) {
        "this version plays the factory fire differently than the one that saved the session"
    } else {
        "the file has changed since the session was saved"
    };
    let notice = format!("{}: {what}; load it again to confirm", reference.path);
    Ok(Located { notice: Some(notice), ..at_place? })
}

impl Located {
    /// The recording in it. The session's reference stays as it was saved.
    pub fn decode(self, reference: &RecordingReference, job: &Job) -> Result<Found, Failure> {
        let recording = decode(&self.bytes, &self.content_hash, &self.name, job)?;
        let notice = self.notice.or_else(|| notes(&recording));
        Ok(Found { recording, reference: reference.clone(), notice })
    }
}

/// Packs the file of a reference for embedding in the session, if it is still the same file. Factory fires need no
/// embedding: every Pyrophone has them.
pub fn pack(reference: &RecordingReference) -> Result<Option<String>, String> {
    let path = Path::new(&reference.path);
    if FactoryFire::is_meant_by(path) {
        return Ok(None);
    }
    let bytes = pyrophone_recording::read(path).map_err(|error| error.to_string())?;
    if content_hash(&bytes) != reference.content_hash {
        return Err(format!("{}: the file has changed since it was loaded; load it again", reference.path));
    }
    embed(&bytes).map(Some).map_err(|error| error.to_string())
}

/// Notices to the user about a recording.
fn notes(recording: &Recording) -> Option<String> {
    let notes: Vec<String> = recording.notes.iter().map(ToString::to_string).collect();
    (!notes.is_empty()).then(|| format!("{}: {}", recording.name, notes.join("; ")))
}

fn decode(bytes: &[u8], content_hash: &str, name: &str, job: &Job) -> Result<Arc<Recording>, Failure> {
    let make = || decode_known(bytes, content_hash, name, &|done| job.report("Reading", 0.2 * done));
    match RECORDINGS.get_or_make(&content_hash.to_owned(), || job.is_called_off(), make) {
        Some(made) => Ok(made?),
        None => Err(Failure::Cancelled),
    }
}
