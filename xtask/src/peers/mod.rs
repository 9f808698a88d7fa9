//! `cargo xtask bench peers`: the authors' texture synthesis, in C++ and in the browser, beside ours.
//!
//! Their source and their recordings are not part of this project: the command is given the folder
//! `fire-texture-synthesis` of their repository. It compiles the C++ and runs the page's script in Node.

mod authors;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, Result, ensure};
use pyrophone_recording::write_wav_f32;

use crate::project;
use crate::spent::spent;
use authors::{Pair, Program, RATE_HZ};

/// Options of `cargo xtask bench peers`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Folder `fire-texture-synthesis` of the authors' repository
    authors: PathBuf,
}

/// Runs every program on every pair, one after the other, and prints the table.
pub fn run(args: &Args) -> Result<()> {
    let folder = project::target_dir().join("peers");
    let program = Program::build(&args.authors, &folder)?;
    let pairs = authors::pairs(&args.authors)?;
    println!(
        "| pair | C++, eps 1 | page, eps 5 | ours, exact | ours, eps 1 | C++ / ours, exact | page / ours, exact |"
    );
    println!("|---|---|---|---|---|---|---|");
    for pair in &pairs {
        let place = folder.join(&pair.name);
        fs::create_dir_all(&place).with_context(|| format!("making {}", place.display()))?;
        let theirs = [program.cpp_s(pair, &place)?, program.page_s(pair, &place)?];
        let own = ["0", "1"].map(|eps| own_s(pair, &place, eps));
        let [exact, near] = own;
        let costs = [theirs[0], theirs[1], exact?, near?].map(|s| s / pair.padded_s());
        println!(
            "| {} | {:.2} | {:.2} | {:.3} | {:.3} | {:.0} | {:.0} |",
            pair.name,
            costs[0],
            costs[1],
            costs[2],
            costs[3],
            costs[0] / costs[2],
            costs[1] / costs[2],
        );
    }
    Ok(())
}

/// CPU seconds of our command line.
fn own_s(pair: &Pair, place: &Path, eps: &str) -> Result<f64> {
    let program = project::target_dir().join("release/pyrophone");
    ensure!(program.exists(), "{} is missing: cargo build --release --package pyrophone-cli", program.display());
    for (name, signal) in [("input.wav", &pair.input), ("training.wav", &pair.training)] {
        write_wav_f32(&place.join(name), std::slice::from_ref(signal), RATE_HZ)?;
    }
    let mut texture = Command::new(program);
    texture.args(["texture", "--quiet", "--input", "input.wav", "--training", "training.wav", "--eps", eps]);
    Ok(spent(texture.args(["--output", "ours.wav"]).current_dir(place))?.cpu_s)
}
