//! Presets in the format of VST3 hosts: `.vstpreset` files.
//!
//! A header names the class, followed by the component's state and a list with its position. The state has no session,
//! so a preset does not affect the recording.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::session::parameters_json;
use crate::{Error, Preset};

/// The plug-in's VST3 class, as its sixteen bytes.
pub const CLASS_ID: [u8; 16] = *b"PyrophoneFireFX1";

/// Bytes before the state: magic, version, class in hexadecimal, position of the list.
const HEADER: usize = 4 + 4 + 32 + 8;

/// A preset as the bytes of a `.vstpreset` file.
pub fn to_bytes(preset: &Preset) -> Vec<u8> {
    let state = parameters_json(&preset.values, BTreeMap::new());
    let list = HEADER + state.len();
    let class: String = CLASS_ID.iter().map(|byte| format!("{byte:02X}")).collect();
    let mut bytes = b"VST3".to_vec();
    bytes.extend(1i32.to_le_bytes());
    bytes.extend(class.as_bytes());
    bytes.extend((list as i64).to_le_bytes());
    bytes.extend(state.as_bytes());
    bytes.extend(b"List");
    bytes.extend(1i32.to_le_bytes());
    bytes.extend(b"Comp");
    bytes.extend((HEADER as i64).to_le_bytes());
    bytes.extend((state.len() as i64).to_le_bytes());
    bytes
}

/// Writes the factory presets to `folder`, which is created if needed, and returns their paths.
///
/// # Errors
/// [`Error::File`] if the folder or a file cannot be written.
pub fn write_factory(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::File { path, source }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    Preset::factory()?
        .iter()
        .map(|preset| {
            let path = folder.join(format!("{}.vstpreset", preset.name));
            std::fs::write(&path, to_bytes(preset)).map_err(failed(&path))?;
            Ok(path)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_finds_the_state() {
        let preset = Preset::find("campfire").unwrap();
        let bytes = to_bytes(&preset);
        assert_eq!(&bytes[..8], b"VST3\x01\0\0\0");
        assert_eq!(&bytes[8..40], b"5079726F70686F6E6546697265465831");
        let number = |at: usize| i64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
        let list = number(40);
        assert_eq!(&bytes[list..list + 12], b"List\x01\0\0\0Comp");
        let (start, length) = (number(list + 12), number(list + 20));
        let state: serde_json::Value = serde_json::from_slice(&bytes[start..start + length]).unwrap();
        assert_eq!(state["params"]["drive_mode"]["i32"], 4);
        assert_eq!(state["fields"], serde_json::json!({}), "the recording is left alone");
        assert_eq!(list + 28, bytes.len());
    }

    #[test]
    fn every_factory_preset_is_written() {
        let folder = std::env::temp_dir().join(format!("pyrophone-vst3-{}", std::process::id()));
        let paths = write_factory(&folder).unwrap();
        assert!(paths.len() >= 10 && paths.iter().all(|path| path.is_file()));
        std::fs::remove_dir_all(&folder).unwrap();
        let blocked = std::env::temp_dir().join(format!("pyrophone-blocked-{}", std::process::id()));
        std::fs::write(&blocked, "").unwrap();
        assert!(write_factory(&blocked).is_err());
        std::fs::remove_file(&blocked).unwrap();
    }
}
