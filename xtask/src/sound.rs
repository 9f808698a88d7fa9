//! The program that `cargo xtask` calls to play through plug-ins and to draw pictures.

mod bounce;
mod caches;
mod demo;
mod drives;
mod listen;
mod peers;
mod project;
mod scenes;
mod score;
mod simulated;
mod spent;
mod upsampled;
mod vortex;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Play a file through the built plugin in a headless host
    Bounce(bounce::Args),
    /// Measure the cost of sparse caches of several sizes
    Caches(caches::Args),
    /// Make fire with every engine and write a page with players and pictures
    Demo(demo::Args),
    /// Simulate the plugin's built-in flames
    Drives(drives::Args),
    /// Write a blind listening test as one HTML file
    Listen(listen::Args),
    /// Compare the cost of texture synthesis with the authors' programs
    Peers(peers::Args),
    /// Print the sound of the scenes at several resolutions, in figures
    Scenes(scenes::Args),
    /// Score results against their recordings
    Score(score::Args),
    /// Compare the sound of few frames a second with that of all steps
    Upsampled(upsampled::Args),
    /// Record the vortex-sound textures that are shipped
    Vortex(vortex::Args),
}

fn main() -> ExitCode {
    let result = match Cli::parse().command {
        Command::Bounce(args) => bounce::run(&args),
        Command::Caches(args) => caches::run(&args),
        Command::Demo(args) => demo::run(&args),
        Command::Drives(args) => drives::run(&args),
        Command::Listen(args) => listen::run(&args),
        Command::Peers(args) => peers::run(&args),
        Command::Scenes(args) => scenes::run(&args),
        Command::Score(args) => score::run(&args),
        Command::Upsampled(args) => upsampled::run(&args),
        Command::Vortex(args) => vortex::run(&args),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}
