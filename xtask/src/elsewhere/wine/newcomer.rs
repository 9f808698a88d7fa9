//! The newcomer's path under Wine: the package is unpacked and installed, a fire is lit, and everything is removed again.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use super::super::screen::{Screen, WINDOW};
use super::{Wine, built, stand_in};
use crate::package::{self, System};

/// Folder that the package is unpacked in: a name that scripts must quote.
const DOWNLOADS: &str = "Téléchargements (2)";
/// What is installed, below the user's folder, by the name of the plug-in or program.
const CLAP: &str = "AppData/Local/Programs/Common/CLAP/Pyrophone.clap";
const VST3: &str = "AppData/Local/Programs/Common/VST3/Pyrophone.vst3";
const PROGRAMS: &str = "AppData/Local/Programs/Pyrophone";
const PRESETS: &str = "Documents/VST3 Presets/Pyrophone/Pyrophone/Factory";
/// Button of a new window that lights a fire, and an item that is there when it burns.
const LIGHT: (&str, &str) = ("button.Light", "scene.campfire");

impl Wine {
    /// Unpacks the package, installs it, renders with the installed program, lights a fire in both installed plug-ins, and
    /// removes everything.
    pub fn newcomer(&self, screen: &Screen, folder: &Path) -> Result<()> {
        let unpacked = unpack(folder)?;
        stand_in(&unpacked.join(System::Windows.program()))?;
        self.script("install.cmd", &unpacked)?;
        let home = self.home()?;
        for installed in [CLAP, VST3, PROGRAMS, PRESETS] {
            ensure!(home.join(installed).exists(), "{installed} is not installed");
        }
        let program = home.join(PROGRAMS).join(System::Windows.program());
        stand_in(&program)?;
        self.run(&program, folder, "render --preset hearth --seconds 1 --output newcomer.wav")?;
        ensure!(folder.join("newcomer.wav").exists(), "the installed program has written nothing");
        for (format, installed) in [("clap", CLAP), ("vst3", VST3)] {
            let window = self.open_at(WINDOW, &home.join(installed), folder)?;
            screen.click_until(&window.map, LIGHT).with_context(|| format!("the window of {installed}"))?;
            screen.photograph(&window.map, &folder.join(format!("newcomer.{format}.png")))?;
        }
        // Windows has this library itself.
        fs::remove_file(program.with_file_name("bcryptprimitives.dll"))?;
        self.script("uninstall.cmd", &unpacked)?;
        for installed in [CLAP, VST3, PROGRAMS, PRESETS] {
            ensure!(!home.join(installed).exists(), "{installed} is left behind");
        }
        Ok(())
    }

    /// Runs a script of the package, which waits for a key at its end.
    fn script(&self, name: &str, unpacked: &Path) -> Result<()> {
        let mut command = Command::new(self.program);
        command.args(["cmd", "/c", name]).current_dir(unpacked).stdin(Stdio::null());
        let status = command.envs(self.environment.iter().cloned()).status().context("calling wine")?;
        ensure!(status.success(), "{name}: {status}");
        Ok(())
    }

    /// The present user's folder in this Windows.
    fn home(&self) -> Result<PathBuf> {
        let users = self.installation()?.join("drive_c/users");
        for entry in fs::read_dir(&users).with_context(|| users.display().to_string())? {
            let home = entry?.path();
            if home.join("AppData/Local").is_dir() && !home.ends_with("Public") {
                return Ok(home);
            }
        }
        bail!("there is no user in {}", users.display())
    }
}

/// Makes the package, and unpacks it as a user would; returns its folder.
fn unpack(folder: &Path) -> Result<PathBuf> {
    let packages = package::make(System::Windows, &built(), folder)?;
    let zip = packages.first().context("no package")?;
    let downloads = folder.join(DOWNLOADS);
    if downloads.exists() {
        fs::remove_dir_all(&downloads).with_context(|| downloads.display().to_string())?;
    }
    let unzipped =
        Command::new("unzip").arg("-q").arg(zip).arg("-d").arg(&downloads).status().context("calling unzip")?;
    ensure!(unzipped.success(), "{} cannot be unpacked", zip.display());
    Ok(downloads.join(zip.file_stem().context("a package without a name")?))
}
