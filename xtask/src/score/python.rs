//! The scoring programs: a Python with their requirements, and one run.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, bail, ensure};
use serde_json::Value;

/// A Python with numpy, scipy and soundfile: the system's, otherwise one in a virtual environment in the target folder,
/// which is created where possible.
pub fn with_scipy(target_dir: &Path) -> Result<PathBuf> {
    let ready = |python: &Path| {
        let imported = Command::new(python).args(["-c", "import numpy, scipy, soundfile"]).output();
        imported.is_ok_and(|imported| imported.status.success())
    };
    let system = PathBuf::from("python3");
    let folder = target_dir.join("score-venv");
    let own = folder.join("bin/python");
    if let Some(python) = [&system, &own].into_iter().find(|python| ready(python)) {
        return Ok(python.clone());
    }
    eprintln!("making a Python environment with numpy, scipy and soundfile in {}", folder.display());
    let made = Command::new(&system).args(["-m", "venv"]).arg(&folder).status();
    if !made.is_ok_and(|status| status.success()) {
        bail!(
            "scoring needs Python 3 with numpy, scipy and soundfile: apt-get install python3-numpy python3-scipy python3-soundfile"
        );
    }
    let installed =
        Command::new(&own).args(["-m", "pip", "install", "--quiet", "numpy", "scipy", "soundfile"]).status()?;
    ensure!(installed.success() && ready(&own), "pip could not install numpy, scipy and soundfile; see above");
    Ok(own)
}

/// The figures of one result, as printed by the program.
pub fn score(python: &Path, program: &Path, output: &Path, [input, training]: &[PathBuf; 2]) -> Result<Value> {
    run(Command::new(python).arg(program).arg("--input").arg(input), program, output, training)
}

/// Crackle, level and stereo of one result beside its recording, as printed by their program.
pub fn crackle(python: &Path, program: &Path, output: &Path, training: &Path) -> Result<Value> {
    run(Command::new(python).arg(program), program, output, training)
}

fn run(command: &mut Command, program: &Path, output: &Path, training: &Path) -> Result<Value> {
    command.args(["--json", "--output"]).arg(output).arg("--training").arg(training).env("OMP_NUM_THREADS", "1");
    let output = command.output()?;
    ensure!(output.status.success(), "{}: {}", program.display(), String::from_utf8_lossy(&output.stderr));
    // Python writes invalid numbers in a form that JSON readers reject.
    let text = String::from_utf8_lossy(&output.stdout).replace("NaN", "null").replace("-Infinity", "null");
    serde_json::from_str(&text.replace("Infinity", "null"))
        .with_context(|| format!("{} printed no JSON", program.display()))
}
