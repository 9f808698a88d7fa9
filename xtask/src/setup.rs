//! Requirements besides Rust, installed if missing and possible.

use std::env::consts::EXE_SUFFIX;
use std::env::{split_paths, var_os};
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Result, bail, ensure};

/// Requirement that may be missing.
#[derive(Debug)]
pub struct Need {
    found: Found,
    /// Debian's package.
    package: &'static str,
    /// Its purpose.
    purpose: &'static str,
}

#[derive(Debug)]
enum Found {
    /// A program in PATH.
    Program(&'static str),
    /// A library in one of the system's folders.
    Library(&'static str),
    /// A file or a folder of Debian's Rust, which must be new enough for this project.
    Toolchain(&'static str),
    /// A file, such as a program outside PATH.
    File(&'static str),
    /// A module that Python imports.
    Module(&'static str),
    /// A module that Debian's own Python imports, whichever other comes first in PATH.
    DebianModule(&'static str),
    /// A driver that Mesa opens by its path, in the first of these folders that exists.
    Driver(&'static str),
}

const LINKER: Need = Need { found: Found::Program("cc"), package: "gcc", purpose: "linking" };
const C_LIBRARY: Need = Need { found: Found::Library("crt1.o"), package: "libc6-dev", purpose: "linking" };

/// Requirements for building and making sound.
pub const BUILD: [Need; 2] = [LINKER, C_LIBRARY];

/// Enough for the tests too: they open the editor on a screen that is not there.
pub const TEST: [Need; 11] = [
    LINKER,
    C_LIBRARY,
    Need { found: Found::Program("Xvfb"), package: "xvfb", purpose: "a screen for the editor's test" },
    library("libX11.so.6", "libx11-6"),
    library("libX11-xcb.so.1", "libx11-xcb1"),
    library("libxcb.so.1", "libxcb1"),
    library("libxkbcommon.so.0", "libxkbcommon0"),
    library("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
    library("libEGL.so.1", "libegl1"),
    library("libGL.so.1", "libgl1"),
    Need { found: Found::Driver("swrast_dri.so"), package: "libgl1-mesa-dri", purpose: "drawing the editor" },
];

/// Requirements for Linux packages: another C library comes with a package from the Python index.
pub const LINUX_PACKAGE: [Need; 5] =
    [LINKER, C_LIBRARY, PYTHON_ENVIRONMENTS, program("objdump", "binutils"), program("dpkg-deb", "dpkg")];

/// Debian's compiler, with the source of its standard library. Security updates bring new versions, so that an outdated
/// list of packages leads to one that is too old.
const DEBIAN_COMPILER: &str = "/usr/bin/rustc";
const DEBIAN_RUSTC: Need = toolchain(DEBIAN_COMPILER, "rustc-web");
const DEBIAN_CARGO: Need = toolchain("/usr/bin/cargo", "cargo-web");
const DEBIAN_SOURCE: Need = toolchain("/usr/lib/rustlib/src/rust/library/std", "rust-web-src");

/// Enough to write caches with OpenVDB's own library.
pub const CACHES: [Need; 4] =
    [LINKER, C_LIBRARY, debian_module("numpy", "python3-numpy"), debian_module("pyopenvdb", "python3-openvdb")];

/// Debian separates the part that creates environments from Python itself.
const PYTHON_ENVIRONMENTS: Need =
    Need { found: Found::Module("ensurepip"), package: "python3-venv", purpose: PACKAGES };

/// Enough to build packages for Windows.
pub const WINDOWS_PACKAGE: [Need; 8] = [
    LINKER,
    C_LIBRARY,
    DEBIAN_RUSTC,
    DEBIAN_CARGO,
    DEBIAN_SOURCE,
    program("x86_64-w64-mingw32-gcc", "gcc-mingw-w64-x86-64"),
    program("zip", "zip"),
    program("unzip", "unzip"),
];

/// Requirements for linking for macOS.
pub const MACOS_CHECK: [Need; 4] = [DEBIAN_RUSTC, DEBIAN_CARGO, DEBIAN_SOURCE, PYTHON_ENVIRONMENTS];

/// Enough to build for Linux on 64-bit ARM.
pub const ARM_BUILD: [Need; 5] = [
    DEBIAN_RUSTC,
    DEBIAN_CARGO,
    DEBIAN_SOURCE,
    program("aarch64-linux-gnu-gcc", "gcc-aarch64-linux-gnu"),
    // The compiler only recommends it.
    file("/usr/aarch64-linux-gnu/lib/crti.o", "libc6-dev-arm64-cross"),
];

/// Enough to run programs for other processors.
pub const EMULATOR: [Need; 1] = [emulation(Found::Program("qemu-aarch64"), "qemu-user")];

/// Enough to run what is built for Windows, and to look at it.
pub const WINE: [Need; 5] = [
    emulation(Found::File("/usr/lib/wine/wine64"), "wine64"),
    emulation(Found::Program("Xvfb"), "xvfb"),
    emulation(Found::Program("xdotool"), "xdotool"),
    emulation(Found::Program("import"), "imagemagick"),
    emulation(Found::Program("xwininfo"), "x11-utils"),
];

const PACKAGES: &str = "making packages";

const fn emulation(found: Found, package: &'static str) -> Need {
    Need { found, package, purpose: "trying out programs for other systems" }
}

const fn toolchain(path: &'static str, package: &'static str) -> Need {
    Need { found: Found::Toolchain(path), package, purpose: PACKAGES }
}

const fn file(path: &'static str, package: &'static str) -> Need {
    Need { found: Found::File(path), package, purpose: PACKAGES }
}

const fn program(name: &'static str, package: &'static str) -> Need {
    Need { found: Found::Program(name), package, purpose: PACKAGES }
}

const fn debian_module(name: &'static str, package: &'static str) -> Need {
    Need { found: Found::DebianModule(name), package, purpose: "writing caches" }
}

const fn library(name: &'static str, package: &'static str) -> Need {
    Need { found: Found::Library(name), package, purpose: "the plugin's editor" }
}

/// Installs missing requirements, or fails with the command that would. On systems other than Linux nothing is checked.
pub fn ensure(needs: &[Need]) -> Result<()> {
    if !cfg!(target_os = "linux") {
        return Ok(());
    }
    let missing: Vec<&Need> = needs.iter().filter(|need| !need.is_met()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    for need in &missing {
        eprintln!("missing or outdated: {} ({})", need.package, need.purpose);
    }
    let packages: Vec<&str> = missing.iter().map(|need| need.package).collect();
    let by_hand = format!("apt-get update && apt-get install -y --no-install-recommends {}", packages.join(" "));
    ensure!(
        is_program("apt-get"),
        "this system has no apt-get; install the equivalents of Debian's {} and try again",
        packages.join(" ")
    );
    if !is_root() && !sudo_asks_nothing() {
        bail!("run this once, then try again:\n  sudo sh -c '{by_hand}'");
    }
    eprintln!("installing {}", packages.join(" "));
    // An outdated list of packages may still be good enough.
    let _ = apt_get(&["update"]);
    let mut install = vec!["install", "-y", "--no-install-recommends"];
    install.extend(&packages);
    ensure!(apt_get(&install)?, "apt-get failed; see above. Run this yourself, then try again:\n  {by_hand}");
    if let Some(need) = missing.iter().find(|need| !need.is_met()) {
        bail!("{} is installed, but {:?} is still not found, or too old", need.package, need.found);
    }
    Ok(())
}

impl Need {
    fn is_met(&self) -> bool {
        match self.found {
            Found::Program(name) => is_program(name),
            Found::Toolchain(path) => Path::new(path).exists() && has_new_rust(),
            Found::File(path) => Path::new(path).is_file(),
            Found::Module(name) => imports("python3", name),
            Found::DebianModule(name) => imports("/usr/bin/python3", name),
            Found::Library(name) => library_folders().any(|folder| Path::new(&folder).join(name).exists()),
            Found::Driver(name) => library_folders().any(|folder| {
                let folder = Path::new(&folder);
                // Since version 24 Mesa has one library for all drivers.
                folder.join("dri").join(name).exists()
                    || std::fs::read_dir(folder).is_ok_and(|entries| {
                        entries.flatten().any(|entry| entry.file_name().to_string_lossy().starts_with("libgallium"))
                    })
            }),
        }
    }
}

/// True if Debian's compiler is new enough for this project.
fn has_new_rust() -> bool {
    let found = Command::new(DEBIAN_COMPILER).arg("--version").output();
    found.is_ok_and(|found| is_new_enough(&String::from_utf8_lossy(&found.stdout), env!("CARGO_PKG_RUST_VERSION")))
}

/// True if what a compiler says of itself, such as `rustc 1.95.0 (…)`, is at least this version.
fn is_new_enough(said: &str, needed: &str) -> bool {
    let numbers = |version: &str| version.split('.').map_while(|part| part.parse().ok()).collect::<Vec<u32>>();
    said.split(' ').nth(1).is_some_and(|version| numbers(version) >= numbers(needed))
}

/// Folders of shared libraries, on Debian and elsewhere.
fn library_folders() -> impl Iterator<Item = String> {
    let triplet = format!("{}-linux-gnu", std::env::consts::ARCH);
    ["/usr/lib", "/lib", "/usr/local/lib"]
        .into_iter()
        .flat_map(move |folder| [format!("{folder}/{triplet}"), folder.to_owned(), format!("{folder}64")])
}

/// The missing ones of these, by Debian's names.
pub fn missing(needs: &[Need]) -> Vec<&'static str> {
    needs.iter().filter(|need| !need.is_met()).map(|need| need.package).collect()
}

/// True if a Python exists and has a module.
fn imports(python: &str, name: &str) -> bool {
    let mut python = Command::new(python);
    python.args(["-c", &format!("import {name}")]).stdout(Stdio::null()).stderr(Stdio::null());
    python.status().is_ok_and(|status| status.success())
}

/// True if a program is in PATH.
pub fn is_program(name: &str) -> bool {
    let file = format!("{name}{EXE_SUFFIX}");
    var_os("PATH").is_some_and(|path| split_paths(&path).any(|folder| folder.join(&file).is_file()))
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|id| id.stdout.trim_ascii() == b"0")
}

fn sudo_asks_nothing() -> bool {
    let sudo = Command::new("sudo").args(["-n", "true"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    sudo.is_ok_and(|status| status.success())
}

fn apt_get(arguments: &[&str]) -> Result<bool> {
    let mut command = if is_root() { Command::new("env") } else { Command::new("sudo") };
    if !is_root() {
        command.args(["-n", "env"]);
    }
    let status = command.args(["DEBIAN_FRONTEND=noninteractive", "apt-get", "-qq"]).args(arguments).status()?;
    Ok(status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_compiler_of_an_old_release_is_outdated() {
        assert!(is_new_enough("rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)", "1.95"));
        assert!(is_new_enough("rustc 1.95.0", "1.95"));
        assert!(!is_new_enough("rustc 1.85.0 (4d91de4e4 2025-02-17)", "1.95"));
        assert!(!is_new_enough("", "1.95"));
    }
}
