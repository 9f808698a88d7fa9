//! Installing the bundles where hosts look for plug-ins.

use std::env::var_os;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::bundle::{self, Profile};
use crate::{cargo, setup};

/// Options of `cargo xtask install`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Install for all users instead of the current one
    #[arg(long)]
    system: bool,
    /// Into this folder instead of the usual ones
    #[arg(long, value_name = "DIR", conflicts_with = "system")]
    to: Option<PathBuf>,
}

/// Builds the release bundles and installs them.
pub fn run(args: &Args) -> Result<()> {
    setup::ensure(&setup::BUILD)?;
    let bundles = bundle::bundle(Profile::Release)?;
    let folders = match &args.to {
        Some(folder) => [folder.clone(), folder.clone()],
        None if args.system => system_folders(),
        None => user_folders()?,
    };
    for (bundle, folder) in bundles.iter().zip(&folders) {
        let name = bundle.file_name().context("a bundle without a name")?;
        let installed = folder.join(name);
        replace(bundle, &installed).with_context(|| format!("installing {}", installed.display()))?;
        println!("{}", installed.display());
    }
    match preset_folder(args.to.as_deref(), args.system) {
        Some(folder) => write_presets(&folder),
        None => Ok(()),
    }
}

/// Writes the factory presets in VST3's form.
fn write_presets(folder: &Path) -> Result<()> {
    let mut writing = cargo::command();
    writing.args(["run", "--quiet", "--release", "--package", "pyrophone-settings", "--example", "vst3_presets", "--"]);
    ensure!(writing.arg(folder).status()?.success(), "the presets cannot be written to {}", folder.display());
    Ok(())
}

/// Folder in which VST3 hosts look for the factory presets: a separate one, so that it can be removed with all its
/// content. None where the system has no such place.
pub fn preset_folder(named: Option<&Path>, is_system: bool) -> Option<PathBuf> {
    const PLACE: &str = "Pyrophone/Pyrophone/Factory";
    if let Some(named) = named {
        return Some(named.join("presets").join(PLACE));
    }
    let home =
        |below: &str| var_os(if cfg!(windows) { "USERPROFILE" } else { "HOME" }).map(|at| Path::new(&at).join(below));
    let presets = match (is_system, std::env::consts::OS) {
        (false, "windows") => home("Documents/VST3 Presets"),
        (false, "macos") => home("Library/Audio/Presets"),
        (false, _) => home(".vst3/presets"),
        (true, "macos") => Some(PathBuf::from("/Library/Audio/Presets")),
        (true, "linux") => Some(PathBuf::from("/usr/share/vst3/presets")),
        (true, _) => None,
    };
    Some(presets?.join(PLACE))
}

/// The CLAP and the VST3 folder of the present user.
pub fn user_folders() -> Result<[PathBuf; 2]> {
    let variable = if cfg!(windows) { "LOCALAPPDATA" } else { "HOME" };
    let home = PathBuf::from(var_os(variable).with_context(|| format!("{variable} is not set; name the folder"))?);
    Ok(if cfg!(windows) {
        ["CLAP", "VST3"].map(|format| home.join("Programs/Common").join(format))
    } else if cfg!(target_os = "macos") {
        ["CLAP", "VST3"].map(|format| home.join("Library/Audio/Plug-Ins").join(format))
    } else {
        [".clap", ".vst3"].map(|format| home.join(format))
    })
}

/// The CLAP and the VST3 folder of all users.
pub fn system_folders() -> [PathBuf; 2] {
    if cfg!(windows) {
        let common = var_os("CommonProgramFiles").unwrap_or_else(|| r"C:\Program Files\Common Files".into());
        ["CLAP", "VST3"].map(|format| PathBuf::from(&common).join(format))
    } else if cfg!(target_os = "macos") {
        ["CLAP", "VST3"].map(|format| Path::new("/Library/Audio/Plug-Ins").join(format))
    } else {
        ["clap", "vst3"].map(|format| Path::new("/usr/lib").join(format))
    }
}

/// Copies a file or a whole folder over an existing one. The old one is removed, not overwritten: a host that has it
/// open keeps the loaded version.
fn replace(from: &Path, to: &Path) -> std::io::Result<()> {
    if to.is_dir() {
        fs::remove_dir_all(to)?;
    } else if to.exists() {
        fs::remove_file(to)?;
    }
    copy(from, to)
}

/// Copies a file or a whole folder, and creates the folders above it.
pub fn copy(from: &Path, to: &Path) -> std::io::Result<()> {
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
