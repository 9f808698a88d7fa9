//! Recordings that presets name.

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap_sys::ext::preset_load::{CLAP_EXT_PRESET_LOAD, clap_plugin_preset_load};
use clap_sys::factory::preset_discovery::CLAP_PRESET_DISCOVERY_LOCATION_FILE;
use tempfile::TempDir;

use crate::validator::ensure;

use super::raw::Raw;

/// Limit of the wait for a recording.
const PATIENCE: Duration = Duration::from_secs(30);
/// Name of the recording: one that not every file system keeps as it is.
const NAME: &str = "Öl, nah 火.wav";

/// A folder for presets and a recording, removed when dropped.
struct Folder(TempDir);

impl Folder {
    fn new() -> Result<Self, String> {
        tempfile::tempdir().map(Self).map_err(|error| format!("no temporary folder: {error}"))
    }

    fn write(&self, name: &str, bytes: &[u8]) -> Result<PathBuf, String> {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(path)
    }

    /// A preset file that names a recording beside it.
    fn preset(&self, name: &str, recording: &str) -> Result<PathBuf, String> {
        let text =
            format!("version = 3\nname = \"{name}\"\n[recording]\nfile = \"{recording}\"\n[parameters]\nalpha = 3.5\n");
        self.write(&format!("{name}.toml"), text.as_bytes())
    }
}

/// A second of noise as a WAV file of 16 bits.
fn noise() -> Vec<u8> {
    const SAMPLES: u32 = 44_100;
    let size = 2 * SAMPLES;
    let mut bytes = b"RIFF".to_vec();
    bytes.extend((36 + size).to_le_bytes());
    bytes.extend(b"WAVEfmt ");
    bytes.extend(16u32.to_le_bytes());
    // PCM, mono, 44.1 kHz, two bytes a sample.
    bytes.extend([1u16, 1].map(u16::to_le_bytes).concat());
    bytes.extend([SAMPLES, size].map(u32::to_le_bytes).concat());
    bytes.extend([2u16, 16].map(u16::to_le_bytes).concat());
    bytes.extend(b"data");
    bytes.extend(size.to_le_bytes());
    let mut state = 1u32;
    for _ in 0..SAMPLES {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        bytes.extend((state as i16 / 4).to_le_bytes());
    }
    bytes
}

fn load(raw: &Raw, preset: &Path) -> Result<(), String> {
    // SAFETY: the id's type.
    let load: &clap_plugin_preset_load = unsafe { raw.extension(CLAP_EXT_PRESET_LOAD)? };
    let load = load.from_location.ok_or("no from_location")?;
    let path = CString::new(preset.as_os_str().as_encoded_bytes()).map_err(|error| error.to_string())?;
    // SAFETY: a live plug-in and a live text.
    let is_loaded = unsafe { load(raw.plugin, CLAP_PRESET_DISCOVERY_LOCATION_FILE, path.as_ptr(), std::ptr::null()) };
    ensure(is_loaded, || format!("{} is not loaded", preset.display()))
}

fn names_recording(raw: &Raw) -> Result<bool, String> {
    Ok(String::from_utf8_lossy(&raw.save()?).contains(NAME))
}

/// The check `presets_bring_their_recordings`.
pub(super) fn preset_recording(bundle: &Path) -> Result<(), String> {
    let (raw, folder) = (Raw::load(bundle)?, Folder::new()?);
    folder.write(NAME, &noise())?;
    load(&raw, &folder.preset("with", NAME)?)?;
    let began = Instant::now();
    while !names_recording(&raw)? {
        ensure(began.elapsed() < PATIENCE, || format!("{NAME} is not loaded with its preset"))?;
        std::thread::sleep(Duration::from_millis(10));
    }
    load(&raw, &folder.preset("without", "no such file.wav")?)?;
    std::thread::sleep(Duration::from_millis(200));
    let text = String::from_utf8_lossy(&raw.save()?).into_owned();
    ensure(text.contains(NAME) && !text.contains("no such file"), || {
        "a preset whose recording is missing takes the present one away".to_owned()
    })
}
