//! Factory fires: recordings that need no file, because Pyrophone plays them itself.

use std::path::{Path, PathBuf};

use crate::{Error, Preset, names};

/// Beginning of a factory fire's path. No file that a user chooses has such a path, since those are absolute.
const SCHEME: &str = "factory:";

/// A recording that Pyrophone plays itself: `factory:` and the name of the factory preset that plays it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FactoryFire(&'static str);

/// All of them: the presets that burn without an input and crackle, roar or hiss without a recording.
pub const FACTORY_FIRES: [FactoryFire; 10] = [
    FactoryFire("hearth"),
    FactoryFire("bonfire"),
    FactoryFire("brazier"),
    FactoryFire("wet-logs"),
    FactoryFire("grass-fire"),
    FactoryFire("burning-paper"),
    FactoryFire("burning-hut"),
    FactoryFire("torch-in-hand"),
    FactoryFire("coal-embers"),
    FactoryFire("gas-burner"),
];

impl FactoryFire {
    /// The fire that a path names; `None` for the path of a file.
    ///
    /// # Errors
    /// [`Error::UnknownFire`] if the path begins with `factory:`, but there is no such fire.
    pub fn of(path: &Path) -> Result<Option<Self>, Error> {
        let Some(name) = path.to_str().and_then(|path| path.strip_prefix(SCHEME)) else { return Ok(None) };
        match FACTORY_FIRES.into_iter().find(|fire| fire.0 == name) {
            Some(fire) => Ok(Some(fire)),
            None => Err(Error::UnknownFire {
                name: name.replace(['\n', '\r'], " "),
                nearest: names::nearest(name, FACTORY_FIRES.iter().map(|fire| fire.0)),
                known: FACTORY_FIRES.map(|fire| fire.0).join(", "),
            }),
        }
    }

    /// True for the path of a fire, even of one that does not exist.
    pub fn is_meant_by(path: &Path) -> bool {
        path.to_str().is_some_and(|path| path.starts_with(SCHEME))
    }

    /// Name of the factory preset that plays it.
    pub fn name(self) -> &'static str {
        self.0
    }

    /// Its path, used wherever a recording's path is expected.
    pub fn path(self) -> PathBuf {
        format!("{SCHEME}{}", self.0).into()
    }

    /// The factory preset that plays it.
    ///
    /// # Errors
    /// If this build lacks it; a test plays all of them.
    pub fn preset(self) -> Result<Preset, Error> {
        Preset::find(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factory_fires_are_found_by_their_paths_and_files_are_not() {
        for fire in FACTORY_FIRES {
            assert_eq!(FactoryFire::of(&fire.path()).unwrap(), Some(fire));
            assert!(FactoryFire::is_meant_by(&fire.path()));
        }
        for file in ["hearth", "hearth.wav", "/factory:hearth", "./factory:hearth", "Factory:hearth", ""] {
            assert_eq!(FactoryFire::of(Path::new(file)).unwrap(), None, "{file}");
            assert!(!FactoryFire::is_meant_by(Path::new(file)), "{file}");
        }
    }

    #[test]
    fn unknown_factory_fire_is_reported_with_the_nearest() {
        for unknown in ["factory:harth", "factory:", "factory:hearth/", "factory:two\nlines"] {
            let message = FactoryFire::of(Path::new(unknown)).unwrap_err().to_string();
            assert!(message.contains("hearth, bonfire") && !message.contains('\n'), "{message}");
        }
        let message = FactoryFire::of(Path::new("factory:harth")).unwrap_err().to_string();
        assert!(message.contains("did you mean `hearth`"), "{message}");
    }

    #[test]
    fn factory_fires_burn_without_input_and_need_no_recording() {
        for fire in FACTORY_FIRES {
            let preset = fire.preset().unwrap();
            let controls = preset.values.controls();
            assert_ne!(controls.crackle.fuel, pyrophone_synthesis::controls::Fuel::Off, "{fire:?}");
            assert_eq!(crate::Id::DriveMode.parameter().to_text(preset.values.get(crate::Id::DriveMode)), "flame");
            assert!(preset.recording.is_none(), "{fire:?}");
        }
    }
}
