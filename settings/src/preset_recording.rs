//! The recording that a preset names, with the part of it that is learnt from.

use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::FactoryFire;
use crate::session::Cut;

/// The recording that a preset names, with the part of it that is learnt from.
#[derive(Debug, Clone, PartialEq)]
pub struct PresetRecording {
    /// Its file, or the path of a [`FactoryFire`]. In a preset's text, a relative path starts at the folder of the preset's
    /// file.
    pub file: PathBuf,
    /// Part and level.
    pub cut: Cut,
}

/// The recording in a preset's text.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Packed {
    file: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    region_s: Option<[f64; 2]>,
    #[serde(default)]
    gain_db: f64,
    #[serde(default)]
    normalise: bool,
}

impl PresetRecording {
    /// The same recording, its file found from the folder of the preset's file.
    pub fn resolved(self, folder: &Path) -> Self {
        if FactoryFire::is_meant_by(&self.file) {
            return self;
        }
        Self { file: folder.join(&self.file), ..self }
    }

    /// The same recording for a preset in `folder`: a file inside it is named relative to it, so that both can be moved
    /// together.
    pub fn relative_to(self, folder: &Path) -> Self {
        let inside = self.file.strip_prefix(folder).ok().filter(|rest| !rest.as_os_str().is_empty());
        match inside.map(Path::to_owned) {
            Some(file) => Self { file, ..self },
            None => self,
        }
    }

    pub(crate) fn pack(&self) -> Packed {
        let Cut { region_s, gain_db, normalise } = self.cut;
        Packed { file: text_of(&self.file), region_s, gain_db, normalise }
    }
}

impl Packed {
    pub(crate) fn unpack(self) -> Result<PresetRecording, String> {
        if self.file.trim().is_empty() {
            return Err("its recording has no file; give the path of a sound file".to_owned());
        }
        let Self { file, region_s, gain_db, normalise } = self;
        let cut = Cut { region_s, gain_db, normalise }.check()?;
        Ok(PresetRecording { file: file.into(), cut })
    }
}

/// A path as text; a relative one has slashes on every system.
fn text_of(file: &Path) -> String {
    if file.is_absolute() {
        return file.to_string_lossy().into_owned();
    }
    let parts = file.components().filter(|part| *part != Component::CurDir);
    parts.map(|part| part.as_os_str().to_string_lossy().into_owned()).collect::<Vec<_>>().join("/")
}
