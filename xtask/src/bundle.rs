//! The plug-in as CLAP and VST3 bundles.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};

use crate::{cargo, project};

const PACKAGE: &str = "pyrophone-plugin";
/// The plugin's library as Cargo names it.
const LIBRARY: &str = "pyrophone";
/// The bundles' name in `bundler.toml`.
const NAME: &str = "Pyrophone";

/// `moduleinfo.json` of the VST3 bundle, which hosts read without loading it.
const MODULE_INFO: &str = include_str!("../moduleinfo.json");

/// Build profile.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Profile {
    /// Build with debug assertions.
    Dev,
    /// Build for use.
    Release,
}

impl Profile {
    /// Flags for Cargo.
    fn flags(self) -> Vec<String> {
        match self {
            Self::Dev => vec![],
            Self::Release => vec!["--release".to_owned()],
        }
    }

    /// Name of its folder in the target folder.
    fn folder(self) -> &'static str {
        match self {
            Self::Dev => "debug",
            Self::Release => "release",
        }
    }
}

/// Builds the bundles and gives their paths, CLAP first.
pub fn bundle(profile: Profile) -> Result<[PathBuf; 2]> {
    let status = cargo::command().args(["build", "--package", PACKAGE]).args(profile.flags()).status()?;
    ensure!(status.success(), "the plugin does not build; see above");
    wrap(profile)
}

/// Makes the bundles of a library already built, and returns their paths, CLAP first.
pub fn wrap(profile: Profile) -> Result<[PathBuf; 2]> {
    let target = project::target_dir();
    // The bundler expects a library named after its package.
    let folder = target.join(profile.folder());
    let built = folder.join(format!("{DLL_PREFIX}{LIBRARY}{DLL_SUFFIX}"));
    let expected = folder.join(format!("{DLL_PREFIX}{}{DLL_SUFFIX}", PACKAGE.replace('-', "_")));
    if built.exists() {
        fs::copy(&built, &expected).with_context(|| format!("copying {}", built.display()))?;
    }
    nice_plug_xtask::bundle(&target, PACKAGE, &profile.flags(), false)?;

    let bundles = paths();
    for path in &bundles {
        ensure!(path.exists(), "{} was not made; does the plugin export this format?", path.display());
    }
    describe(&bundles[1])?;
    Ok(bundles)
}

/// Adds the description of a VST3 bundle that hosts read without loading it. The validator compares it with the library
/// itself.
pub fn describe(bundle: &Path) -> Result<()> {
    let folder = bundle.join("Contents/Resources");
    fs::create_dir_all(&folder).with_context(|| format!("making {}", folder.display()))?;
    let text = MODULE_INFO.replace("VERSION", env!("CARGO_PKG_VERSION"));
    fs::write(folder.join("moduleinfo.json"), text).with_context(|| format!("writing to {}", folder.display()))
}

/// Paths of the bundles, CLAP first.
pub fn paths() -> [PathBuf; 2] {
    ["clap", "vst3"].map(|extension| project::target_dir().join("bundled").join(format!("{NAME}.{extension}")))
}
