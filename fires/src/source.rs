//! What a recording's path means: a file, or a factory fire.

use std::path::Path;

use pyrophone_recording::{Progress, write_wav_f32_to};
use pyrophone_settings::FactoryFire;

use crate::Error;
use crate::play::{SAMPLE_RATE_HZ, play};

/// A recording's bytes, not decoded yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Those of a sound file.
    pub bytes: Vec<u8>,
    /// Its name for people: a file's without its folder, a factory fire's title.
    pub name: String,
}

/// The bytes of the file at `path`, or of the factory fire that it names. `progress` hears of a fire's playing only; a file
/// is read in one go.
///
/// # Errors
/// If there is no such file or fire, if the file cannot be read, or if `progress` returns false.
pub fn read(path: &Path, progress: Progress<'_>) -> Result<Source, Error> {
    let Some(fire) = FactoryFire::of(path)? else {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        return Ok(Source { bytes: pyrophone_recording::read(path)?, name });
    };
    let name = format!("{} (factory)", fire.preset()?.title());
    let mut bytes = Vec::new();
    write_wav_f32_to(&mut bytes, &name, &play(fire, progress)?, SAMPLE_RATE_HZ, None)?;
    Ok(Source { bytes, name })
}

#[cfg(test)]
mod tests {
    use pyrophone_recording::{decode_bytes, no_progress};
    use pyrophone_settings::FACTORY_FIRES;

    use super::*;

    #[test]
    fn every_factory_fire_is_a_sound_file_of_its_own() {
        let mut hashes = std::collections::BTreeSet::new();
        for fire in FACTORY_FIRES {
            let source = read(&fire.path(), &no_progress).unwrap();
            let recording = decode_bytes(&source.bytes, &source.name, &no_progress).unwrap();
            assert_eq!((recording.channels.len(), recording.len_samples()), (2, 24 * 48_000), "{fire:?}");
            assert!(recording.notes.is_empty(), "{fire:?}: {:?}", recording.notes);
            let peak = recording.channels.iter().flatten().fold(0.0_f32, |peak, sample| peak.max(sample.abs()));
            assert!((0.05..1.0).contains(&peak), "{fire:?}: peak {peak}");
            assert!(hashes.insert(recording.content_hash), "{fire:?} is another fire's double");
        }
    }

    #[test]
    fn a_factory_fire_is_the_same_every_time_and_can_be_cancelled() {
        let path = FACTORY_FIRES[0].path();
        assert_eq!(read(&path, &no_progress).unwrap(), read(&path, &no_progress).unwrap());
        let cancelled = read(&path, &|done| done < 0.5).unwrap_err();
        assert!(matches!(cancelled, Error::Recording(pyrophone_recording::Error::Cancelled)), "{cancelled}");
    }

    #[test]
    fn files_are_read_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("fire.wav");
        std::fs::write(&file, b"bytes").unwrap();
        let source = read(&file, &no_progress).unwrap();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(source, Source { bytes: b"bytes".to_vec(), name: "fire.wav".to_owned() });
        assert!(read(&file, &no_progress).is_err(), "it is gone");
    }
}
