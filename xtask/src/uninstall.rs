//! Removal of everything that `install` has installed.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};

use crate::bundle;
use crate::install::{preset_folder, system_folders, user_folders};

/// Options of `cargo xtask uninstall`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Remove the installation for all users, instead of the current one
    #[arg(long)]
    system: bool,
    /// Remove from this folder instead of the usual ones
    #[arg(long, value_name = "DIR", conflicts_with = "system")]
    from: Option<PathBuf>,
}

/// Removes the bundles and the factory presets, and nothing else: the user's presets and recordings stay.
pub fn run(args: &Args) -> Result<()> {
    let folders = match &args.from {
        Some(folder) => [folder.clone(), folder.clone()],
        None if args.system => system_folders(),
        None => user_folders()?,
    };
    for (bundle, folder) in bundle::paths().iter().zip(&folders) {
        let installed = folder.join(bundle.file_name().context("a bundle without a name")?);
        let removed = remove(&installed).with_context(|| format!("removing {}", installed.display()))?;
        println!("{}{}", installed.display(), if removed { "" } else { ": not installed" });
    }
    if let Some(folder) = preset_folder(args.from.as_deref(), args.system)
        && remove(&folder).with_context(|| format!("removing {}", folder.display()))?
    {
        println!("{}", folder.display());
    }
    Ok(())
}

/// Removes a file, a folder with all its content, or a link but not its target; returns true if there was one.
fn remove(path: &Path) -> std::io::Result<bool> {
    let found = match fs::symlink_metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(false),
        Err(error) => return Err(error),
    };
    if found.is_dir() {
        fs::remove_dir_all(path)?
    } else {
        fs::remove_file(path)?
    }
    Ok(true)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uninstall_removes_the_bundles_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir_all(at("Pyrophone.vst3/Contents")).unwrap();
        for name in ["Pyrophone.clap", "Pyrophone.vst3/Contents/a.so", "Pyrophone.toml", "Other.clap"] {
            fs::write(at(name), "x").unwrap();
        }
        let args = Args { system: false, from: Some(folder.path().to_owned()) };
        run(&args).unwrap();
        let mut left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, ["Other.clap", "Pyrophone.toml"]);
        run(&args).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_removed_and_what_it_leads_to_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (built, link) = (folder.path().join("built"), folder.path().join("Pyrophone.vst3"));
        fs::create_dir(&built).unwrap();
        std::os::unix::fs::symlink(&built, &link).unwrap();
        assert!(remove(&link).unwrap());
        assert!(built.is_dir() && !link.is_symlink());
    }
}
