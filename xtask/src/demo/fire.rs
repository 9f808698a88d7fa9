//! Sources of the demo: the user's sounds, a simulated flame, and a recorded fire if available, otherwise a generated
//! one.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result};
use pyrophone_recording::write_wav_f32;

use super::comparisons::reference_folder;
use super::{flame, page, signals};

/// A file, with its description on the page and its licence.
pub struct Found {
    /// The file.
    pub path: PathBuf,
    /// The description, HTML.
    pub note: String,
    /// The licence.
    pub rights: String,
}

/// Rights in sounds made by the demo itself.
const OWN_RIGHTS: &str = "none reserved";

/// Resources of the program Blanket, as Debian's package of that name installs them, and the fire among them.
const BLANKET: &str = "/usr/share/blanket/blanket.gresource";
const FIREPLACE: &str = "/com/rafaelmardojai/Blanket/sounds/fireplace.ogg";
/// Magic number of Ogg files.
const OGG: &[u8] = b"OggS";

/// A sound of the user's.
pub fn own(path: &Path) -> Found {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    Found { path: path.to_owned(), note: format!("{}.", page::escaped(&name)), rights: "your own file".to_owned() }
}

/// A flame simulated here.
///
/// # Errors
/// If it cannot be simulated or written.
pub fn simulated(folder: &Path) -> Result<Found> {
    let path = folder.join("generated-flame.wav");
    write_wav_f32(&path, &[flame::simulate(signals::RATE_HZ, flame::SECONDS)?], signals::RATE_HZ)?;
    let note = "<b class=generated>Simulated</b> Pressure of a fire-breathing dragon's flame, from this project's own solver (<code>pyrophone simulate dragon</code>).";
    Ok(Found { path, note: note.to_owned(), rights: OWN_RIGHTS.to_owned() })
}

/// A recorded fire in the public domain: from the program Blanket if that is installed, otherwise from the reference
/// data.
pub fn recorded(folder: &Path) -> Option<Found> {
    let path = of_blanket(Path::new(BLANKET), folder).or_else(|| {
        let path = reference_folder()?.join("recordings/fireplace.flac");
        path.is_file().then_some(path)
    })?;
    let note = "<b class=recorded>Recorded</b> A soft fire in a fireplace, from the program Blanket.";
    Some(Found { path, note: note.to_owned(), rights: "public domain, ezwa (soundbible.com)".to_owned() })
}

/// The fire among Blanket's resources, extracted by GLib's own tool.
fn of_blanket(resources: &Path, folder: &Path) -> Option<PathBuf> {
    if !resources.is_file() {
        return None;
    }
    let found = Command::new("gresource").arg("extract").arg(resources).arg(FIREPLACE).output();
    let sound = found.ok().map(|found| found.stdout).filter(|sound| sound.starts_with(OGG));
    let path = folder.join("fireplace.ogg");
    let written = sound.context("no fire in there").and_then(|sound| Ok(std::fs::write(&path, sound)?));
    if let Err(error) = &written {
        eprintln!(
            "the fire of {} is left out ({error}); `gresource` is in Debian's libglib2.0-bin",
            resources.display()
        );
    }
    written.ok().map(|()| path)
}

/// A fire generated here.
///
/// # Errors
/// If it cannot be written.
pub fn generated(folder: &Path) -> Result<Found> {
    let path = folder.join("generated-fire.wav");
    write_wav_f32(&path, &signals::fire(), signals::RATE_HZ)?;
    let note = "<b class=generated>Generated</b> Roar, hiss and bursts of crackle, in stereo.";
    Ok(Found { path, note: note.to_owned(), rights: OWN_RIGHTS.to_owned() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn resources_without_a_fire_are_passed_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let resources = folder.path().join("blanket.gresource");
        assert!(of_blanket(&resources, folder.path()).is_none(), "not installed");
        std::fs::write(&resources, "no resources").expect("written");
        assert!(of_blanket(&resources, folder.path()).is_none());
        assert!(!folder.path().join("fireplace.ogg").exists());
    }
}
