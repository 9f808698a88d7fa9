//! Packages for download: an archive for each system, and the checksums of all.

mod archive;
mod bill;
pub mod build;
mod contents;
mod licences;
mod linkage;
mod macos;
mod system;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::ValueEnum;

use crate::{project, setup};
pub use contents::bundles;
pub use system::System;

/// Systems to build for.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only for this system instead of all that can be built for here
    #[arg(long, value_enum)]
    system: Option<System>,
    /// Build no packages, but check that plugin and command line compile and link for a system that has none made here
    #[arg(long, value_enum, conflicts_with = "system")]
    check: Option<Checked>,
    /// Build no packages, but write the licences and the bill of materials of the macOS package to this folder
    #[arg(long, value_name = "FOLDER", conflicts_with_all = ["system", "check"])]
    macos_licences: Option<PathBuf>,
}

/// A system that is only checked here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Checked {
    /// macOS on either processor
    Macos,
}

/// Rust's names of macOS.
const MACOS: [&str; 2] = ["aarch64-apple-darwin", "x86_64-apple-darwin"];

/// The targets that are joined in the packages of each system.
#[cfg(test)]
const TARGETS: [&[&str]; 3] = [&["x86_64-unknown-linux-gnu"], &["x86_64-pc-windows-gnu"], &MACOS];

/// Builds packages for the systems wanted, checks what they link to, and writes their checksums.
pub fn run(args: &Args) -> Result<()> {
    if let Some(Checked::Macos) = args.check {
        return check_macos();
    }
    if let Some(folder) = &args.macos_licences {
        return contents::write_licences(&MACOS, folder);
    }
    let systems = args.system.map_or_else(|| System::value_variants().to_vec(), |system| vec![system]);
    let folder = project::target_dir().join("packages");
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    let mut packages = Vec::new();
    for system in systems {
        setup::ensure(system.needs())?;
        let built = build::build(system)?;
        linkage::check(system, &built)?;
        packages.extend(make(system, &built, &folder)?);
    }
    packages.push(archive::write_checksums(&folder)?);
    for package in packages {
        println!("{}", package.display());
    }
    Ok(())
}

/// Compiles and links everything for macOS, with stubs of its system's libraries.
pub fn check_macos() -> Result<()> {
    setup::ensure(&setup::MACOS_CHECK)?;
    macos::link()
}

/// The packages of one system from what was built for it.
pub fn make(system: System, built: &build::Built, folder: &Path) -> Result<Vec<PathBuf>> {
    let name = format!("pyrophone-{}-{}", env!("CARGO_PKG_VERSION"), system.name());
    let stage = project::target_dir().join("stage").join(&name);
    contents::stage(system, built, &stage)?;
    match system {
        System::Linux => Ok(vec![archive::tar_gz(&stage, folder)?, archive::deb(&stage, folder)?]),
        System::Windows => Ok(vec![archive::zip(&stage, folder)?]),
    }
}
