//! All tests that must pass, and the long tests.

use std::process::{ExitCode, Stdio};

use anyhow::{Result, ensure};
use clap::ValueEnum as _;

use crate::bundle::{self, Profile};
use crate::elsewhere::{self, Elsewhere};
use crate::tally::Tally;
use crate::{cargo, instructions, openjd, project, setup, validators};

/// Package of end-to-end tests: real bundles in real hosts.
const END_TO_END: &str = "pyrophone-tests";
/// Package of the command line, against which they compare the bundles.
const COMMAND_LINE: &str = "pyrophone-cli";
/// Sanitizers, each with a test of the engines. The address sanitizer checks the search, which contains the `unsafe`
/// code, the realtime sanitizer checks `process`. Only the engines are built for them: the plug-in's own part of the
/// audio thread is counted for allocations in every run, and sanitized in the long tests.
const SANITIZED: [(&str, &str); 2] = [("address", "texture_search"), ("realtime", "realtime")];
/// The engines.
const ENGINES: &str = "pyrophone-synthesis";
/// The plug-in.
const PLUGIN: &str = "pyrophone-plugin";

/// Environment variable with the build for end-to-end tests.
const BUILD: &str = "PYROPHONE_BUILD";
/// Environment variable with the folder of dictionaries.
const CACHE: &str = "PYROPHONE_CACHE";

/// Environment variable that enables the long tests.
const SOAK: (&str, &str) = ("PYROPHONE_SOAK", "1");

/// Runs everything that must pass.
pub fn run() -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    let mut tally = Tally::default();

    // All at once, with the runner's own arguments: other sets of packages would rebuild their dependencies.
    if tally.step("building", build_tests) && tally.step("bundles", || bundle::wrap(Profile::Dev).map(drop)) {
        // Dictionaries used by many tests are learnt once for all, and again whenever the source they depend on has
        // changed.
        let learnt = project::target_dir().join("tmp/learnt");
        let learnt = learnt.to_string_lossy();
        let openjd = openjd::program().map(|program| program.to_string_lossy().into_owned());
        let mut environment = vec![(BUILD, "debug"), (CACHE, &*learnt)];
        environment.extend(openjd.as_deref().map(|program| (openjd::PROGRAM, program)));
        all_tests(&mut tally, &environment, &["--workspace"])?;
        validators::run(&mut tally)?;
        elsewhere::test(&mut tally)?;
    }
    for (sanitizer, test) in SANITIZED {
        sanitized(&mut tally, sanitizer, ENGINES, test)?;
    }
    Ok(tally.conclude())
}

/// Runs the long tests as far as this machine can, or those of another system or processor, for which what is missing is installed.
pub fn soak(only: Option<Elsewhere>) -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    if let Some(place) = only {
        place.prepare()?;
    }
    let mut tally = Tally::default();
    let places = only.as_ref().map_or(Elsewhere::value_variants(), std::slice::from_ref);
    if only.is_none() {
        soak_here(&mut tally)?;
    }
    for place in places {
        elsewhere::soak(&mut tally, *place)?;
    }
    Ok(tally.conclude())
}

/// Runs the long tests of this system and processor.
fn soak_here(tally: &mut Tally) -> Result<()> {
    if tally.step("bundles and command line", build_release) {
        tally.cargo_test("end to end, as it is used", &[SOAK, (BUILD, "release")], &["--package", END_TO_END])?;
    }
    let arguments = ["--release", "--package", "pyrophone-flame", "--test", "it", "--"];
    let arguments = [&arguments[..], &["scenes::", "import_hostile::", "vortex_presets::"]].concat();
    tally.cargo_test("soak of flames", &[SOAK], &arguments)?;
    tally.cargo_test("a farm", &[SOAK], &["--release", "--package", COMMAND_LINE, "--test", "slurm"])?;
    let arguments = ["--release", "--package", "xtask", "--bin", "xtask-sound", "scenes::"];
    tally.cargo_test("soak of scenes", &[SOAK], &arguments)?;
    let arguments = ["--release", "--package", ENGINES, "--package", PLUGIN, "--test", "realtime"];
    tally.cargo_test("soak of the audio thread", &[SOAK], &arguments)?;
    let arguments = ["--release", "--package", ENGINES, "--test", "it", "--"];
    let arguments = [&arguments[..], &["chain::", "extend_stream::", "extend_golden::"]].concat();
    tally.cargo_test("soak of the engines", &[SOAK], &arguments)?;
    let arguments = ["--release", "--package", "pyrophone-settings", "--test", "it", "macros::"];
    tally.cargo_test("soak of macros", &[SOAK], &arguments)?;
    let arguments = ["--release", "--package", COMMAND_LINE, "--test", "it", "levels::"];
    tally.cargo_test("soak of levels", &[SOAK], &arguments)?;
    tally.cargo_test("soak of digests", &[SOAK], &["--release", "--package", COMMAND_LINE, "--test", "digests"])?;
    match instructions::obstacle() {
        None => {
            tally.step("instruction counts", instructions::compare);
        }
        Some(why) => tally.skip("instruction counts", why),
    }
    sanitized(tally, "realtime", PLUGIN, "realtime")
}

/// Builds all tests, and the plugin and command line used by the end-to-end ones.
fn build_tests() -> Result<()> {
    let status = cargo::command().args(["build", "--workspace", "--lib", "--bins", "--tests"]).status()?;
    ensure!(status.success(), "it does not build; see above");
    Ok(())
}

/// Builds plugin and command line as they are used.
fn build_release() -> Result<()> {
    bundle::bundle(Profile::Release)?;
    let status = cargo::command().args(["build", "--release", "--package", COMMAND_LINE]).status()?;
    ensure!(status.success(), "the command line does not build; see above");
    Ok(())
}

/// The target that the realtime sanitizer's runtime is there for, if this machine is one.
fn sanitizer_target() -> Option<String> {
    let here = cfg!(all(target_os = "linux", target_arch = "x86_64", target_env = "gnu"));
    here.then(|| "x86_64-unknown-linux-gnu".to_owned())
}

/// True if `cargo nextest` is installed. It runs the tests of all programs in parallel, each in a separate process, in
/// half the time; without it `cargo test` runs the same tests.
fn has_nextest() -> bool {
    let version = cargo::command().args(["nextest", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    version.is_ok_and(|status| status.success())
}

/// Runs the tests that have been built, and those in the documentation.
fn all_tests(tally: &mut Tally, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
    if !has_nextest() {
        return tally.cargo_test("tests, end to end", environment, arguments);
    }
    // Many tests wait for windows and threads: one more test than there are processors keeps those busy.
    let threads = std::thread::available_parallelism().map_or(2, usize::from) + 1;
    let threads = threads.to_string();
    let mut runner = vec!["nextest", "run", "--no-fail-fast", "--test-threads", &threads];
    runner.extend(["--status-level", "slow", "--final-status-level", "fail", "--color", "never"]);
    runner.extend(arguments);
    tally.call("tests, end to end", environment, &runner)?;
    tally.cargo_test("examples in the documentation", environment, &[&["--doc"], arguments].concat())
}

/// Runs a test of a package under one of Rust's sanitizers.
fn sanitized(tally: &mut Tally, sanitizer: &str, package: &str, test: &str) -> Result<()> {
    let name = format!("{sanitizer} sanitizer, {package}");
    let Some(target) = sanitizer_target() else {
        tally.skip(&name, "Rust has it for Linux on x86-64 only");
        return Ok(());
    };
    let folder = project::target_dir().join(format!("{sanitizer}-sanitizer"));
    let folder = folder.to_string_lossy();
    let flags = format!("-Zsanitizer={sanitizer} --cfg sanitize_{sanitizer}");
    let environment = [("RUSTC_BOOTSTRAP", "1"), ("RUSTFLAGS", flags.as_str()), ("CARGO_TARGET_DIR", &*folder)];
    let arguments = ["--profile", "checked", "--target", &target, "--test", test, "--package", package];
    tally.cargo_test(&name, &environment, &arguments)
}
