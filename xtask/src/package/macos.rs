//! Linking for macOS without a Mac: by zig, with stubs in place of the system's libraries.
//!
//! A stub only has the name under which macOS knows a library; symbols that no library here defines are left for macOS
//! to find. This shows that everything links and that hosts find the entry points, but nothing that runs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use goblin::mach::MachO;

use super::{MACOS, build};
use crate::project;

/// Frameworks that plugin and command line link with.
const FRAMEWORKS: [&str; 6] = ["AppKit", "CoreFoundation", "CoreGraphics", "Foundation", "OpenGL", "QuartzCore"];

/// Libraries that they link with: the linker's names, and macOS's.
const LIBRARIES: [(&str, &str); 3] = [("System", "libSystem.B"), ("iconv", "libiconv.2"), ("objc", "libobjc.A")];

/// Symbols that hosts look up.
const ENTRIES: [&str; 4] = ["GetPluginFactory", "bundleEntry", "bundleExit", "clap_entry"];

/// Links plugin and command line for both processors, without optimising them, and checks the plugin's entry points.
pub fn link() -> Result<()> {
    let folder = project::target_dir().join("macos");
    let stubs = folder.join("stubs");
    write_stubs(&stubs)?;
    for triple in MACOS {
        let linker = folder.join(format!("link-{triple}"));
        write_linker(&linker, triple)?;
        let library = build::link(triple, &linker, &stubs)?;
        // Zig exports everything else as well: it does not know the list of names that Apple's linker takes from rustc.
        let exports = exports(&library)?;
        for entry in ENTRIES {
            ensure!(exports.iter().any(|name| name == entry), "{} does not export {entry}", library.display());
        }
    }
    Ok(())
}

/// Lays out stubs as macOS's software development kit does its own.
fn write_stubs(folder: &Path) -> Result<()> {
    let write = |path: PathBuf, name: &str| {
        fs::create_dir_all(path.parent().unwrap_or(folder))?;
        fs::write(&path, stub(name)).with_context(|| format!("writing {}", path.display()))
    };
    for name in FRAMEWORKS {
        let path = folder.join(format!("System/Library/Frameworks/{name}.framework/{name}.tbd"));
        write(path, &format!("/System/Library/Frameworks/{name}.framework/Versions/A/{name}"))?;
    }
    for (name, installed) in LIBRARIES {
        write(folder.join(format!("usr/lib/lib{name}.tbd")), &format!("/usr/lib/{installed}.dylib"))?;
    }
    Ok(())
}

/// Text of a stub for the library that macOS knows by this path.
fn stub(installed: &str) -> String {
    let targets = "targets: [ arm64-macos, x86_64-macos ]";
    format!("--- !tapi-tbd\ntbd-version: 4\n{targets}\ninstall-name: '{installed}'\n...\n")
}

/// Writes a script that links for a target, by Rust's name.
fn write_linker(path: &Path, triple: &str) -> Result<()> {
    let tools = build::zig_tools()?;
    let target = triple.replace("apple-darwin", "macos-none");
    let script = format!(
        "#!/bin/sh\nPATH='{}/bin':$PATH\nexec cargo-zigbuild zig cc -- -target {target} -undefined dynamic_lookup \"$@\"\n",
        tools.display()
    );
    fs::write(path, script).with_context(|| format!("writing {}", path.display()))?;
    let status = Command::new("chmod").arg("+x").arg(path).status().context("calling chmod")?;
    ensure!(status.success(), "{} cannot be made executable", path.display());
    Ok(())
}

/// Symbols that a library exports, sorted, without the underscore that they all have.
fn exports(library: &Path) -> Result<Vec<String>> {
    let bytes = fs::read(library).with_context(|| format!("reading {}", library.display()))?;
    let macho = MachO::parse(&bytes, 0).with_context(|| format!("{} is no Mach-O library", library.display()))?;
    let exports = macho.exports()?;
    let mut names: Vec<String> = exports.iter().map(|export| export.name.trim_start_matches('_').to_owned()).collect();
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stubs_lie_where_the_linker_looks() {
        let folder = tempfile::tempdir().unwrap();
        write_stubs(folder.path()).unwrap();
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        let app_kit = read("System/Library/Frameworks/AppKit.framework/AppKit.tbd");
        assert!(app_kit.contains("install-name: '/System/Library/Frameworks/AppKit.framework/Versions/A/AppKit'"));
        assert!(read("usr/lib/libobjc.tbd").contains("install-name: '/usr/lib/libobjc.A.dylib'"));
    }
}
