//! Contents of a package.

use std::fs;
use std::path::Path;
use std::process::Command;

use anyhow::{Context, Result, ensure};

use super::build::Built;
use super::system::System;
use super::{bill, licences};
use crate::{bundle, cargo, install, project};

/// Files and folders from the workspace that every package has: the README, and everything that it links to.
const DOCUMENTS: [&str; 7] =
    ["README.md", "docs", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "LICENSE-APACHE", "LICENSE-MIT"];

/// Lays out a package in a folder, which is recreated.
pub fn stage(system: System, built: &Built, stage: &Path) -> Result<()> {
    if stage.exists() {
        fs::remove_dir_all(stage).with_context(|| format!("clearing {}", stage.display()))?;
    }
    let copy = |from: &Path, to: &str| {
        let to = stage.join(to);
        install::copy(from, &to).with_context(|| format!("copying {} to {}", from.display(), to.display()))
    };
    bundles(system, built, stage)?;
    copy(&built.program, system.program())?;
    for document in DOCUMENTS {
        copy(&project::root().join(document), document)?;
    }
    write_licences(&[system.triple()], stage)?;
    for (folder, script) in scripts(system) {
        copy(&project::root().join("packages").join(folder).join(script), script)?;
    }
    write_presets(&stage.join("presets/Pyrophone/Pyrophone/Factory"))?;
    if system == System::Linux {
        write_manual(&built.program, stage)?;
    }
    Ok(())
}

/// Writes a package's third-party information for these targets to a folder: its licences, and its bill of materials.
pub fn write_licences(triples: &[&str], folder: &Path) -> Result<()> {
    for (name, text) in [("THIRD-PARTY.md", licences::page(triples)?), ("sbom.cdx.json", bill::bill(triples)?)] {
        let path = folder.join(name);
        fs::write(&path, text).with_context(|| format!("writing {}", path.display()))?;
    }
    Ok(())
}

/// Lays out both bundles in a folder.
pub fn bundles(system: System, built: &Built, folder: &Path) -> Result<()> {
    let vst3 = folder.join("Pyrophone.vst3");
    let inner = vst3.join("Contents").join(system.vst3_folder()).join(system.vst3_library());
    for to in [folder.join("Pyrophone.clap"), inner] {
        install::copy(&built.library, &to)
            .with_context(|| format!("copying {} to {}", built.library.display(), to.display()))?;
    }
    bundle::describe(&vst3)
}

/// Scripts that install and remove a package: folder and name.
fn scripts(system: System) -> &'static [(&'static str, &'static str)] {
    match system {
        System::Linux => &[("linux", "install.sh"), ("linux", "uninstall.sh")],
        System::Windows => &[
            ("windows", "install.cmd"),
            ("windows", "uninstall.cmd"),
            ("windows", "install.ps1"),
            ("windows", "uninstall.ps1"),
        ],
    }
}

/// Writes the factory presets in VST3's form.
fn write_presets(folder: &Path) -> Result<()> {
    let mut writing = cargo::command();
    writing.args(["run", "--quiet", "--release", "--package", "pyrophone-settings", "--example", "vst3_presets", "--"]);
    ensure!(writing.arg(folder).status()?.success(), "the presets cannot be written to {}", folder.display());
    Ok(())
}

/// Manual pages and completions of the command line, which it writes itself.
fn write_manual(program: &Path, stage: &Path) -> Result<()> {
    let status = Command::new(program).args(["--quiet", "man", "--output"]).arg(stage.join("man")).status()?;
    ensure!(status.success(), "the manual pages cannot be written");
    let folder = stage.join("completions");
    fs::create_dir_all(&folder)?;
    for (shell, name) in [("bash", "pyrophone"), ("zsh", "_pyrophone"), ("fish", "pyrophone.fish")] {
        let output = Command::new(program).args(["completions", shell]).output()?;
        ensure!(output.status.success(), "completions for {shell} cannot be written");
        fs::write(folder.join(name), output.stdout)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_of_the_readme_lead_to_documents_in_the_package() {
        let readme = fs::read_to_string(project::root().join("README.md")).unwrap();
        let links = readme.split("](").skip(1).filter_map(|link| link.split([')', '#']).next());
        let files: Vec<&str> = links.filter(|link| !link.is_empty() && !link.contains("://")).collect();
        assert!(files.len() >= 20, "{files:?}");
        for file in files {
            let item = file.split('/').next().unwrap();
            assert!(DOCUMENTS.contains(&item) && project::root().join(file).exists(), "{file}");
        }
    }
}
