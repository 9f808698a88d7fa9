//! Real-time factors and worst blocks.

use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;

use crate::{cargo, project, setup};

/// The package with the benches; each is a program that prints tables.
const PACKAGE: &str = "pyrophone-synthesis";
/// Where the search's figures are kept, between these lines.
const PERFORMANCE: &str = "docs/performance.md";
const BEGIN: &str = "<!-- figures: cargo xtask bench search -->\n";
const END: &str = "<!-- end of figures -->\n";

/// Which benches to run.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Only this one; `search` also writes its tables into docs/performance.md
    bench: Option<Bench>,
}

#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
enum Bench {
    /// Spectral bandwidth extension
    Extend,
    /// The texture engine, its search, its dictionary, and the whole effect block by block
    Search,
    /// The solver and the flame front
    Flame,
    /// How true the steps between a simulation's frames are (PYROPHONE_REFERENCE names the folder of the reference cache)
    Upsample,
    /// The editor's window, frame by frame
    Window,
}

/// Runs the benches.
pub fn run(args: &Args) -> Result<ExitCode> {
    setup::ensure(&setup::BUILD)?;
    let is_wanted = |bench: Bench| args.bench.is_none_or(|only| only == bench);
    for (bench, package, name) in [
        (Bench::Extend, PACKAGE, "extend"),
        (Bench::Flame, "pyrophone-flame", "flame"),
        (Bench::Upsample, "pyrophone-flame", "upsample"),
        (Bench::Window, "pyrophone-plugin", "window"),
    ] {
        if is_wanted(bench) {
            let status = cargo::command().args(["bench", "--quiet", "--package", package, "--bench", name]).status()?;
            ensure!(status.success(), "the bench `{name}` failed; see above");
        }
    }
    if is_wanted(Bench::Search) {
        let mut figures =
            printed(cargo::command().args(["bench", "--quiet", "--package", PACKAGE, "--bench", "search"]))?;
        let instructions = instructions()?;
        print!("{instructions}");
        figures.push_str(&instructions);
        if args.bench == Some(Bench::Search) {
            keep(&figures)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs a program and shows what it prints, which is also the answer.
fn printed(command: &mut Command) -> Result<String> {
    let mut child = command.stdout(Stdio::piped()).spawn().context("calling the bench")?;
    let mut text = String::new();
    if let Some(output) = child.stdout.take() {
        for line in BufReader::new(output).lines() {
            let line = line?;
            println!("{line}");
            writeln!(text, "{line}")?;
        }
    }
    ensure!(child.wait()?.success(), "the bench failed; see above");
    Ok(text)
}

/// Instructions for one second of sound, which do not depend on what else the machine does.
fn instructions() -> Result<String> {
    let mut table =
        "### Instructions\n\nCounted by callgrind (which offers programs AVX2, not AVX-512) over one fixed second \
                     of sound: the searches alone.\n\n"
            .to_owned();
    if Command::new("valgrind").arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_err() {
        table.push_str("Not counted: valgrind is not installed (`apt-get install valgrind`).\n\n");
        return Ok(table);
    }
    table.push_str("| search | pair | million instructions |\n|---|---|---|\n");
    let program = bench_program()?;
    for search in ["exact", "bounded"] {
        let counts = project::target_dir().join("callgrind.out");
        let mut valgrind = Command::new("valgrind");
        valgrind.arg("--tool=callgrind").arg(format!("--callgrind-out-file={}", counts.display()));
        valgrind.args(["--collect-atstart=no", "--toggle-collect=*counted_second*"]);
        valgrind.arg(&program).args(["instructions", search]).stderr(Stdio::null());
        let output = valgrind.output().context("calling valgrind")?;
        ensure!(output.status.success(), "valgrind failed on {}", program.display());
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        let pair = printed.split_whitespace().next().context("the bench named no pair")?;
        let text = std::fs::read_to_string(&counts).with_context(|| counts.display().to_string())?;
        let Some(total) = text.lines().find_map(|line| line.strip_prefix("totals: ")) else {
            bail!("{} holds no total", counts.display());
        };
        let total: f64 = total.trim().parse().context("callgrind's total")?;
        writeln!(table, "| {search} | {pair} | {:.1} |", total / 1e6)?;
    }
    table.push('\n');
    Ok(table)
}

/// The bench as a program with its functions' names.
fn bench_program() -> Result<PathBuf> {
    let mut build = cargo::command();
    build.args(["bench", "--quiet", "--package", PACKAGE, "--bench", "search", "--no-run", "--message-format=json"]);
    let output = build.env("CARGO_PROFILE_BENCH_STRIP", "none").stderr(Stdio::inherit()).output()?;
    ensure!(output.status.success(), "the bench does not build; see above");
    let messages = String::from_utf8_lossy(&output.stdout).into_owned();
    let executable = messages.lines().rev().find_map(|line| {
        let (_, rest) = line.split_once("\"executable\":\"")?;
        Some(PathBuf::from(rest.split_once('"')?.0))
    });
    executable.context("cargo named no program")
}

/// Puts the figures where the page keeps them.
fn keep(figures: &str) -> Result<()> {
    let page = std::fs::read_to_string(PERFORMANCE).context(PERFORMANCE)?;
    let (Some(begin), Some(end)) = (page.find(BEGIN), page.find(END)) else {
        bail!("{PERFORMANCE} has no place for figures");
    };
    let page = format!("{}{BEGIN}\n{figures}{}", &page[..begin], &page[end..]);
    std::fs::write(PERFORMANCE, page).context(PERFORMANCE)?;
    println!("written to {PERFORMANCE}");
    Ok(())
}
