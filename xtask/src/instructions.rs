//! Instruction counts of one fixed second of each engine, which do not depend on the machine's other load: so no
//! slow-down goes unnoticed.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

use crate::{cargo, project};

/// File of the counts that new ones are compared with.
const KEPT: &str = "xtask/instructions.txt";
/// Relative tolerance of a count.
const TOLERANCE: f64 = 0.1;
/// Cases that are counted, as `bench instructions` of the package's bench names them.
const PACKAGE: &str = "pyrophone-synthesis";
const ENGINES: [&str; 6] = ["exact", "bounded", "quiet", "extension", "default", "activation"];

/// Reason why a comparison is impossible, if any.
pub fn obstacle() -> Option<&'static str> {
    if !can_count() {
        Some("valgrind is not installed (`apt-get install valgrind`)")
    } else if !Path::new(KEPT).exists() {
        Some("no counts are kept yet (`cargo xtask bench instructions`)")
    } else {
        None
    }
}

/// True if this machine can count instructions.
fn can_count() -> bool {
    Command::new("valgrind").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// The counts in millions, as a Markdown table.
pub fn table() -> Result<String> {
    let mut table =
        "### Instructions\n\nCounted by callgrind (which offers programs AVX2, not AVX-512) over one fixed second \
                     of sound.\n\n"
            .to_owned();
    if !can_count() {
        table.push_str("Not counted: valgrind is not installed (`apt-get install valgrind`).\n\n");
        return Ok(table);
    }
    table.push_str("| engine | million instructions |\n|---|---|\n");
    for (engine, millions) in counts()? {
        writeln!(table, "| {engine} | {millions:.1} |")?;
    }
    table.push('\n');
    print!("{table}");
    Ok(table)
}

/// Counts, and saves the counts for comparison.
pub fn keep() -> Result<()> {
    ensure!(can_count(), "valgrind is not installed (`apt-get install valgrind`)");
    let mut text = String::new();
    for (engine, millions) in counts()? {
        writeln!(text, "{engine} {millions:.1}")?;
    }
    print!("{text}");
    std::fs::write(KEPT, text).context(KEPT)
}

/// Fails where an engine's instruction count differs too much from the saved one.
pub fn compare() -> Result<()> {
    let kept = std::fs::read_to_string(KEPT).context(KEPT)?;
    differences(&kept, &counts()?)
}

fn differences(kept: &str, found: &[(String, f64)]) -> Result<()> {
    let mut wrong = String::new();
    for (engine, millions) in found {
        let line = kept.lines().find_map(|line| line.strip_prefix(engine.as_str())?.strip_prefix(' '));
        let Some(expected) = line.and_then(|line| line.trim().parse::<f64>().ok()) else {
            bail!("{KEPT} has no count of {engine}: `cargo xtask bench instructions` counts again");
        };
        if (millions / expected - 1.0).abs() > TOLERANCE {
            writeln!(wrong, "{engine}: {millions:.1} million instructions instead of {expected:.1}")?;
        }
    }
    ensure!(
        wrong.is_empty(),
        "{wrong}if the change is intended, store the new counts with `cargo xtask bench instructions`"
    );
    Ok(())
}

fn counts() -> Result<Vec<(String, f64)>> {
    let program = bench_program()?;
    ENGINES.iter().map(|engine| Ok(((*engine).to_owned(), count(&program, engine)?))).collect()
}

fn count(program: &Path, engine: &str) -> Result<f64> {
    let counts = project::target_dir().join("callgrind.out");
    let mut valgrind = Command::new("valgrind");
    valgrind.arg("--tool=callgrind").arg(format!("--callgrind-out-file={}", counts.display()));
    valgrind.args(["--collect-atstart=no", "--toggle-collect=*counted_second*"]);
    valgrind.arg(program).args(["instructions", engine]).stderr(Stdio::null());
    let output = valgrind.output().context("calling valgrind")?;
    ensure!(output.status.success(), "valgrind failed on {}", program.display());
    let text = std::fs::read_to_string(&counts).with_context(|| counts.display().to_string())?;
    let Some(total) = text.lines().find_map(|line| line.strip_prefix("totals: ")) else {
        bail!("{} holds no total", counts.display());
    };
    Ok(total.trim().parse::<f64>().context("callgrind's total")? / 1e6)
}

/// The bench as a program with its functions' names.
fn bench_program() -> Result<PathBuf> {
    let mut build = cargo::command();
    build.args(["bench", "--quiet", "--package", PACKAGE, "--bench", "cost", "--no-run", "--message-format=json"]);
    let output = build.env("CARGO_PROFILE_BENCH_STRIP", "none").stderr(Stdio::inherit()).output()?;
    ensure!(output.status.success(), "the bench does not build; see above");
    let messages = String::from_utf8_lossy(&output.stdout).into_owned();
    let executable = messages.lines().rev().find_map(|line| {
        let (_, rest) = line.split_once("\"executable\":\"")?;
        Some(PathBuf::from(rest.split_once('"')?.0))
    });
    executable.context("cargo named no program")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_off_by_more_than_a_tenth_are_refused() {
        let found = |millions: f64| [("exact".to_owned(), millions)];
        assert!(differences("exact 100.0\n", &found(109.0)).is_ok());
        assert!(differences("exact 100.0\n", &found(91.0)).is_ok());
        let error = differences("exact 100.0\n", &found(112.0)).unwrap_err().to_string();
        assert!(error.contains("exact: 112.0 million instructions instead of 100.0"), "{error}");
        assert!(differences("exact 100.0\n", &found(88.0)).is_err(), "what became quicker must be kept too");
        assert!(differences("exactly 100.0\n", &found(100.0)).is_err());
    }
}
