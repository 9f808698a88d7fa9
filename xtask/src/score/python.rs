//! The scoring program: a Python that has what it needs, and one run.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

/// A Python with numpy and scipy: the system's, else one in a virtual environment in the target folder, which
/// is made where that is possible.
pub fn with_scipy(target_dir: &Path) -> Result<PathBuf> {
    let ready = |python: &Path| {
        let imported = Command::new(python).args(["-c", "import numpy, scipy"]).output();
        imported.is_ok_and(|imported| imported.status.success())
    };
    let system = PathBuf::from("python3");
    let folder = target_dir.join("score-venv");
    let own = folder.join("bin/python");
    if let Some(python) = [&system, &own].into_iter().find(|python| ready(python)) {
        return Ok(python.clone());
    }
    eprintln!("making a Python environment with numpy and scipy in {}", folder.display());
    let made = Command::new(&system).args(["-m", "venv"]).arg(&folder).status();
    if !made.is_ok_and(|status| status.success()) {
        bail!("scoring needs Python 3 with numpy and scipy: apt-get install python3-numpy python3-scipy");
    }
    let installed = Command::new(&own).args(["-m", "pip", "install", "--quiet", "numpy", "scipy"]).status()?;
    ensure!(installed.success() && ready(&own), "pip could not install numpy and scipy; see above");
    Ok(own)
}

/// The figures of one result, as the program tells them.
pub fn score(python: &Path, program: &Path, output: &Path, [input, training]: &[PathBuf; 2]) -> Result<Value> {
    let told = Command::new(python)
        .arg(program)
        .args(["--json", "--output"])
        .arg(output)
        .arg("--training")
        .arg(training)
        .arg("--input")
        .arg(input)
        .env("OMP_NUM_THREADS", "1")
        .output()?;
    ensure!(told.status.success(), "{}: {}", program.display(), String::from_utf8_lossy(&told.stderr));
    serde_json::from_slice(&told.stdout).with_context(|| format!("{} told no JSON", program.display()))
}
