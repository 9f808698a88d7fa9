//! `pyrophone`: fire from a low-frequency flame signal, file in, file out.
//!
//! Exit code 0: the output was written. 1: refused or failed, with one line on standard error that
//! says why and what to do; no output was left behind. 2: the command line was not understood.

mod args;
mod error;
mod extend;
mod flux;
mod flux_merge;
mod input;
mod progress;
mod render;
mod report;
mod simulate;
mod texture;
mod vortex_texture;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Cli, Command};
use crate::error::Error;
use crate::progress::Work;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return usage(&error),
    };
    match run(&cli.command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: &Command) -> Result<(), Error> {
    let work = Work::start()?;
    match command {
        Command::Texture(args) => texture::run(args, &work),
        Command::Extend(args) => extend::run(args, &work),
        Command::Render(args) => render::run(args, &work),
        Command::Flux(args) => flux::run(args, &work),
        Command::Simulate(args) => simulate::run(args, &work),
        Command::FluxMerge(args) => flux_merge::run(args, &work),
        Command::VortexTexture(args) => vortex_texture::run(args, &work),
    }
}

/// Help and version as they are; an error in one line.
fn usage(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // Nobody reads a pipe that was closed: not worth an error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let is_hint = |line: &str| line.starts_with("Usage:") || line.starts_with("For more information");
    let message: Vec<&str> = text.lines().take_while(|line| !is_hint(line)).flat_map(str::split_whitespace).collect();
    eprintln!("{}; see `pyrophone --help`", message.join(" "));
    ExitCode::from(2)
}
