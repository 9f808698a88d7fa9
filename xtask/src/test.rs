//! Everything that must pass, and the long tests.

use std::io::{BufRead, BufReader, Write};
use std::process::{ExitCode, Stdio};
use std::time::Instant;

use anyhow::{Context, Result, ensure};

use crate::bundle::{self, Profile};
use crate::{cargo, project, setup};

/// End-to-end tests: real bundles in real hosts.
const END_TO_END: &str = "pyrophone-tests";
/// The command line, which they compare the bundles with.
const COMMAND_LINE: &str = "pyrophone-cli";
/// What runs under which of Rust's sanitizers: its name, packages, and a test that each of them has. The realtime sanitizer
/// watches over `process`, the address sanitizer over the search, which is where `unsafe` stands.
const SANITIZED: [(&str, &[&str], &str); 2] = [
    ("address", &["pyrophone-synthesis"], "texture_search"),
    ("realtime", &["pyrophone-synthesis", "pyrophone-plugin"], "realtime"),
];

/// Tells end-to-end tests which build to take.
const BUILD: &str = "PYROPHONE_BUILD";

/// What makes tests long.
const SOAK: (&str, &str) = ("PYROPHONE_SOAK", "1");

/// Results of tests so far.
#[derive(Debug, Default)]
struct Tally {
    passed: usize,
    failed: usize,
}

/// Runs everything that must pass.
pub fn run() -> Result<ExitCode> {
    setup::ensure(&setup::TEST)?;
    let mut tally = Tally::default();

    // All at once, and just as `cargo test` wants it: other sets of packages would have their dependencies built again.
    if tally.step("building", build_tests) && tally.step("bundles", || bundle::wrap(Profile::Dev).map(drop)) {
        tally.cargo_test("tests, end to end", &[(BUILD, "debug")], &["--workspace"])?;
    }
    match sanitizer_target() {
        Some(target) => {
            for (sanitizer, packages, test) in SANITIZED {
                let folder = project::target_dir().join(format!("{sanitizer}-sanitizer"));
                let folder = folder.to_string_lossy();
                let flags = format!("-Zsanitizer={sanitizer} --cfg sanitize_{sanitizer}");
                let environment =
                    [("RUSTC_BOOTSTRAP", "1"), ("RUSTFLAGS", flags.as_str()), ("CARGO_TARGET_DIR", &*folder)];
                let mut arguments = vec!["--profile", "checked", "--target", &target, "--test", test];
                arguments.extend(packages.iter().flat_map(|package| ["--package", package]));
                tally.cargo_test(&format!("{sanitizer} sanitizer"), &environment, &arguments)?;
            }
        }
        None => eprintln!("\nnot run: the sanitizers, which Rust has for Linux on x86-64 only"),
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

impl Tally {
    /// Counts something that is no test by itself, but must work.
    fn step(&mut self, name: &str, work: impl FnOnce() -> Result<()>) -> bool {
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
        let began = headline(name);
        let mut command = cargo::command();
        command.args(["test", "--no-fail-fast"]).args(arguments).envs(environment.iter().copied());
        let mut child = command.stdout(Stdio::piped()).spawn().context("calling cargo")?;
        let failed_before = self.failed;
        if let Some(output) = child.stdout.take() {
            let mut shown = std::io::stdout().lock();
            for line in BufReader::new(output).split(b'\n') {
                let line = String::from_utf8_lossy(&line?).into_owned();
                writeln!(shown, "{line}")?;
                self.count(&line);
            }
        }
        if !child.wait()?.success() && self.failed == failed_before {
            self.failed += 1;
        }
        footline(began);
        Ok(())
    }

    /// Counts a line such as `test result: FAILED. 12 passed; 1 failed; 0 ignored; ...`.
    fn count(&mut self, line: &str) {
        let Some(results) = line.strip_prefix("test result: ") else { return };
        let number_before = |word: &str| {
            let words: Vec<&str> = results.split([' ', ';']).collect();
            let at = words.iter().position(|found| *found == word)?;
            words.get(at.checked_sub(1)?)?.parse::<usize>().ok()
        };
        self.passed += number_before("passed").unwrap_or(0);
        self.failed += number_before("failed").unwrap_or(0);
    }

    fn conclude(&self) -> ExitCode {
        println!("\n{} passed, {} failed", self.passed, self.failed);
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
    }
}
