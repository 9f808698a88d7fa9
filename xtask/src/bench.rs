//! Real-time factors and worst blocks.

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::process::{Command, ExitCode, Stdio};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;

use crate::{bundle, cargo, instructions, setup};

/// The package with the benches; each is a program that prints tables.
const PACKAGE: &str = "pyrophone-synthesis";
/// Page with the figures, and markers of the search's.
const PERFORMANCE: &str = "docs/performance.md";
const BEGIN: &str = "<!-- figures: cargo xtask bench search -->\n";
const END: &str = "<!-- end of figures -->\n";
/// Markers of the costs in the page.
const COST_BEGIN: &str = "<!-- costs: cargo xtask bench all -->\n";
const COST_END: &str = "<!-- end of costs -->\n";
/// Markers of the window's costs in the page.
const WINDOW_BEGIN: &str = "<!-- window: cargo xtask bench window -->\n";
const WINDOW_END: &str = "<!-- end of window -->\n";
/// Markers of the comparison with the authors' programs in the page.
const PEERS_BEGIN: &str = "<!-- peers: cargo xtask bench peers -->\n";
const PEERS_END: &str = "<!-- end of peers -->\n";
/// Markers of the costs of caches in the page.
const CACHES_BEGIN: &str = "<!-- caches: cargo xtask bench caches -->\n";
const CACHES_END: &str = "<!-- end of caches -->\n";

/// Options of `cargo xtask bench`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Benchmark to run [default: each except all, caches, instructions, peers and scenes]; `all`, `caches`, `peers`, `search` and `window` also write their tables into docs/performance.md
    bench: Option<Bench>,
    /// Options of `scenes`, of `peers`, of `caches`, and of the final sound of `upsample`; see `bench scenes --help` and so on
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    arguments: Vec<OsString>,
}

#[derive(Debug, Clone, Copy, ValueEnum, PartialEq, Eq)]
enum Bench {
    /// Every row of the table of costs: engines, blocks, starts, memory, flames, instructions
    All,
    /// Spectral bandwidth extension
    Extend,
    /// The texture engine, its search, its dictionary, and the whole effect block by block
    Search,
    /// The solver and the flame front
    Flame,
    /// Accuracy of the steps between a simulation's frames, and of the final sound (PYROPHONE_REFERENCE names the folder of the reference data)
    Upsample,
    /// The editor's window: time per frame, and processor time of the whole process on a screen (Xvfb)
    Window,
    /// Loading a recording, for the first time and in a session that is opened again
    Reload,
    /// Instructions of one second of each engine, saved for comparison by `cargo xtask soak`
    Instructions,
    /// Sparse caches of several sizes through the command line, written to docs/performance.md; takes minutes, so it runs only when named; see `bench caches --help`
    Caches,
    /// Texture synthesis beside the authors' programs, whose folder is named after it; see `bench peers --help`
    Peers,
    /// Sound of the scenes at several resolutions; takes minutes, so it runs only when named
    Scenes,
}

/// Runs the benches.
pub fn run(args: &Args) -> Result<ExitCode> {
    if args.bench == Some(Bench::Scenes) {
        return cargo::sound("scenes", &args.arguments);
    }
    if args.bench == Some(Bench::Peers) {
        return peers(&args.arguments);
    }
    if args.bench == Some(Bench::Caches) {
        return caches(&args.arguments);
    }
    ensure!(
        args.arguments.is_empty() || args.bench == Some(Bench::Upsample),
        "only the benches `scenes`, `peers`, `caches` and `upsample` take options"
    );
    setup::ensure(&setup::BUILD)?;
    if args.bench == Some(Bench::All) {
        return costs();
    }
    if args.bench == Some(Bench::Instructions) {
        instructions::keep()?;
        return Ok(ExitCode::SUCCESS);
    }
    if args.bench == Some(Bench::Window) {
        return window();
    }
    let is_wanted = |bench: Bench| args.bench.is_none_or(|only| only == bench);
    for (bench, package, name) in [
        (Bench::Extend, PACKAGE, "extend"),
        (Bench::Flame, "pyrophone-flame", "flame"),
        (Bench::Upsample, "pyrophone-flame", "upsample"),
        (Bench::Window, "pyrophone-plugin", "window"),
        (Bench::Reload, "pyrophone-plugin", "reload"),
    ] {
        if is_wanted(bench) {
            let status = cargo::command().args(["bench", "--quiet", "--package", package, "--bench", name]).status()?;
            ensure!(status.success(), "the bench `{name}` failed; see above");
        }
    }
    if args.bench == Some(Bench::Upsample) {
        bundle::bundle(bundle::Profile::Release)?;
        return cargo::sound("upsampled", &args.arguments);
    }
    if is_wanted(Bench::Search) {
        let mut figures =
            printed(cargo::command().args(["bench", "--quiet", "--package", PACKAGE, "--bench", "search"]))?;
        figures.push_str(&instructions::table()?);
        if args.bench == Some(Bench::Search) {
            keep(&figures, BEGIN, END)?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The table of costs.
fn costs() -> Result<ExitCode> {
    let bench =
        |package: &str| printed(cargo::command().args(["bench", "--quiet", "--package", package, "--bench", "cost"]));
    let mut table = bench(PACKAGE)?;
    // The remaining rows continue the same table.
    for package in ["pyrophone-plugin", "pyrophone-flame"] {
        let rows = bench(package)?;
        table.extend(rows.lines().skip(2).map(|line| format!("{line}\n")));
    }
    table.push('\n');
    table.push_str(&instructions::table()?);
    keep(&table, COST_BEGIN, COST_END)?;
    Ok(ExitCode::SUCCESS)
}

/// Texture synthesis beside the authors' programs.
fn peers(arguments: &[OsString]) -> Result<ExitCode> {
    of_command_line("peers", arguments, PEERS_BEGIN, PEERS_END)
}

/// Cost of sparse caches.
fn caches(arguments: &[OsString]) -> Result<ExitCode> {
    setup::ensure(&setup::CACHES)?;
    of_command_line("caches", arguments, CACHES_BEGIN, CACHES_END)
}

/// A table that is measured by calling the command line; help is not kept.
fn of_command_line(name: &str, arguments: &[OsString], begin_mark: &str, end_mark: &str) -> Result<ExitCode> {
    let built = cargo::command().args(["build", "--release", "--quiet", "--package", "pyrophone-cli"]).status()?;
    ensure!(built.success(), "the command line does not build; see above");
    let table = printed(&mut cargo::sound_command(name, arguments))?;
    if table.starts_with('|') {
        keep(&format!("{table}\n"), begin_mark, end_mark)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Cost of the window: frame by frame without a screen, then of a whole process on one, with and without rasterising.
fn window() -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    let mut figures =
        printed(cargo::command().args(["bench", "--quiet", "--package", "pyrophone-plugin", "--bench", "window"]))?;
    bundle::bundle(bundle::Profile::Release)?;
    figures.push_str("\n### On a screen\n\n");
    for is_rasterised in [true, false] {
        let mut test = cargo::command();
        test.args(["test", "--quiet", "--release", "--package", "pyrophone-tests", "--test", "editor_cost", "--"]);
        test.args(["--ignored", "--nocapture"]);
        if !is_rasterised {
            // Mesa draws nothing then: the remaining cost is the editor's own and the driver's.
            test.env("GALLIUM_NOOP", "1");
        }
        let rows = printed(&mut test)?;
        let head = if is_rasterised { 0 } else { 2 };
        let rows = rows.lines().filter(|line| line.starts_with('|')).skip(head);
        figures.extend(rows.map(|line| format!("{line}\n")));
    }
    keep(&figures, WINDOW_BEGIN, WINDOW_END)?;
    Ok(ExitCode::SUCCESS)
}

/// Runs a program, shows its output, and returns it.
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

/// Writes the figures between their markers in the page.
fn keep(figures: &str, begin_mark: &str, end_mark: &str) -> Result<()> {
    let page = std::fs::read_to_string(PERFORMANCE).context(PERFORMANCE)?;
    let (Some(begin), Some(end)) = (page.find(begin_mark), page.find(end_mark)) else {
        bail!("{PERFORMANCE} has no place for figures");
    };
    let page = format!("{}{begin_mark}\n{figures}{}", &page[..begin], &page[end..]);
    std::fs::write(PERFORMANCE, page).context(PERFORMANCE)?;
    println!("written to {PERFORMANCE}");
    Ok(())
}
