//! `pyrophone install` and `pyrophone uninstall` on Windows: the program copies what lies beside it in the unpacked package
//! to the folders where hosts look, and removes it from there.
//!
//! Linux and macOS have scripts for this. Windows' own scripts would need PowerShell, whose policy refuses downloaded ones,
//! and could not be tested without it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::error::Error;

/// Name of the program itself.
const PROGRAM: &str = "pyrophone.exe";
/// The factory presets, in the package and below the folder of VST3 presets.
const PACKED_PRESETS: &str = "presets/Pyrophone/Pyrophone/Factory";
const PRESETS: [&str; 3] = ["VST3 Presets", "Pyrophone", "Pyrophone"];

/// Folders that are installed to.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Folders {
    clap: PathBuf,
    vst3: PathBuf,
    /// Pyrophone's own, for the program.
    programs: PathBuf,
    /// That of Pyrophone's presets for VST3 hosts.
    presets: PathBuf,
}

impl Folders {
    /// The folders of the present user, or of all users, from Windows' environment variables and the folder of the present
    /// user's documents. Presets for VST3 hosts are the user's in any case.
    fn new(
        is_for_all: bool,
        documents: Option<PathBuf>,
        variable: impl Fn(&str) -> Option<PathBuf>,
    ) -> Result<Self, Error> {
        let known = |name: &str| {
            let unset =
                || Error::Conflict(format!("{name} is not set; sign in to Windows again and repeat the command"));
            variable(name).filter(|path| path.is_absolute()).ok_or_else(unset)
        };
        let presets = documents.map(|documents| documents.join(PRESETS.iter().collect::<PathBuf>()));
        let presets = presets.ok_or_else(|| {
            Error::Conflict("Windows knows no folder of documents; sign in again and repeat the command".to_owned())
        })?;
        if is_for_all {
            let common = known("CommonProgramFiles")?;
            let programs = known("ProgramFiles")?.join("Pyrophone");
            return Ok(Self { clap: common.join("CLAP"), vst3: common.join("VST3"), programs, presets });
        }
        let local = known("LOCALAPPDATA")?.join("Programs");
        let common = local.join("Common");
        Ok(Self { clap: common.join("CLAP"), vst3: common.join("VST3"), programs: local.join("Pyrophone"), presets })
    }

    /// What is installed: its path in the package, and its path afterwards.
    fn contents(&self) -> [(&'static str, PathBuf); 4] {
        [
            ("Pyrophone.clap", self.clap.join("Pyrophone.clap")),
            ("Pyrophone.vst3", self.vst3.join("Pyrophone.vst3")),
            (PROGRAM, self.programs.join(PROGRAM)),
            // Of the presets only the factory's are replaced: what hosts have saved beside them is the user's.
            (PACKED_PRESETS, self.presets.join("Factory")),
        ]
    }

    /// Copies everything from the package; returns where it is then.
    fn install(&self, package: &Path) -> Result<Vec<PathBuf>, Error> {
        let contents = self.contents();
        if let Some((missing, _)) = contents.iter().find(|(name, _)| !package.join(name).exists()) {
            return Err(Error::Conflict(format!(
                "{missing} is not in {}; unpack the whole package, and call the program in its folder",
                package.display()
            )));
        }
        for (name, installed) in &contents {
            replace(&package.join(name), installed)
                .map_err(|error| Error::Conflict(format!("{}: {}", installed.display(), remedy(&error))))?;
        }
        Ok(contents.into_iter().map(|(_, installed)| installed).collect())
    }

    /// Removes everything; returns what cannot be removed: the program `running`, as long as it runs.
    fn uninstall(&self, running: &Path) -> Result<Option<PathBuf>, Error> {
        let mut left = None;
        for (_, installed) in self.contents() {
            if same_file(&installed, running) {
                left = Some(installed);
                continue;
            }
            remove(&installed)
                .map_err(|error| Error::Conflict(format!("{}: {}", installed.display(), remedy(&error))))?;
        }
        if left.is_none() {
            // Removed if nothing else is in it, which would be the user's.
            let _ = fs::remove_dir(&self.programs);
        }
        Ok(left)
    }
}

/// What the user can do about an error of the system.
fn remedy(error: &std::io::Error) -> String {
    format!("{error}; close all hosts, and for all users open the window as administrator")
}

/// Puts a copy in the place of what is there.
fn replace(from: &Path, to: &Path) -> std::io::Result<()> {
    if same_file(from, to) {
        return Ok(());
    }
    // Complete before the old one goes.
    let mut name = to.file_name().unwrap_or_default().to_owned();
    name.push(".new");
    let copied = to.with_file_name(name);
    remove(&copied)?;
    copy(from, &copied)?;
    let placed = remove(to).and_then(|()| fs::rename(&copied, to));
    if placed.is_err() {
        let _ = remove(&copied);
    }
    placed
}

/// Copies a file, or a folder with all its content.
fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
    if let Some(folder) = to.parent() {
        fs::create_dir_all(folder)?;
    }
    if !from.is_dir() {
        return fs::copy(from, to).map(|_| ());
    }
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        copy(&entry.path(), &to.join(entry.file_name()))?;
    }
    Ok(())
}

/// Removes a file or folder, if there is one.
fn remove(path: &Path) -> std::io::Result<()> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    match removed {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(()),
        removed => removed,
    }
}

fn same_file(one: &Path, other: &Path) -> bool {
    matches!((fs::canonicalize(one), fs::canonicalize(other)), (Ok(one), Ok(other)) if one == other)
}

#[cfg(windows)]
mod command {
    //! The commands themselves.

    use super::{Error, Folders, Path, PathBuf};
    use crate::args::InstallArgs;
    use crate::summary::print;

    /// Installs the package that this program lies in.
    pub fn install(args: &InstallArgs) -> Result<(), Error> {
        let folders = folders(args)?;
        let program = running()?;
        let installed = folders.install(program.parent().unwrap_or(Path::new(".")))?;
        let mut words: String = installed.iter().map(|path| format!("{}\n", path.display())).collect();
        words.push_str("Done. Have your host look for new plug-ins (rescan).\n");
        let program = folders.programs.join(super::PROGRAM);
        let example = "render --preset hearth --seconds 10 --output hearth.wav";
        words.push_str(&format!("To hear fire without a host: \"{}\" {example}\n", program.display()));
        print(&words);
        Ok(())
    }

    /// Removes what was installed.
    pub fn uninstall(args: &InstallArgs) -> Result<(), Error> {
        match folders(args)?.uninstall(&running()?)? {
            None => print("Pyrophone is removed. Your own presets and recordings stay.\n"),
            Some(left) => print(&format!(
                "Pyrophone is removed, except for this program, which still runs; delete it: {}\n",
                left.display()
            )),
        }
        Ok(())
    }

    fn running() -> Result<PathBuf, Error> {
        std::env::current_exe()
            .map_err(|error| Error::Conflict(format!("Windows does not tell where this program is: {error}")))
    }

    fn folders(args: &InstallArgs) -> Result<Folders, Error> {
        Folders::new(args.system, dirs::document_dir(), |name| std::env::var_os(name).map(PathBuf::from))
    }
}

#[cfg(windows)]
pub use command::{install, uninstall};

#[cfg(test)]
mod tests {
    use super::*;

    /// A folder with an unpacked package, and the folders of a Windows in it.
    fn unpacked(is_for_all: bool) -> (tempfile::TempDir, Folders) {
        let place = tempfile::tempdir().unwrap();
        let package = place.path().join("unpacked package");
        for file in ["Pyrophone.clap", "Pyrophone.vst3/Contents/x86_64-win/Pyrophone.vst3", PROGRAM, "README.md"] {
            write(&package.join(file), "new");
        }
        write(&package.join(PACKED_PRESETS).join("Hearth.vstpreset"), "new");
        let folders =
            Folders::new(is_for_all, Some(place.path().join("Documents")), |name| Some(place.path().join(name)))
                .unwrap();
        (place, folders)
    }

    fn write(path: &Path, text: &str) {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// Paths of all files below a folder, with slashes.
    fn files(folder: &Path) -> Vec<String> {
        let mut found = vec![];
        let mut folders = vec![folder.to_owned()];
        while let Some(next) = folders.pop() {
            for entry in fs::read_dir(&next).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    found.push(path.strip_prefix(folder).unwrap().to_str().unwrap().replace('\\', "/"));
                }
            }
        }
        found.sort();
        found
    }

    #[test]
    fn installed_files_are_where_hosts_look_and_go_again() {
        let (user, system) = (
            [
                "LOCALAPPDATA/Programs/Common/CLAP",
                "LOCALAPPDATA/Programs/Common/VST3",
                "LOCALAPPDATA/Programs/Pyrophone",
            ],
            ["CommonProgramFiles/CLAP", "CommonProgramFiles/VST3", "ProgramFiles/Pyrophone"],
        );
        for (is_for_all, [clap, vst3, programs]) in [(false, user), (true, system)] {
            let (place, folders) = unpacked(is_for_all);
            let package = place.path().join("unpacked package");
            let presets = "Documents/VST3 Presets/Pyrophone/Pyrophone";
            let users = format!("{presets}/Mine.vstpreset");
            write(&place.path().join(&users), "the user's");
            write(&place.path().join(presets).join("Factory/Old.vstpreset"), "old");
            write(&place.path().join(clap).join("Pyrophone.clap"), "old");
            write(&place.path().join(clap).join("Other.clap"), "another's");
            folders.install(&package).unwrap();
            let mut expected = vec![
                format!("{clap}/Other.clap"),
                format!("{clap}/Pyrophone.clap"),
                format!("{vst3}/Pyrophone.vst3/Contents/x86_64-win/Pyrophone.vst3"),
                format!("{programs}/{PROGRAM}"),
                format!("{presets}/Factory/Hearth.vstpreset"),
                users.clone(),
            ];
            expected.sort();
            fs::rename(&package, place.path().with_extension("package")).unwrap();
            assert_eq!(files(place.path()), expected);
            assert_eq!(fs::read(place.path().join(clap).join("Pyrophone.clap")).unwrap(), b"new");
            assert_eq!(folders.uninstall(&place.path().join("another program")).unwrap(), None);
            let mut expected = vec![format!("{clap}/Other.clap"), users];
            expected.sort();
            assert_eq!(files(place.path()), expected);
            assert!(!place.path().join(programs).exists(), "an empty folder stays");
            // Once more, with nothing there.
            assert_eq!(folders.uninstall(&place.path().join("another program")).unwrap(), None);
            fs::remove_dir_all(place.path().with_extension("package")).unwrap();
        }
    }

    #[test]
    fn incomplete_package_installs_nothing() {
        let (place, folders) = unpacked(false);
        let package = place.path().join("unpacked package");
        fs::remove_dir_all(package.join("Pyrophone.vst3")).unwrap();
        let message = folders.install(&package).unwrap_err().to_string();
        assert!(message.contains("Pyrophone.vst3 is not in") && message.contains("unpack"), "{message}");
        assert!(folders.contents().iter().all(|(_, installed)| !installed.exists()));
    }

    #[test]
    fn installed_program_that_runs_is_left_and_named() {
        let (place, folders) = unpacked(false);
        folders.install(&place.path().join("unpacked package")).unwrap();
        let program = folders.programs.join(PROGRAM);
        assert_eq!(folders.uninstall(&program).unwrap(), Some(program.clone()));
        assert!(program.exists() && !folders.clap.join("Pyrophone.clap").exists());
        // It installs nothing from its own folder either, which is no package.
        let message = folders.install(&folders.programs).unwrap_err().to_string();
        assert!(message.contains("unpack the whole package"), "{message}");
    }

    #[test]
    fn missing_variable_of_windows_is_named() {
        for (is_for_all, name) in [(false, "LOCALAPPDATA"), (true, "CommonProgramFiles")] {
            let error = Folders::new(is_for_all, Some(PathBuf::from("/Documents")), |_| None).unwrap_err();
            assert!(error.to_string().contains(name), "{error}");
        }
        assert!(Folders::new(false, None, |name| Some(Path::new("/").join(name))).is_err());
    }
}
