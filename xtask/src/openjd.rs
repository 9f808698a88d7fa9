//! The command line of Open Job Description, which runs a farm's job on this machine.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::project;
use crate::setup::is_program;

/// Environment variable that names the program to the test of `flux-plan`.
pub const PROGRAM: &str = "PYROPHONE_OPENJD";

/// The package on PyPI, at the version whose templates and messages were checked.
const PACKAGE: &str = "openjd-cli==0.8.0";

/// The program: the system's, otherwise one in a virtual environment in the target folder, which is created where
/// possible. None otherwise; the test then counts itself as skipped.
pub fn program() -> Option<PathBuf> {
    if is_program("openjd") {
        return Some("openjd".into());
    }
    let folder = project::target_dir().join("openjd-venv");
    let own = folder.join("bin/openjd");
    if own.is_file() {
        return Some(own);
    }
    eprintln!("making a Python environment with {PACKAGE} in {}", folder.display());
    let succeeds = |command: &mut Command| command.stdin(Stdio::null()).status().is_ok_and(|status| status.success());
    let pip = ["-m", "pip", "install", "--quiet", "--retries", "1", "--timeout", "15", PACKAGE];
    let is_made = succeeds(Command::new("python3").args(["-m", "venv"]).arg(&folder))
        && succeeds(Command::new(folder.join("bin/python")).args(pip));
    (is_made && own.is_file()).then_some(own)
}
