//! `pyrophone`: the sound of fire from a low-frequency flame signal, file in, file out.
//!
//! Exit code 0: the output was written. 1: the command failed; one line on standard error says why and what to do, and
//! no output is left behind. 2: the command line was invalid. A signal stops the work; after cleaning up, the process
//! ends by that signal: 128 + its number, as shells report it.

mod args;
mod error;
mod extend;
mod film_time;
mod flux;
mod flux_merge;
mod flux_plan;
mod frame_list;
mod input;
#[cfg(any(windows, test))]
mod install;
mod level;
mod notes;
mod output;
mod parameters;
mod presets;
mod progress;
mod render;
mod report;
mod shell;
mod simulate;
mod stop;
mod summary;
mod texture;
mod vortex_texture;

use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches};

use crate::args::{Cli, Command};
use crate::error::Error;
use crate::progress::Work;
use crate::stop::Stop;
use crate::summary::Outcome;

fn main() -> ExitCode {
    let (cli, name) = match parse() {
        Ok(parsed) => parsed,
        Err(error) => return usage(&error),
    };
    if cli.quiet {
        notes::set_quiet();
    }
    let stop = match Stop::listen() {
        Ok(stop) => stop,
        Err(error) => return fail(&error),
    };
    let code = match run(&cli, &Work::new(stop.clone(), cli.progress)) {
        Ok(done) => {
            if let Some(done) = done.filter(|_| cli.json) {
                print_summary(&done, &name);
            }
            ExitCode::SUCCESS
        }
        Err(error) => fail(&error),
    };
    stop.end_by_signal().unwrap_or(code)
}

/// The arguments, and the command's name as typed.
fn parse() -> Result<(Cli, String), clap::Error> {
    let matches = Cli::command().try_get_matches()?;
    let name = matches.subcommand_name().unwrap_or_default().to_owned();
    Ok((Cli::from_arg_matches(&matches)?, name))
}

/// Runs the command; returns its results if it writes files.
fn run(cli: &Cli, work: &Work) -> Result<Option<Outcome>, Error> {
    match &cli.command {
        Command::Texture(args) => texture::run(args, work).map(Some),
        Command::Extend(args) => extend::run(args, work).map(Some),
        Command::Render(args) => render::run(args, work).map(Some),
        Command::Flux(args) => flux::run(args, work).map(Some),
        Command::Simulate(args) => simulate::run(args, work).map(Some),
        Command::FluxMerge(args) => flux_merge::run(args, work).map(Some),
        Command::FluxPlan(args) => flux_plan::run(args).map(Some),
        Command::VortexTexture(args) => vortex_texture::run(args, work).map(Some),
        Command::Presets => presets::run(cli.json).map(|()| None),
        Command::Parameters => {
            parameters::run(cli.json);
            Ok(None)
        }
        Command::Completions(args) => {
            shell::completions(args);
            Ok(None)
        }
        Command::Man(args) => shell::man(args).map(Some),
        #[cfg(windows)]
        Command::Install(args) => install::install(args).map(|()| None),
        #[cfg(windows)]
        Command::Uninstall(args) => install::uninstall(args).map(|()| None),
    }
}

/// Prints the summary to whichever stream the sound does not use.
fn print_summary(done: &Outcome, command: &str) {
    let summary = done.to_json(command, &notes::take_notes());
    if done.output.as_deref().is_some_and(output::is_standard) {
        eprint!("{summary}");
    } else {
        summary::print(&summary);
    }
}

fn fail(error: &Error) -> ExitCode {
    eprintln!("error: {error}");
    ExitCode::FAILURE
}

/// The help command for the command that was typed.
fn help() -> String {
    let commands = Cli::command();
    let typed = std::env::args().skip(1).find(|word| commands.find_subcommand(word).is_some());
    typed.map_or_else(|| "pyrophone --help".to_owned(), |command| format!("pyrophone {command} --help"))
}

/// Prints help and version unchanged, and an error in one line.
fn usage(error: &clap::Error) -> ExitCode {
    if !error.use_stderr() {
        // Nobody reads a pipe that was closed: not worth an error.
        let _ = error.print();
        return ExitCode::SUCCESS;
    }
    let text = error.to_string();
    let is_hint = |line: &str| line.starts_with("Usage:") || line.starts_with("For more information");
    let message: Vec<&str> = text.lines().take_while(|line| !is_hint(line)).flat_map(str::split_whitespace).collect();
    eprintln!("{}; see `{}`", message.join(" "), help());
    ExitCode::from(2)
}
