//! The user's own presets: a folder of readable files, in addition to the factory presets.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

use crate::names::folded;
use crate::preset::LARGEST_BYTES;
use crate::{Error, Preset, user_file};

/// Variable that names the folder, instead of the system's.
pub const FOLDER_VARIABLE: &str = "PYROPHONE_PRESETS";

/// File beside the default folder that names the folder chosen by the user.
const CHOSEN: &str = "presets-folder.txt";

/// Extension of preset files.
const EXTENSION: &str = "toml";

/// File with the names of the user's favourite presets.
const FAVOURITES: &str = "favourites.txt";

/// Largest number of files that are read from a folder.
const MOST_FILES: usize = 10_000;

/// Longest name of a preset, in characters.
const LONGEST_NAME: usize = 80;

/// A folder of presets.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Library {
    folder: PathBuf,
}

/// Who decided on the user's folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The environment variable `PYROPHONE_PRESETS`, which beats any choice.
    Environment,
    /// The user, in the window.
    Chosen,
    /// Nobody: it is the default.
    Default,
}

/// A preset and its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Stored {
    /// The file.
    pub path: PathBuf,
    /// The preset in it.
    pub preset: Preset,
}

impl Library {
    /// The user's folder: that in `PYROPHONE_PRESETS`, otherwise the one chosen in the window, otherwise
    /// `Pyrophone/presets` in the system's data folder. None if the user has no home.
    pub fn of_user() -> Option<Self> {
        Self::located().map(|(library, _)| library)
    }

    /// The user's folder, and who decided on it.
    pub fn located() -> Option<(Self, Origin)> {
        if let Some(named) = std::env::var_os(FOLDER_VARIABLE).filter(|folder| !folder.is_empty()) {
            return Some((Self::new(named.into()), Origin::Environment));
        }
        Some(Self::located_in(&Self::home()?))
    }

    /// Chooses the user's folder, which is created if needed; with none, the default applies again.
    ///
    /// # Errors
    /// If the path is relative, the folder cannot be created, or the choice cannot be stored.
    pub fn choose(folder: Option<&Path>) -> Result<(), Error> {
        let home = Self::home().ok_or_else(|| Error::FileWrite {
            path: CHOSEN.into(),
            source: std::io::Error::other("there is no home folder; set PYROPHONE_PRESETS"),
        })?;
        Self::choose_in(&home, folder)
    }

    fn home() -> Option<PathBuf> {
        Some(dirs::data_dir()?.join("Pyrophone"))
    }

    fn located_in(home: &Path) -> (Self, Origin) {
        let text = user_file::read(&home.join(CHOSEN));
        let chosen = Path::new(text.trim_end_matches(['\r', '\n']));
        if chosen.is_absolute() {
            (Self::new(chosen.to_owned()), Origin::Chosen)
        } else {
            (Self::new(home.join("presets")), Origin::Default)
        }
    }

    fn choose_in(home: &Path, folder: Option<&Path>) -> Result<(), Error> {
        let text = match folder {
            None => "",
            Some(folder) => {
                let refuse = |source| Error::FileWrite { path: folder.to_owned(), source };
                let name = folder.to_str().filter(|name| folder.is_absolute() && !name.contains(['\n', '\r']));
                let name = name.ok_or_else(|| {
                    refuse(std::io::Error::other("give the whole path of a folder, from the root or the drive"))
                })?;
                fs::create_dir_all(folder).map_err(refuse)?;
                name
            }
        };
        let path = home.join(CHOSEN);
        user_file::write(&path, text).map_err(|source| Error::FileWrite { path, source })
    }

    /// A library in `folder`, which need not exist yet.
    pub fn new(folder: PathBuf) -> Self {
        Self { folder }
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// The preset with this name, or the error in its file; none if there is no such file.
    pub fn find(&self, name: &str) -> Option<Result<Preset, Error>> {
        self.find_where(|found| found == name)
    }

    /// As [`find`](Self::find), ignoring case and Unicode form.
    pub fn find_folded(&self, name: &str) -> Option<Result<Preset, Error>> {
        let name = folded(name);
        self.find_where(|found| folded(found) == name)
    }

    fn find_where(&self, is_named: impl Fn(&str) -> bool) -> Option<Result<Preset, Error>> {
        let (presets, _) = self.list();
        if let Some(found) = presets.into_iter().find(|stored| is_named(&stored.preset.name)) {
            return Some(Ok(found.preset));
        }
        // A file that cannot be read as a preset may still have a name.
        let is_called_so = |path: &PathBuf| {
            let text = fs::metadata(path)
                .is_ok_and(|file| file.is_file() && file.len() <= LARGEST_BYTES)
                .then(|| fs::read_to_string(path).ok())
                .flatten();
            let table = text.and_then(|text| text.parse::<toml::Table>().ok()).unwrap_or_default();
            let stated = table.get("name").and_then(|stated| stated.as_str());
            stated.is_some_and(&is_named) || path.file_stem().is_some_and(|stem| is_named(&stem.to_string_lossy()))
        };
        let broken = self.paths().ok()?.into_iter().filter(|path| Preset::load(path).is_err()).find(is_called_so)?;
        Some(Preset::load(&broken))
    }

    /// The files that may be presets.
    fn paths(&self) -> std::io::Result<Vec<PathBuf>> {
        let paths = fs::read_dir(&self.folder)?.filter_map(|entry| Some(entry.ok()?.path()));
        let is_preset = |path: &PathBuf| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(EXTENSION));
        Ok(paths.filter(is_preset).take(MOST_FILES).collect())
    }

    /// All presets by name, and the errors of invalid files. A missing folder counts as empty.
    pub fn list(&self) -> (Vec<Stored>, Vec<Error>) {
        let (mut presets, mut errors) = (vec![], vec![]);
        let paths = match self.paths() {
            Ok(paths) => paths,
            Err(error) if error.kind() == ErrorKind::NotFound => return (presets, errors),
            Err(source) => return (presets, vec![Error::File { path: self.folder.clone(), source }]),
        };
        for path in paths {
            match Preset::load(&path) {
                Ok(preset) => presets.push(Stored { path, preset }),
                Err(error) => errors.push(error),
            }
        }
        presets.sort_by_cached_key(|stored| (stored.preset.name.to_lowercase(), stored.path.clone()));
        (presets, errors)
    }

    /// Writes a preset, completely or not at all, and returns its file. The folder is created if needed. A recording inside
    /// the folder is named relative to it.
    ///
    /// Fails if the name is empty, longer than 80 characters or has control characters; if another preset has it,
    /// unless `replaces` is true; and if the file cannot be written.
    pub fn save(&self, preset: &Preset, replaces: bool) -> Result<PathBuf, Error> {
        let path = self.path_of(&preset.name)?;
        if !replaces && path.exists() {
            return Err(Error::PresetExists { name: preset.name.trim().to_owned(), path });
        }
        let recording = preset.recording.clone().map(|recording| recording.relative_to(&self.folder));
        let preset = Preset { name: preset.name.trim().to_owned(), recording, ..preset.clone() };
        let part = path.with_extension(format!("{EXTENSION}.part"));
        let write = || {
            fs::create_dir_all(&self.folder)?;
            let mut file = fs::File::create(&part)?;
            file.write_all(preset.to_toml().as_bytes())?;
            file.sync_all()?;
            fs::rename(&part, &path)
        };
        write().map_err(|source| {
            // A partial file is useless.
            let _ = fs::remove_file(&part);
            Error::FileWrite { path: path.clone(), source }
        })?;
        Ok(path)
    }

    /// Removes a stored preset's file.
    ///
    /// # Errors
    /// If the file is not a preset in this folder, or cannot be removed.
    pub fn delete(&self, path: &Path) -> Result<(), Error> {
        let refuse = |source| Error::FileWrite { path: path.to_owned(), source };
        if path.parent() != Some(self.folder()) || path.extension().is_none_or(|found| found != EXTENSION) {
            return Err(refuse(std::io::Error::other("it is not a preset in this folder")));
        }
        fs::remove_file(path).map_err(refuse)
    }

    /// Names of the user's favourite presets, as last stored; none if nothing was stored.
    pub fn favourites(&self) -> Vec<String> {
        let path = self.folder.join(FAVOURITES);
        let is_fit = fs::metadata(&path).is_ok_and(|file| file.is_file() && file.len() <= LARGEST_BYTES);
        let text = if is_fit { fs::read_to_string(path).unwrap_or_default() } else { String::new() };
        text.lines().filter(|line| !line.is_empty()).map(str::to_owned).collect()
    }

    /// Stores the names of the user's favourite presets, one per line. The folder is created if needed.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn keep_favourites(&self, names: &[String]) -> Result<(), Error> {
        let path = self.folder.join(FAVOURITES);
        let text: String = names.iter().map(|name| format!("{name}\n")).collect();
        let written = fs::create_dir_all(&self.folder).and_then(|()| fs::write(&path, text));
        written.map_err(|source| Error::FileWrite { path, source })
    }

    /// Renames a stored preset, in the file and the file itself. Fails as [`save`](Self::save) does, and then keeps the
    /// old name.
    pub fn rename(&self, path: &Path, name: &str) -> Result<PathBuf, Error> {
        let preset = Preset { name: name.to_owned(), ..Preset::load(path)? };
        let is_same = self.path_of(name)? == path;
        let new = self.save(&preset, is_same)?;
        if !is_same {
            fs::remove_file(path).map_err(|source| Error::FileWrite { path: path.to_owned(), source })?;
        }
        Ok(new)
    }

    /// The file for a name. Characters that file systems reject become dashes.
    fn path_of(&self, name: &str) -> Result<PathBuf, Error> {
        let name = name.trim();
        if name.is_empty() || name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
            return Err(Error::PresetName { found: name.escape_debug().to_string(), longest: LONGEST_NAME });
        }
        let allowed = |c: char| c.is_alphanumeric() || " -_+,()".contains(c);
        let stem: String = name.chars().map(|c| if allowed(c) { c } else { '-' }).collect();
        // Windows reserves some names for devices, whatever follows the dot.
        let device = DEVICES.contains(&stem.to_lowercase().trim_end_matches(|c: char| c.is_ascii_digit()));
        let mark = if device { "_" } else { "" };
        Ok(self.folder.join(format!("{stem}{mark}.{EXTENSION}")))
    }
}

/// Names that no file may have on Windows, some of them with a digit appended.
const DEVICES: [&str; 6] = ["con", "prn", "aux", "nul", "com", "lpt"];

#[cfg(test)]
mod tests;
