//! Archives for download. The same folder gives the same bytes: entries are sorted and have one fixed time.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, ensure};

/// The time that all entries carry: the oldest that a zip knows.
const TIME: &str = "1980-01-01 00:00:00 UTC";

/// Debian's description of the package; `VERSION` and `SIZE` (in kB) are filled in.
const CONTROL: &str = include_str!("../../../packages/linux/control");

fn run(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("calling {:?}", command.get_program()))?;
    ensure!(status.success(), "{:?} failed; see above", command.get_program());
    Ok(())
}

/// Name and parent of a folder that is packed.
fn split(stage: &Path) -> Result<(&Path, String)> {
    let name = stage.file_name().context("a folder without a name")?.to_string_lossy().into_owned();
    Ok((stage.parent().context("a folder in none")?, name))
}

/// Packs a folder as `NAME.tar.gz` into another one.
pub fn tar_gz(stage: &Path, folder: &Path) -> Result<PathBuf> {
    let (parent, name) = split(stage)?;
    let package = folder.join(format!("{name}.tar.gz"));
    let mut tar = Command::new("tar");
    tar.args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=u=rwX,go=rX", "--format=ustar"]);
    // Gzip itself would write the present time.
    tar.args([&format!("--mtime={TIME}"), "--use-compress-program=gzip -9 --no-name", "--create", "--file"]);
    run(tar.arg(&package).arg("-C").arg(parent).arg(&name))?;
    Ok(package)
}

/// Packs a folder as `NAME.zip` into another one.
pub fn zip(stage: &Path, folder: &Path) -> Result<PathBuf> {
    let (parent, name) = split(stage)?;
    let package = folder.join(format!("{name}.zip"));
    if package.exists() {
        // zip would add to an existing file.
        fs::remove_file(&package)?;
    }
    let mut files = Vec::new();
    list(stage, Path::new(&name), &mut files)?;
    files.sort();
    for file in &files {
        run(Command::new("touch").args(["--date", TIME]).arg(parent.join(file)))?;
    }
    let mut zip = Command::new("zip");
    // Without users and finer times; local time would depend on the place of the build.
    zip.env("TZ", "UTC").current_dir(parent).args(["-9", "-X", "-q"]).arg(std::path::absolute(&package)?);
    run(zip.args(&files).stdout(Stdio::null()))?;
    Ok(package)
}

/// All files below a folder, by their paths from its parent.
fn list(folder: &Path, shown: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let shown = shown.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            list(&entry.path(), &shown, files)?;
        } else {
            files.push(shown);
        }
    }
    Ok(())
}

/// Paths of a package's files in Debian's layout: from, to.
const DEBIAN: [(&str, &str); 16] = [
    ("Pyrophone.clap", "usr/lib/clap/Pyrophone.clap"),
    ("Pyrophone.vst3", "usr/lib/vst3/Pyrophone.vst3"),
    ("pyrophone", "usr/bin/pyrophone"),
    ("presets/Pyrophone", "usr/share/vst3/presets/Pyrophone"),
    ("man", "usr/share/man/man1"),
    ("completions/pyrophone", "usr/share/bash-completion/completions/pyrophone"),
    ("completions/_pyrophone", "usr/share/zsh/vendor-completions/_pyrophone"),
    ("completions/pyrophone.fish", "usr/share/fish/vendor_completions.d/pyrophone.fish"),
    ("README.md", "usr/share/doc/pyrophone/README.md"),
    ("docs", "usr/share/doc/pyrophone/docs"),
    ("CHANGELOG.md", "usr/share/doc/pyrophone/CHANGELOG.md"),
    ("CONTRIBUTING.md", "usr/share/doc/pyrophone/CONTRIBUTING.md"),
    ("SECURITY.md", "usr/share/doc/pyrophone/SECURITY.md"),
    ("LICENSE-MIT", "usr/share/doc/pyrophone/copyright"),
    ("THIRD-PARTY.md", "usr/share/doc/pyrophone/THIRD-PARTY.md"),
    ("sbom.cdx.json", "usr/share/doc/pyrophone/sbom.cdx.json"),
];

/// Packs a Linux folder as a Debian package in another folder.
///
/// `dpkg-deb` is on every Debian system and needs only a file of eight lines; `cargo-deb` would have to be built first,
/// and reads its files from Cargo's target folder, whereas the build for an older C library is elsewhere.
pub fn deb(stage: &Path, folder: &Path) -> Result<PathBuf> {
    let version = env!("CARGO_PKG_VERSION");
    let root = stage.with_extension("debian");
    if root.exists() {
        fs::remove_dir_all(&root)?;
    }
    for (from, to) in DEBIAN {
        crate::install::copy(&stage.join(from), &root.join(to)).with_context(|| format!("copying {from}"))?;
    }
    let mut files = Vec::new();
    list(&root, Path::new(""), &mut files)?;
    let sizes = files.iter().map(|file| Ok(fs::metadata(root.join(file))?.len().div_ceil(1024)));
    let size = sizes.sum::<Result<u64>>()?;
    fs::create_dir(root.join("DEBIAN"))?;
    let control = CONTROL.replace("VERSION", version).replace("SIZE", &size.to_string());
    fs::write(root.join("DEBIAN/control"), control)?;
    let package = folder.join(format!("pyrophone_{version}_amd64.deb"));
    let mut building = Command::new("dpkg-deb");
    // 1980-01-01, in seconds.
    building.env("SOURCE_DATE_EPOCH", "315532800").args(["--root-owner-group", "-Zxz", "--build"]);
    run(building.arg(&root).arg(&package).stdout(Stdio::null()))?;
    Ok(package)
}

/// Writes the checksums of all packages in a folder, as `sha256sum --check` reads them.
pub fn write_checksums(folder: &Path) -> Result<PathBuf> {
    let mut files = Vec::new();
    list(folder, Path::new(""), &mut files)?;
    files.retain(|file| {
        file.extension().is_some_and(|extension| ["gz", "deb", "zip"].iter().any(|one| extension == *one))
    });
    files.sort();
    let output = Command::new("sha256sum").current_dir(folder).args(&files).output().context("calling sha256sum")?;
    ensure!(output.status.success(), "the packages' checksums cannot be computed");
    let path = folder.join("SHA256SUMS");
    fs::write(&path, output.stdout)?;
    Ok(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(at: &Path) -> PathBuf {
        let stage = at.join("pyrophone-1-linux");
        fs::create_dir_all(stage.join("b")).unwrap();
        fs::write(stage.join("b/two"), "2").unwrap();
        fs::write(stage.join("one"), "1").unwrap();
        stage
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_same_folder_gives_the_same_bytes_at_any_time() {
        let [first, second] = [1, 1_000_000].map(|age_s| {
            let place = tempfile::tempdir().unwrap();
            let stage = folder(place.path());
            let time = std::time::SystemTime::now() - std::time::Duration::from_secs(age_s);
            fs::File::options().append(true).open(stage.join("one")).unwrap().set_modified(time).unwrap();
            let package = tar_gz(&stage, place.path()).unwrap();
            assert_eq!(package.file_name().unwrap(), "pyrophone-1-linux.tar.gz");
            fs::read(package).unwrap()
        });
        assert!(first == second && !first.is_empty());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn checksums_are_those_of_packages_alone() {
        let place = tempfile::tempdir().unwrap();
        fs::write(place.path().join("a.zip"), "").unwrap();
        fs::write(place.path().join("notes.txt"), "").unwrap();
        let sums = fs::read_to_string(write_checksums(place.path()).unwrap()).unwrap();
        assert_eq!(sums, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  a.zip\n");
    }
}
