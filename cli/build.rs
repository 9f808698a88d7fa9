//! Tells the program its version, with the commit where it is built from a checkout.
//!
//! The same commit gives the same version, so builds stay reproducible; without git, or from an archive, there is the
//! version alone.

use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let version = env!("CARGO_PKG_VERSION");
    let version = match commit() {
        Some(commit) => format!("{version} ({commit})"),
        None => version.to_owned(),
    };
    println!("cargo:rustc-env=PYROPHONE_VERSION={version}");
}

/// The commit that is checked out. Only a checkout of this project counts, and not one that an archive of it was unpacked in.
fn commit() -> Option<String> {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?;
    let top = PathBuf::from(git(&["rev-parse", "--show-toplevel"])?);
    if top.canonicalize().ok()? != workspace.canonicalize().ok()? {
        return None;
    }
    // HEAD may name a branch, which moves without it; its log is written to whenever it leads elsewhere.
    for name in ["HEAD", "logs/HEAD"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(git(&["rev-parse", "--git-path", name])?);
        if path.is_file() {
            println!("cargo:rerun-if-changed={}", path.display());
        }
    }
    git(&["rev-parse", "--short=12", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").current_dir(env!("CARGO_MANIFEST_DIR")).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    (output.status.success() && !text.is_empty()).then_some(text)
}
