//! What the PowerShell scripts of the Windows package install and remove, read from their text: where packages are made
//! there is no PowerShell to run them.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::{Context, Result, ensure};

/// The script that installs.
const INSTALL: &str = include_str!("../../../packages/windows/install.ps1");

/// Checks that a laid-out package has everything that its script installs.
pub fn check(stage: &Path) -> Result<()> {
    for (name, _) in installed(INSTALL, Users::Present)? {
        ensure!(
            stage.join(name.replace('\\', "/")).exists(),
            "install.ps1 installs {name}, which is not in the package"
        );
    }
    Ok(())
}

/// For whom a script works.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Users {
    Present,
    /// With `-System`.
    All,
}

/// The lines of a script that count for these users.
fn lines(text: &str, users: Users) -> Vec<&str> {
    // The users of the present block; none outside of `if ($System) { ... } else { ... }`.
    let mut block = None;
    let is_for_them = |line: &&str| {
        block = match *line {
            "if ($System) {" => Some(Users::All),
            "} else {" => Some(Users::Present),
            "}" => None,
            _ => block,
        };
        block.is_none_or(|block| block == users)
    };
    text.lines().map(str::trim).filter(is_for_them).collect()
}

/// Expressions by the variables that they are assigned to.
fn variables<'a>(lines: &[&'a str]) -> BTreeMap<&'a str, &'a str> {
    lines.iter().filter_map(|line| line.strip_prefix('$')?.split_once(" = ")).collect()
}

/// Names in the package, and the folders that a script copies them to: lines such as `Put "Pyrophone.clap" $clap`.
fn installed(text: &str, users: Users) -> Result<Vec<(String, String)>> {
    let lines = lines(text, users);
    let variables = variables(&lines);
    let read = |put: &str| {
        let (name, folder) = put.rsplit_once(' ').with_context(|| put.to_owned())?;
        Ok((name.trim_matches('"').to_owned(), path(folder, &variables)?))
    };
    lines.iter().filter_map(|line| line.strip_prefix("Put ")).map(read).collect()
}

/// The path that an expression stands for, such as `(Join-Path $env:ProgramFiles "Pyrophone")`; what the system knows is
/// left as a name between per cent signs.
fn path(expression: &str, variables: &BTreeMap<&str, &str>) -> Result<String> {
    let expression = expression.strip_prefix('(').and_then(|inner| inner.strip_suffix(')')).unwrap_or(expression);
    if let Some(joined) = expression.strip_prefix("Join-Path ") {
        let (folder, name) = joined.split_once(" \"").with_context(|| expression.to_owned())?;
        return Ok(format!("{}\\{}", path(folder, variables)?, name.trim_end_matches('"')));
    }
    if let Some(name) = expression.strip_prefix("$env:") {
        return Ok(format!("%{name}%"));
    }
    if let Some(name) = expression.strip_prefix("[Environment]::GetFolderPath(\"") {
        return Ok(format!("%{}%", name.trim_end_matches("\")")));
    }
    let value = expression.strip_prefix('$').and_then(|name| variables.get(name));
    path(value.with_context(|| format!("{expression} is no path"))?, variables)
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNINSTALL: &str = include_str!("../../../packages/windows/uninstall.ps1");

    /// Paths of installed things.
    fn paths(users: Users) -> Vec<String> {
        let last = |name: &str| name.rsplit('\\').next().unwrap().to_owned();
        let installed = installed(INSTALL, users).unwrap();
        installed.iter().map(|(name, folder)| format!("{folder}\\{}", last(name))).collect()
    }

    /// Paths that are removed: `foreach ($installed in @(PATH, PATH)) {`.
    fn removed(users: Users) -> Vec<String> {
        let lines = lines(UNINSTALL, users);
        let variables = variables(&lines);
        let list = lines.iter().find_map(|line| line.split_once(" in @(")?.1.strip_suffix(")) {")).unwrap();
        list.split(", ").map(|item| path(item, &variables).unwrap()).collect()
    }

    #[test]
    fn plugins_go_where_hosts_look() {
        let presets = r"%MyDocuments%\VST3 Presets\Pyrophone\Pyrophone\Factory";
        let expected = [
            r"%LOCALAPPDATA%\Programs\Common\CLAP\Pyrophone.clap",
            r"%LOCALAPPDATA%\Programs\Common\VST3\Pyrophone.vst3",
            r"%LOCALAPPDATA%\Programs\Pyrophone\pyrophone.exe",
            presets,
        ];
        assert_eq!(paths(Users::Present), expected);
        let expected = [
            r"%CommonProgramFiles%\CLAP\Pyrophone.clap",
            r"%CommonProgramFiles%\VST3\Pyrophone.vst3",
            r"%ProgramFiles%\Pyrophone\pyrophone.exe",
            presets,
        ];
        assert_eq!(paths(Users::All), expected);
    }

    #[test]
    fn all_that_is_installed_is_removed_and_nothing_else() {
        for users in [Users::Present, Users::All] {
            // Pyrophone has a folder of its own for programs.
            let own = |path: String| path.strip_suffix(r"\pyrophone.exe").map_or(path.clone(), str::to_owned);
            assert_eq!(removed(users), paths(users).into_iter().map(own).collect::<Vec<_>>(), "{users:?}");
        }
    }

    #[test]
    fn a_package_without_something_installed_is_found() {
        let stage = tempfile::tempdir().unwrap();
        for name in ["Pyrophone.clap", "pyrophone.exe", "presets/Pyrophone/Pyrophone/Factory"] {
            std::fs::create_dir_all(stage.path().join(name)).unwrap();
        }
        assert!(check(stage.path()).unwrap_err().to_string().contains("Pyrophone.vst3"));
        std::fs::create_dir(stage.path().join("Pyrophone.vst3")).unwrap();
        check(stage.path()).unwrap();
    }

    #[test]
    fn scripts_are_ascii() {
        // Windows' own PowerShell takes a file without a byte order mark to be in the system's code page.
        assert!(INSTALL.is_ascii() && UNINSTALL.is_ascii());
    }
}
