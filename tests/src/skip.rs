//! Tests that cannot run here: they say why, and `cargo xtask test` counts them as skipped, not as passed.
//!
//! Other crates' tests include this file by its path, so that there is one way of skipping a test.

use std::fs::File;
use std::io::Write;

/// Environment variable that names the list of skipped tests, which `cargo xtask test` reads.
const LIST: &str = "PYROPHONE_SKIPPED";

/// Says why the running test is skipped, and adds it to the list if there is one.
pub fn skip(why: &str) {
    eprintln!("skipped: {why}");
    let Some(list) = std::env::var_os(LIST) else { return };
    // Cargo names the package, and many programs of tests have one name.
    let program = std::env::var("CARGO_PKG_NAME").unwrap_or_default();
    let thread = std::thread::current();
    // One write per line: tests of several processes add to the list side by side.
    let line = format!("{program} {}: {why}\n", thread.name().unwrap_or("a test"));
    let added = File::options().create(true).append(true).open(list).and_then(|mut to| to.write_all(line.as_bytes()));
    added.expect("a list of skipped tests that can be written");
}
