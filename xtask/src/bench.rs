//! Real-time factors and worst blocks.

use std::process::ExitCode;

use anyhow::Result;

use crate::{cargo, setup};

/// Packages with benches; each is a program that prints a table.
const PACKAGES: [&str; 1] = ["pyrophone-synthesis"];

/// Runs the benches.
pub fn run() -> Result<ExitCode> {
    setup::ensure(&setup::BUILD)?;
    let mut code = ExitCode::SUCCESS;
    for package in PACKAGES {
        let status = cargo::command().args(["bench", "--quiet", "--package", package, "--benches"]).status()?;
        if !status.success() {
            code = cargo::exit_code(status);
        }
    }
    Ok(code)
}
