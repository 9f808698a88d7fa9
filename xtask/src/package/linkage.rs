//! Symbols that a plugin's library exports, and libraries that it and the command line need from the system.

use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};

use super::build::{Built, GLIBC};
use super::system::System;

/// Symbols that hosts look up on each system: any other could clash with a host's own.
const LINUX_ENTRIES: [&str; 4] = ["GetPluginFactory", "ModuleEntry", "ModuleExit", "clap_entry"];
const WINDOWS_ENTRIES: [&str; 4] = ["ExitDll", "GetPluginFactory", "InitDll", "clap_entry"];

/// Libraries that every desktop has.
const LINUX_LIBRARIES: [&str; 6] =
    ["libc.so.6", "libm.so.6", "libgcc_s.so.1", "libdl.so.2", "libpthread.so.0", "ld-linux-x86-64.so.2"];

/// Libraries in every edition of Windows since 10; prefixes of names, in lower case.
const WINDOWS_LIBRARIES: [&str; 21] = [
    "kernel32",
    "ntdll",
    "user32",
    "gdi32",
    "ole32",
    "oleaut32",
    "shell32",
    "shlwapi",
    "advapi32",
    "bcrypt",
    "opengl32",
    "ws2_32",
    "userenv",
    "msvcrt",
    "api-ms-win-",
    "combase",
    "imm32",
    "dwmapi",
    "uxtheme",
    "secur32",
    "rpcrt4",
];

/// Checks the libraries that were built for a system.
pub fn check(system: System, built: &Built) -> Result<()> {
    match system {
        System::Linux => {
            check_entries(&linux_exports(&built.library)?, &LINUX_ENTRIES, &built.library)?;
            [&built.library, &built.program].into_iter().try_for_each(|path| check_linux_needs(path))
        }
        System::Windows => {
            check_entries(&windows_exports(&built.library)?, &WINDOWS_ENTRIES, &built.library)?;
            [&built.library, &built.program].into_iter().try_for_each(|path| check_windows_needs(path))
        }
    }
}

fn check_entries(found: &[String], expected: &[&str], path: &Path) -> Result<()> {
    ensure!(found == expected, "{} exports {found:?}, but must export {expected:?} alone", path.display());
    Ok(())
}

/// Output lines of a program of the binary utilities for a file.
fn lines(program: &str, flags: &[&str], path: &Path) -> Result<Vec<String>> {
    let output = Command::new(program).args(flags).arg(path).output().with_context(|| format!("calling {program}"))?;
    ensure!(output.status.success(), "{program} cannot read {}", path.display());
    Ok(String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect())
}

fn linux_exports(path: &Path) -> Result<Vec<String>> {
    let symbols = lines("nm", &["--dynamic", "--defined-only", "--extern-only"], path)?;
    let mut names: Vec<String> =
        symbols.iter().filter_map(|line| Some(line.split_whitespace().nth(2)?.to_owned())).collect();
    names.sort();
    Ok(names)
}

fn check_linux_needs(path: &Path) -> Result<()> {
    for line in lines("objdump", &["-p"], path)? {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("NEEDED") => {
                let library = words.next().unwrap_or_default();
                ensure!(LINUX_LIBRARIES.contains(&library), "{} needs {library}", path.display());
            }
            Some(_) => {
                let version = words.nth(2).and_then(|name| name.strip_prefix("GLIBC_"));
                if let Some(version) = version {
                    let is_old = parts(version)? <= parts(GLIBC)?;
                    ensure!(is_old, "{} needs glibc {version}, but {GLIBC} is promised", path.display());
                }
            }
            None => {}
        }
    }
    Ok(())
}

/// A version's numbers, which compare as versions do.
fn parts(version: &str) -> Result<Vec<u32>> {
    version.split('.').map(|part| part.parse().with_context(|| format!("the version {version}"))).collect()
}

const WINDOWS_OBJDUMP: &str = "x86_64-w64-mingw32-objdump";

fn windows_exports(path: &Path) -> Result<Vec<String>> {
    let about = lines(WINDOWS_OBJDUMP, &["-p"], path)?;
    let table = about.iter().position(|line| line.contains("[Ordinal/Name Pointer] Table"));
    let Some(table) = table else { bail!("{} exports nothing", path.display()) };
    // Such as "\t[   0] +base[   1]  0000 ExitDll".
    let entries = about[table + 1..].iter().take_while(|line| line.trim_start().starts_with('['));
    let mut names: Vec<String> =
        entries.filter_map(|line| Some(line.split_whitespace().next_back()?.to_owned())).collect();
    names.sort();
    Ok(names)
}

fn check_windows_needs(path: &Path) -> Result<()> {
    let about = lines(WINDOWS_OBJDUMP, &["-p"], path)?;
    let libraries = about.iter().filter_map(|line| line.trim().strip_prefix("DLL Name: "));
    for library in libraries {
        let small = library.to_ascii_lowercase();
        let is_known = WINDOWS_LIBRARIES.iter().any(|known| small.starts_with(known));
        ensure!(is_known, "{} needs {library}, which not every Windows has", path.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_compare_by_their_numbers() {
        assert!(parts("2.4").unwrap() < parts("2.31").unwrap());
        assert!(parts("2.31").unwrap() <= parts("2.31").unwrap());
        assert!(parts("2.31.1").unwrap() > parts("2.31").unwrap());
        assert!(parts("PRIVATE").is_err());
    }

    #[test]
    fn a_symbol_too_many_is_found() {
        let path = Path::new("libpyrophone.so");
        let of = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
        assert!(check_entries(&of(&LINUX_ENTRIES), &LINUX_ENTRIES, path).is_ok());
        assert!(check_entries(&of(&["GetPluginFactory", "clap_entry", "sin"]), &LINUX_ENTRIES, path).is_err());
    }
}
