//! What users download: an archive for each system, and the checksums of all.

mod archive;
mod build;
mod contents;
mod licences;
mod linkage;
mod system;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::ValueEnum;

use crate::{project, setup};
use system::System;

/// For which systems.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only for this system instead of all that can be built for here
    #[arg(long, value_enum)]
    system: Option<System>,
}

/// Builds packages for the systems wanted, checks what they link to, and writes their checksums.
pub fn run(args: &Args) -> Result<()> {
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

/// The packages of one system from what was built for it.
fn make(system: System, built: &build::Built, folder: &Path) -> Result<Vec<PathBuf>> {
    let name = format!("pyrophone-{}-{}", env!("CARGO_PKG_VERSION"), system.name());
    let stage = project::target_dir().join("stage").join(&name);
    contents::stage(system, built, &stage)?;
    match system {
        System::Linux => Ok(vec![archive::tar_gz(&stage, folder)?, archive::deb(&stage, folder)?]),
        System::Windows => Ok(vec![archive::zip(&stage, folder)?]),
    }
}
