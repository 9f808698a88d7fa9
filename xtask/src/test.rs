//! Everything that must pass, and the long tests.

use std::io::{BufRead, BufReader, Read, Write};
use std::process::{ExitCode, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::bundle::{self, Profile};
use crate::{cargo, instructions, project, setup, validators};

/// End-to-end tests: real bundles in real hosts.
const END_TO_END: &str = "pyrophone-tests";
/// The command line, which they compare the bundles with.
const COMMAND_LINE: &str = "pyrophone-cli";
/// What runs under which of Rust's sanitizers: its name and a test of the engines. The address sanitizer watches over the
/// search, which is where `unsafe` stands, the realtime sanitizer over `process`. Only the engines are built for them: the
/// plug-in's own part of the audio thread is counted for allocations in every run, and sanitized in the long tests.
const SANITIZED: [(&str, &str); 2] = [("address", "texture_search"), ("realtime", "realtime")];
/// The engines.
const ENGINES: &str = "pyrophone-synthesis";
/// The plug-in.
const PLUGIN: &str = "pyrophone-plugin";

/// Tells end-to-end tests which build to take.
const BUILD: &str = "PYROPHONE_BUILD";

/// What makes tests long.
const SOAK: (&str, &str) = ("PYROPHONE_SOAK", "1");

/// Results of tests so far.
#[derive(Debug, Default)]
pub struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
}

/// Runs everything that must pass.
pub fn run() -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    let mut tally = Tally::default();

    // All at once, and just as the runner wants it: other sets of packages would have their dependencies built again.
    if tally.step("building", build_tests) && tally.step("bundles", || bundle::wrap(Profile::Dev).map(drop)) {
        tally.all_tests(&[(BUILD, "debug")], &["--workspace"])?;
        validators::run(&mut tally)?;
    }
    for (sanitizer, test) in SANITIZED {
        tally.sanitized(sanitizer, ENGINES, test)?;
    }
    match instructions::obstacle() {
        None => {
            tally.step("instruction counts", instructions::compare);
        }
        Some(why) => tally.skip("instruction counts", why),
    }
    Ok(tally.conclude())
}

/// Runs the long tests.
pub fn soak() -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    let mut tally = Tally::default();
    if tally.step("bundles and command line", build_release) {
        tally.cargo_test("end to end, as it is used", &[SOAK, (BUILD, "release")], &["--package", END_TO_END])?;
    }
    let mut arguments = vec!["--release", "--package", "pyrophone-flame"];
    arguments.extend(["scenes", "import_hostile", "vortex_presets"].into_iter().flat_map(|test| ["--test", test]));
    tally.cargo_test("soak of flames", &[SOAK], &arguments)?;
    let arguments = ["--release", "--package", "xtask", "--bin", "xtask-sound", "scenes::"];
    tally.cargo_test("soak of scenes", &[SOAK], &arguments)?;
    let mut arguments = vec!["--release", "--package", ENGINES, "--package", PLUGIN];
    arguments.extend(["realtime", "chain", "extend_stream"].into_iter().flat_map(|test| ["--test", test]));
    tally.cargo_test("soak of the engines", &[SOAK], &arguments)?;
    tally.sanitized("realtime", PLUGIN, "realtime")?;
    Ok(tally.conclude())
}

/// Builds all tests, and the plugin and command line that the end-to-end ones load and call.
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

/// Whether `cargo nextest` is there. It runs tests of all programs side by side and each in a process of its own, which
/// takes half the time; without it `cargo test` runs the same tests.
fn has_nextest() -> bool {
    let version = cargo::command().args(["nextest", "--version"]).stdout(Stdio::null()).stderr(Stdio::null()).status();
    version.is_ok_and(|status| status.success())
}

impl Tally {
    /// Runs the tests that have been built, and those in the documentation.
    fn all_tests(&mut self, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
        if !has_nextest() {
            return self.cargo_test("tests, end to end", environment, arguments);
        }
        // Many tests wait for windows and threads: one more at a time than there are processors keeps those busy.
        let threads = std::thread::available_parallelism().map_or(2, usize::from) + 1;
        let threads = threads.to_string();
        let mut runner = vec!["nextest", "run", "--no-fail-fast", "--test-threads", &threads];
        runner.extend(["--status-level", "slow", "--final-status-level", "fail", "--color", "never"]);
        runner.extend(arguments);
        self.call("tests, end to end", environment, &runner)?;
        self.cargo_test("examples in the documentation", environment, &[&["--doc"], arguments].concat())
    }

    /// Runs a test of a package under one of Rust's sanitizers.
    fn sanitized(&mut self, sanitizer: &str, package: &str, test: &str) -> Result<()> {
        let name = format!("{sanitizer} sanitizer, {package}");
        let Some(target) = sanitizer_target() else {
            self.skip(&name, "Rust has it for Linux on x86-64 only");
            return Ok(());
        };
        let folder = project::target_dir().join(format!("{sanitizer}-sanitizer"));
        let folder = folder.to_string_lossy();
        let flags = format!("-Zsanitizer={sanitizer} --cfg sanitize_{sanitizer}");
        let environment = [("RUSTC_BOOTSTRAP", "1"), ("RUSTFLAGS", flags.as_str()), ("CARGO_TARGET_DIR", &*folder)];
        let arguments = ["--profile", "checked", "--target", &target, "--test", test, "--package", package];
        self.cargo_test(&name, &environment, &arguments)
    }

    /// Counts something that cannot be run here, and says why.
    pub fn skip(&mut self, name: &str, why: &str) {
        eprintln!("\nskipped: {name}: {why}");
        self.skipped += 1;
    }

    /// Counts something that is no test by itself, but must work.
    pub fn step(&mut self, name: &str, work: impl FnOnce() -> Result<()>) -> bool {
        let began = headline(name);
        let result = work();
        match &result {
            Ok(()) => self.passed += 1,
            Err(error) => {
                eprintln!("error: {error:#}");
                self.failed += 1;
            }
        }
        footline(began);
        result.is_ok()
    }

    /// Runs `cargo test`, shows what it says and counts its results. What does not even build counts as one failure.
    fn cargo_test(&mut self, name: &str, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
        self.call(name, environment, &[&["test", "--no-fail-fast"], arguments].concat())
    }

    /// Calls cargo, shows what it says and counts its results. The summaries stand in `cargo test`'s output and in what
    /// nextest says beside it.
    fn call(&mut self, name: &str, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
        let began = headline(name);
        let mut command = cargo::command();
        command.args(arguments).envs(environment.iter().copied());
        let failed_before = self.failed;
        let is_nextest = arguments.first() == Some(&"nextest");
        if is_nextest {
            command.stderr(Stdio::piped());
        } else {
            command.stdout(Stdio::piped());
        }
        let mut child = command.spawn().context("calling cargo")?;
        let output: Option<Box<dyn Read>> = if is_nextest {
            child.stderr.take().map(|stderr| Box::new(stderr) as Box<dyn Read>)
        } else {
            child.stdout.take().map(|stdout| Box::new(stdout) as Box<dyn Read>)
        };
        if let Some(output) = output {
            let mut shown = std::io::stdout().lock();
            for line in BufReader::new(output).split(b'\n') {
                let line = String::from_utf8_lossy(&line?).into_owned();
                writeln!(shown, "{line}")?;
                // Nextest shows what failed tests have printed, with summaries of their own.
                if !is_nextest || line.trim_start().starts_with("Summary [") {
                    self.count(&line);
                }
            }
        }
        if !child.wait()?.success() && self.failed == failed_before {
            self.failed += 1;
        }
        footline(began);
        Ok(())
    }

    /// Counts a line such as `test result: FAILED. 12 passed; 1 failed; 0 ignored; ...` of `cargo test`, or
    /// `Summary [ 12.3s] 13 tests run: 12 passed (1 slow), 1 failed, 2 skipped` of nextest.
    fn count(&mut self, line: &str) {
        let line = line.trim_start();
        let results = line.strip_prefix("test result: ").or_else(|| line.strip_prefix("Summary ["));
        let Some(results) = results else { return };
        let words: Vec<&str> = results.split([' ', ';', ',']).collect();
        let number_before = |word: &str| {
            let at = words.iter().position(|found| *found == word)?;
            words.get(at.checked_sub(1)?)?.parse::<usize>().ok()
        };
        self.passed += number_before("passed").unwrap_or(0);
        self.failed += ["failed", "timed"].iter().filter_map(|word| number_before(word)).sum::<usize>();
        self.skipped += ["ignored", "skipped"].iter().filter_map(|word| number_before(word)).sum::<usize>();
    }

    fn conclude(&self) -> ExitCode {
        println!("\n{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped);
        if self.failed == 0 && self.passed > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

fn headline(name: &str) -> Instant {
    eprintln!("\n=== {name}");
    Instant::now()
}

fn footline(began: Instant) {
    eprintln!("=== {:.0} s", began.elapsed().as_secs_f64());
}

#[cfg(test)]
mod tests {
    use super::Tally;

    #[test]
    fn results_are_counted() {
        let mut tally = Tally::default();
        tally.count("test result: ok. 12 passed; 0 failed; 0 ignored; 0 measured; 3 filtered out; finished in 0.01s");
        tally.count("test result: FAILED. 2 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out");
        tally.count("test the_result ... ok");
        assert_eq!((tally.passed, tally.failed), (14, 1));
        tally.count("     Summary [   2.501s] 9 tests run: 6 passed (1 slow), 2 failed, 1 timed out, 4 skipped");
        assert_eq!((tally.passed, tally.failed, tally.skipped), (20, 4, 4));
    }
}
