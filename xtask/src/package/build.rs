//! Building plugin and command line for another system, or for older versions of this one.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};

use super::system::System;
use crate::{cargo, project};

/// Oldest C library that Linux packages run with: that of Debian 11 and Ubuntu 20.04.
pub const GLIBC: &str = "2.31";

/// Packages built for a release.
const PACKAGES: [&str; 4] = ["--package", "pyrophone-plugin", "--package", "pyrophone-cli"];

/// Tools that link against an older C library, from the Python package index: pinned, so that two builds are the same.
const ZIG: [&str; 2] = ["ziglang==0.17.1", "cargo-zigbuild==0.24.1"];

/// Debian's compiler: rustup has the standard library of this machine only, Debian has its source.
const DEBIAN_CARGO: &str = "/usr/bin/cargo";

/// Links for Windows, and compiles C for it.
pub const WINDOWS_LINKER: &str = "x86_64-w64-mingw32-gcc";

/// Result of a build.
#[derive(Debug)]
pub struct Built {
    /// The plugin's library.
    pub library: PathBuf,
    /// The command line.
    pub program: PathBuf,
}

/// Builds for a system; needs about ten minutes of one processor from scratch.
pub fn build(system: System) -> Result<Built> {
    let folder = project::target_dir().join("cross");
    let mut command = match system {
        System::Linux => zig_command()?,
        System::Windows => debian_command(System::Windows.triple(), WINDOWS_LINKER),
    };
    command.args(PACKAGES);
    finish(command, system.name())?;
    let release = folder.join(system.triple()).join("release");
    let built = Built { library: release.join(system.library()), program: release.join(system.program()) };
    for path in [&built.library, &built.program] {
        ensure!(path.exists(), "{} was not made", path.display());
    }
    Ok(built)
}

/// Builds optimised programs of the workspace with Debian's compiler and this linker; returns the path of one of them.
/// `targets` are Cargo's arguments for the things to build.
pub fn program(targets: &[&str], triple: &str, linker: &str, file: &str) -> Result<PathBuf> {
    let mut command = debian_command(triple, linker);
    command.args(targets);
    finish(command, triple)?;
    let path = project::target_dir().join("cross").join(triple).join("release").join(file);
    ensure!(path.exists(), "{} was not made", path.display());
    Ok(path)
}

/// Builds plugin and command line for macOS, unoptimised, by a linker that finds its libraries in a development kit;
/// returns the path of the plugin's library.
pub fn link(triple: &str, linker: &Path, kit: &Path) -> Result<PathBuf> {
    let mut command = debian_command(triple, &linker.to_string_lossy());
    command.args(PACKAGES).env("SDKROOT", kit);
    // Nobody runs the result, and optimising takes most of the time. Stripping for macOS needs macOS's own program.
    command.env("CARGO_PROFILE_RELEASE_OPT_LEVEL", "0").env("CARGO_PROFILE_RELEASE_STRIP", "none");
    finish(command, triple)?;
    let library = project::target_dir().join("cross").join(triple).join("release/libpyrophone.dylib");
    ensure!(library.exists(), "{} was not made", library.display());
    Ok(library)
}

/// Runs a build.
fn finish(mut command: Command, name: &str) -> Result<()> {
    command.current_dir(project::root()).arg("--release");
    let folder = project::target_dir().join("cross");
    // Linkers for Windows sort imports by the paths of the libraries, some of which are temporary. So those lie beside the
    // others, or the order would depend on where the project lies.
    let temporary = folder.join("tmp");
    std::fs::create_dir_all(&temporary).with_context(|| temporary.display().to_string())?;
    command.env("TMPDIR", &temporary).env("CARGO_TARGET_DIR", &folder).env("CARGO_INCREMENTAL", "0");
    // Paths of this machine do not belong in released programs, and would make two builds differ.
    command.env("RUSTFLAGS", remapped());
    // Linkers for Windows would write the present time. 1980-01-01, in seconds, as in the archives.
    command.env("SOURCE_DATE_EPOCH", "315532800");
    let status = command.status().with_context(|| format!("calling {:?}", command.get_program()))?;
    ensure!(status.success(), "the build for {name} failed; see above");
    Ok(())
}

/// Cargo through zig, which links against an older C library.
fn zig_command() -> Result<Command> {
    let tools = zig_tools()?;
    let mut command = cargo::command();
    command.args(["zigbuild", "--target", &format!("{}.{GLIBC}", System::Linux.triple())]);
    let path = std::env::var_os("PATH").unwrap_or_default();
    let paths = std::iter::once(tools.join("bin")).chain(std::env::split_paths(&path));
    command.env("PATH", std::env::join_paths(paths).context("PATH")?);
    Ok(command)
}

/// The folder of a Python environment with zig in it, created at the first call.
pub fn zig_tools() -> Result<PathBuf> {
    let tools = project::target_dir().join("packages-tools");
    if !tools.join("bin/cargo-zigbuild").exists() {
        let made = Command::new("python3").args(["-m", "venv"]).arg(&tools).status().context("calling python3")?;
        ensure!(made.success(), "python3 cannot create an environment; install Debian's python3-venv");
        let installed = Command::new(tools.join("bin/pip")).args(["install", "--quiet"]).args(ZIG).status()?;
        ensure!(installed.success(), "{} cannot be installed; see above", ZIG.join(" and "));
    }
    Ok(tools)
}

/// Debian's Cargo for another system, linked by this linker.
fn debian_command(triple: &str, linker: &str) -> Command {
    let mut command = debian_cargo();
    let name = triple.replace('-', "_");
    command.env(format!("CARGO_TARGET_{}_LINKER", name.to_uppercase()), linker).env(format!("CC_{name}"), linker);
    command.args(["build", STANDARD_LIBRARY, "--target", triple]);
    command
}

/// The standard library is compiled like everything else.
const STANDARD_LIBRARY: &str = "-Zbuild-std=std,panic_unwind";

/// Debian's Cargo and compiler, which find the source of the standard library.
fn debian_cargo() -> Command {
    let mut command = Command::new(DEBIAN_CARGO);
    // rustup's variables would select its own compiler, which cannot build for Windows.
    for name in ["RUSTUP_TOOLCHAIN", "RUSTUP_HOME", "CARGO", "RUSTC_WRAPPER", "RUSTC_WORKSPACE_WRAPPER"] {
        command.env_remove(name);
    }
    command.env("RUSTC", "/usr/bin/rustc").env("RUSTDOC", "/usr/bin/rustdoc").env("PATH", "/usr/bin:/bin");
    command.env("RUSTC_BOOTSTRAP", "1");
    command
}

/// Flags that replace the paths of the workspace and the registry by neutral names.
fn remapped() -> String {
    let registry = std::env::var_os("CARGO_HOME").map(PathBuf::from);
    let registry = registry.or_else(|| Some(PathBuf::from(std::env::var_os("HOME")?).join(".cargo")));
    let renamed = |path: &Path, name: &str| format!("--remap-path-prefix={}={name}", path.display());
    let mut flags = vec![renamed(project::root(), "pyrophone")];
    flags.extend(registry.map(|path| renamed(&path, "cargo")));
    flags.join(" ")
}
