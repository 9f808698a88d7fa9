//! `cargo xtask`: the project's maintenance commands.
//!
//! This program is kept small, so that it builds quickly on a bare machine. Commands that play through plugins or draw
//! pictures are in the binary `xtask-sound`, which it builds and calls.

mod bench;
mod bundle;
mod cargo;
mod elsewhere;
mod install;
mod instructions;
mod openjd;
mod package;
mod project;
mod setup;
mod tally;
mod test;
mod uninstall;
mod validators;

use std::ffi::OsString;
use std::process::ExitCode;

use anyhow::Result;
use clap::{Parser, Subcommand};

/// Pyrophone's maintenance commands.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Build the plugin into CLAP and VST3 bundles in target/bundled
    Bundle {
        /// Build optimised, as for use in a host
        #[arg(long)]
        release: bool,
    },
    /// Build the release bundles and copy them to the folders where hosts look for plugins
    Install(install::Args),
    /// Remove everything that `install` has copied
    Uninstall(uninstall::Args),
    /// Make the packages that users download, in target/packages
    Package(package::Args),
    /// Play a file through the built plugin in a headless host; see `bounce --help`
    #[command(disable_help_flag = true)]
    Bounce(Forwarded),
    /// Build everything, make fire and write a page with players and pictures; see `demo --help`
    #[command(disable_help_flag = true)]
    Demo(Forwarded),
    /// Simulate the plugin's built-in flames again; see `drives --help`
    #[command(disable_help_flag = true)]
    Drives(Forwarded),
    /// Write a blind listening test as one HTML file; see `listen --help`
    #[command(disable_help_flag = true)]
    Listen(Forwarded),
    /// Score results against their recordings and write docs/sound.md; see `score --help`
    #[command(disable_help_flag = true)]
    Score(Forwarded),
    /// Record the built-in vortex-sound textures again; see `vortex --help`
    #[command(disable_help_flag = true)]
    Vortex(Forwarded),
    /// Run every test that must pass before a change is merged
    Test,
    /// Run the long tests, on other processors and systems too, as far as this machine can
    Soak {
        /// Only those of another system or processor; installs what they need
        #[arg(long, value_enum, value_name = "ELSEWHERE")]
        only: Option<elsewhere::Elsewhere>,
    },
    /// Run the third-party validators that are in PATH over the bundles, as `test` does
    Validate {
        /// Build optimised, as for use in a host
        #[arg(long)]
        release: bool,
    },
    /// Measure costs and print them as tables
    Bench(bench::Args),
}

/// Arguments that `xtask-sound` understands.
#[derive(Debug, clap::Args)]
struct Forwarded {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    arguments: Vec<OsString>,
}

impl Forwarded {
    fn asks_for_help(&self) -> bool {
        self.arguments.iter().any(|argument| argument == "--help" || argument == "-h")
    }
}

fn main() -> ExitCode {
    match run(Cli::parse().command) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

fn run(command: Command) -> Result<ExitCode> {
    std::env::set_current_dir(project::root())?;
    match command {
        Command::Bundle { release } => {
            for path in bundle::bundle(profile(release))? {
                println!("{}", path.display());
            }
            Ok(ExitCode::SUCCESS)
        }
        Command::Install(args) => install::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Uninstall(args) => uninstall::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Package(args) => package::run(&args).map(|()| ExitCode::SUCCESS),
        Command::Bounce(forwarded) => with_bundles("bounce", &forwarded),
        Command::Demo(forwarded) => {
            if !forwarded.asks_for_help() {
                setup::ensure(&setup::BUILD)?;
            }
            with_bundles("demo", &forwarded)
        }
        Command::Drives(forwarded) => cargo::sound("drives", &forwarded.arguments),
        Command::Listen(forwarded) => with_bundles("listen", &forwarded),
        Command::Score(forwarded) => with_bundles("score", &forwarded),
        Command::Vortex(forwarded) => cargo::sound("vortex", &forwarded.arguments),
        Command::Test => test::run(),
        Command::Soak { only } => test::soak(only),
        Command::Validate { release } => {
            bundle::bundle(profile(release))?;
            let mut tally = tally::Tally::default();
            validators::run(&mut tally)?;
            Ok(tally.conclude())
        }
        Command::Bench(args) => bench::run(&args),
    }
}

fn profile(is_release: bool) -> bundle::Profile {
    if is_release { bundle::Profile::Release } else { bundle::Profile::Dev }
}

/// Builds the release bundles, unless only help is wanted, for a command that plays through them.
fn with_bundles(command: &str, forwarded: &Forwarded) -> Result<ExitCode> {
    if !forwarded.asks_for_help() {
        bundle::bundle(bundle::Profile::Release)?;
    }
    cargo::sound(command, &forwarded.arguments)
}
