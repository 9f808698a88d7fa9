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
mod tests {
    use super::*;
    use crate::{Id, Values};

    fn preset(name: &str, alpha: f64) -> Preset {
        let mut values = Values::default();
        values.set(Id::Alpha as usize, alpha).expect("in range");
        let (description, tags) = ("one's own".to_owned(), vec!["mine".to_owned()]);
        Preset { name: name.to_owned(), description, tags, values, ..Preset::default() }
    }

    fn library() -> (tempfile::TempDir, Library) {
        let folder = tempfile::tempdir().expect("a folder");
        let library = Library::new(folder.path().join("not/yet"));
        (folder, library)
    }

    #[test]
    fn saved_preset_is_listed_and_found() {
        let (_folder, library) = library();
        assert_eq!(library.list().0, []);
        for (name, alpha) in [("Zündholz", 3.0), ("  a/b:c*?.toml  ", 2.0), ("nul", 4.0)] {
            let path = library.save(&preset(name, alpha), false).expect("saved");
            assert_eq!(path.parent(), Some(library.folder()), "{name}");
            assert_eq!(Preset::load(&path).expect("read"), preset(name.trim(), alpha));
        }
        fs::write(library.folder().join("notes.txt"), "no preset").expect("written");
        let (listed, errors) = library.list();
        let names: Vec<&str> = listed.iter().map(|stored| stored.preset.name.as_str()).collect();
        assert_eq!(names, ["a/b:c*?.toml", "nul", "Zündholz"]);
        assert!(errors.is_empty());
        let files = fs::read_dir(library.folder()).expect("a folder").count();
        assert_eq!(files, 4, "nothing half-written is left");
    }

    #[test]
    fn chosen_folder_is_made_and_can_be_given_up() {
        let folder = tempfile::tempdir().expect("a folder");
        let home = folder.path().join("Pyrophone");
        let default = (Library::new(home.join("presets")), Origin::Default);
        assert_eq!(Library::located_in(&home), default);
        let chosen = folder.path().join("Feuer, für Filme");
        Library::choose_in(&home, Some(&chosen)).expect("stored");
        assert!(chosen.is_dir());
        assert_eq!(Library::located_in(&home), (Library::new(chosen.clone()), Origin::Chosen));
        fs::write(chosen.join("file"), "").expect("written");
        for wrong in [Path::new("relative"), Path::new(""), &chosen.join("file"), &chosen.join("a\nb")] {
            assert!(Library::choose_in(&home, Some(wrong)).is_err(), "{wrong:?}");
            assert_eq!(Library::located_in(&home).0.folder(), chosen);
        }
        Library::choose_in(&home, None).expect("stored");
        assert_eq!(Library::located_in(&home), default);
    }

    #[test]
    fn names_are_found_without_regard_to_case_and_unicode_form() {
        let (_folder, library) = library();
        library.save(&preset("Zündholz", 3.0), false).expect("saved");
        library.save(&preset("ember", 2.0), false).expect("saved");
        fs::write(library.folder().join("Broken.toml"), "version = 99").expect("written");
        assert!(library.find("zu\u{308}ndholz").is_none(), "the exact name only");
        let found = library.find_folded("zu\u{308}NDHOLZ").expect("a file").expect("a preset");
        assert_eq!(found, preset("Zündholz", 3.0));
        assert!(library.find_folded("BROKEN").expect("a file").is_err());
        assert!(library.find_folded("Zundholz").is_none());
    }

    #[test]
    fn nothing_is_overwritten_unless_asked() {
        let (_folder, library) = library();
        let path = library.save(&preset("one", 2.0), false).expect("saved");
        let error = library.save(&preset("one", 5.0), false).expect_err("exists");
        assert!(matches!(&error, Error::PresetExists { name, .. } if name == "one"), "{error}");
        assert_eq!(Preset::load(&path).expect("read"), preset("one", 2.0));
        library.save(&preset("one", 5.0), true).expect("replaced");
        assert_eq!(Preset::load(&path).expect("read"), preset("one", 5.0));
    }

    #[test]
    fn deleting_takes_presets_of_the_folder_alone() {
        let (folder, library) = library();
        let one = library.save(&preset("one", 2.0), false).expect("saved");
        let outside = folder.path().join("outside.toml");
        fs::write(&outside, "").expect("written");
        let notes = library.folder().join("notes.txt");
        fs::write(&notes, "").expect("written");
        for path in [&outside, &notes] {
            assert!(library.delete(path).is_err() && path.exists());
        }
        library.delete(&one).expect("deleted");
        assert!(!one.exists() && library.delete(&one).is_err());
    }

    #[test]
    fn favourites_are_kept_by_name() {
        let (_folder, library) = library();
        assert!(library.favourites().is_empty());
        let names = ["campfire".to_owned(), "Zündholz, nah".to_owned()];
        library.keep_favourites(&names).expect("kept");
        assert_eq!(library.favourites(), names);
        assert_eq!(library.list().0, [], "they are no preset");
        library.keep_favourites(&[]).expect("kept");
        assert!(library.favourites().is_empty());
    }

    #[test]
    fn renaming_moves_the_file_and_keeps_the_rest() {
        let (_folder, library) = library();
        let one = library.save(&preset("one", 2.0), false).expect("saved");
        library.save(&preset("two", 3.0), false).expect("saved");
        assert!(matches!(library.rename(&one, "two"), Err(Error::PresetExists { .. })));
        assert!(matches!(library.rename(&one, " "), Err(Error::PresetName { .. })));
        assert!(matches!(library.rename(Path::new("no-file"), "three"), Err(Error::File { .. })));
        assert!(one.exists());
        let three = library.rename(&one, "three").expect("renamed");
        assert!(!one.exists());
        assert_eq!(Preset::load(&three).expect("read"), preset("three", 2.0));
        // A name that is spelt differently may be the same file.
        assert_eq!(library.rename(&three, "three ").expect("renamed"), three);
        assert!(three.exists());
    }

    #[test]
    fn recordings_beside_presets_move_with_them() {
        let (folder, library) = library();
        let cut = crate::session::Cut { region_s: Some([0.5, 2.25]), gain_db: -3.0, normalise: true };
        let beside = library.folder().join("Glut/Öl, nah — 火.wav");
        let outside = folder.path().join("campfire.wav");
        for (name, file, written) in [("beside", &beside, "Glut/Öl, nah — 火.wav"), ("outside", &outside, "")] {
            let recording = Some(crate::PresetRecording { file: file.clone(), cut });
            let preset = Preset { recording, ..preset(name, 2.0) };
            let path = library.save(&preset, false).expect("saved");
            assert_eq!(Preset::load(&path).expect("read"), preset, "the file need not exist");
            let written = if written.is_empty() { file.display().to_string() } else { written.to_owned() };
            let text = fs::read_to_string(&path).expect("text");
            assert!(text.contains(&format!("\nfile = {}\n", toml::Value::String(written))), "{text}");
        }
        let renamed = library.rename(&library.folder().join("beside.toml"), "other").expect("renamed");
        assert_eq!(Preset::load(&renamed).expect("read").recording.expect("kept").file, beside);
        let moved = Library::new(folder.path().join("moved"));
        fs::rename(library.folder(), moved.folder()).expect("moved");
        let found = moved.find("other").expect("a file").expect("a preset").recording.expect("kept");
        assert_eq!((found.file, found.cut), (moved.folder().join("Glut/Öl, nah — 火.wav"), cut));
    }

    #[test]
    fn broken_presets_are_reported_and_the_rest_listed() {
        let (_folder, library) = library();
        library.save(&preset("good", 2.0), false).expect("saved");
        for (name, text) in [("empty", String::new()), ("huge", "#".repeat(2 << 20)), ("other", "version = 99".into())]
        {
            fs::write(library.folder().join(format!("{name}.toml")), text).expect("written");
        }
        fs::create_dir(library.folder().join("folder.toml")).expect("made");
        let wrong = "version = 2\nname = \"mistyped\"\n[parameters]\nalpha = 99.0";
        fs::write(library.folder().join("wrong.toml"), wrong).expect("written");
        for name in ["mistyped", "wrong"] {
            let error = library.find(name).expect("a file").expect_err("out of range");
            assert!(error.to_string().contains("alpha"), "{error}");
        }
        assert!(matches!(library.find("good"), Some(Ok(found)) if found == preset("good", 2.0)));
        assert!(matches!(library.find("huge"), Some(Err(Error::File { .. }))));
        assert!(library.find("none").is_none());
        fs::remove_file(library.folder().join("wrong.toml")).expect("removed");
        #[cfg(unix)]
        {
            let pipe = library.folder().join("pipe.toml");
            assert!(std::process::Command::new("mkfifo").arg(&pipe).status().expect("mkfifo").success());
            assert!(matches!(library.rename(&pipe, "x"), Err(Error::File { .. })), "nobody writes to it");
            fs::remove_file(pipe).expect("removed");
        }
        let (listed, errors) = library.list();
        assert_eq!(listed.len(), 1);
        assert_eq!(errors.len(), 4, "{errors:?}");
        let file = library.folder().join("good.toml");
        let inside = Library::new(file.clone());
        assert!(matches!(inside.save(&preset("x", 2.0), false), Err(Error::FileWrite { .. })));
        assert_eq!(inside.list().1.len(), 1, "a file is no folder");
        for name in ["", "  ", "a\nb", &"x".repeat(81)] {
            assert!(matches!(library.save(&preset(name, 2.0), false), Err(Error::PresetName { .. })), "{name:?}");
        }
    }
}
