//! Counts of passed, failed and skipped tests, over everything called by a test run.

use std::collections::BTreeSet;
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::path::Path;
use std::process::{ExitCode, Stdio};
use std::time::Instant;

use anyhow::{Context, Result};

use crate::{cargo, project};

/// Environment variable with the list to which tests that cannot run here add themselves.
const SKIPPED: &str = "PYROPHONE_SKIPPED";

/// Results of tests so far.
#[derive(Debug, Default)]
pub struct Tally {
    passed: usize,
    failed: usize,
    skipped: usize,
}

impl Tally {
    /// Counts something that cannot run here, and prints the reason.
    pub fn skip(&mut self, name: &str, why: &str) {
        eprintln!("\nskipped: {name}: {why}");
        self.skipped += 1;
    }

    /// Counts a step that is not a test itself, but must succeed.
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

    /// Runs `cargo test`, shows its output and counts its results. A failed build counts as one failure.
    pub fn cargo_test(&mut self, name: &str, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
        self.call(name, environment, &[&["test", "--no-fail-fast"], arguments].concat())
    }

    /// Calls cargo, shows its output and counts its results, from the summaries in the output of `cargo test` or
    /// nextest.
    pub fn call(&mut self, name: &str, environment: &[(&str, &str)], arguments: &[&str]) -> Result<()> {
        let began = headline(name);
        let mut command = cargo::command();
        let list = project::target_dir().join("skipped-tests.txt");
        remove(&list)?;
        command.args(arguments).envs(environment.iter().copied()).env(SKIPPED, &list);
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
                // Nextest shows the output of failed tests, with summaries of their own.
                if !is_nextest || line.trim_start().starts_with("Summary [") {
                    self.count(&line);
                }
            }
        }
        if !child.wait()?.success() && self.failed == failed_before {
            self.failed += 1;
        }
        self.count_skipped(&std::fs::read_to_string(&list).unwrap_or_default());
        footline(began);
        Ok(())
    }

    /// Counts the tests on a list as skipped. Their programs have counted them as passed, since Rust's tests cannot
    /// report anything else at run time.
    fn count_skipped(&mut self, list: &str) {
        let tests: BTreeSet<&str> = list.lines().collect();
        for test in &tests {
            println!("skipped: {test}");
        }
        self.passed = self.passed.saturating_sub(tests.len());
        self.skipped += tests.len();
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

    /// Prints the counts; success if something has passed and nothing has failed.
    pub fn conclude(&self) -> ExitCode {
        println!("\n{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped);
        if self.failed == 0 && self.passed > 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
    }
}

/// Removes a file, if it is there.
fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error).with_context(|| path.display().to_string()),
        _ => Ok(()),
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

    #[test]
    fn tests_that_skip_themselves_are_not_passed() {
        let mut tally = Tally { passed: 5, ..Tally::default() };
        let list = "front a: no data\nfront a: no data\nfront b: no data\n";
        tally.count_skipped(list);
        assert_eq!((tally.passed, tally.failed, tally.skipped), (3, 0, 2));
    }
}
