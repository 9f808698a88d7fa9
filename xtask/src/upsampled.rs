//! The second half of `cargo xtask bench upsample`: the sound that a cache of a few frames a second gives, beside that
//! of all its steps.
//!
//! Every scene is simulated at 360 steps a second, thinned out, and made whole again, as `pyrophone flux` does. Both
//! pressures, and the envelope of the few frames, are played through the built plugin; the scoring program compares the
//! envelopes of the results with the true pressure's.

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use pyrophone_flame::Front;
use pyrophone_flame::flux::Changes;
use pyrophone_flame::pressure::{Options as PressureOptions, PressureKind, render};
use pyrophone_flame::scenes::{Options, STEP_RATE_HZ, Scene, Simulation};
use pyrophone_flame::upsample::{Method, Upsampler, VoxelSources};
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::write_wav_f32;
use pyrophone_settings::Automation;

use crate::bounce::{Request, load, play, preset, reference as reference_to};
use crate::demo::comparisons::reference_folder;
use crate::project;
use crate::score::python;
use crate::simulated;

/// Value at the front.
const ISO: f64 = 0.5;
/// Recording that texture draws from, in the reference folder.
const RECORDING: &str = "training/dragon.wav";
/// Setting with which a file that is an envelope drives the effect.
const ENVELOPE: &str = "drive_mode=input envelope";
/// Samples in a block.
const BLOCK: usize = 512;

/// Options of the comparison.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scenes to simulate, by name [default: all]
    scenes: Vec<String>,
    /// Cells along the longest side
    #[arg(long, default_value_t = 24)]
    cells: usize,
    /// Length in seconds
    #[arg(long, default_value_t = 6.0)]
    seconds: f64,
    /// Frames per second of the thinned-out cache: a divisor of 360
    #[arg(long, default_value_t = 24)]
    rate: usize,
}

/// A simulated flame at every step.
struct Truth {
    flux: Vec<f64>,
    sources: Vec<VoxelSources>,
}

/// What a comparison needs: a recording, a folder for sounds, and the scoring program.
struct Scoring {
    recording: PathBuf,
    folder: PathBuf,
    python: PathBuf,
    program: PathBuf,
}

/// Simulates, plays, and prints the table.
pub fn run(args: &Args) -> Result<()> {
    let steps = STEP_RATE_HZ as usize;
    ensure!(args.rate > 0 && steps.is_multiple_of(args.rate), "--rate {} does not divide {steps}", args.rate);
    let Some(reference) = reference_folder() else {
        println!("The final sound is not compared: that needs the reference data (PYROPHONE_REFERENCE).");
        return Ok(());
    };
    let scoring = Scoring {
        recording: reference.join(RECORDING),
        folder: project::target_dir().join("score"),
        python: python::with_scipy(&project::target_dir())?,
        program: reference.join("../tools/score.py"),
    };
    ensure!(scoring.program.is_file(), "{} is missing", scoring.program.display());
    std::fs::create_dir_all(&scoring.folder).with_context(|| scoring.folder.display().to_string())?;
    let scenes = simulated::scenes(&args.scenes)?;
    println!(
        "### The final sound\n\nIts dB sync with the true pressure, from all steps and from {} frames a second.\n",
        args.rate
    );
    println!("| flame | all steps | flips | envelope |\n|---|---|---|---|");
    let mut sums = [0.0; 3];
    for scene in &scenes {
        let found = compare(&scoring, *scene, args)?;
        println!("| {} | {:.2} | {:.2} | {:.2} |", scene.name(), found[0], found[1], found[2]);
        sums = std::array::from_fn(|index| sums[index] + found[index]);
    }
    let mean = sums.map(|sum| sum / scenes.len() as f64);
    println!("| mean | {:.2} | {:.2} | {:.2} |", mean[0], mean[1], mean[2]);
    Ok(())
}

/// The dB sync of a scene's sound with its true pressure: made of all steps, of frames and flips, of frames' envelope.
fn compare(scoring: &Scoring, scene: Scene, args: &Args) -> Result<[f64; 3]> {
    let truth = simulated(scene, args)?;
    let every = STEP_RATE_HZ as usize / args.rate;
    let frames: Vec<f64> = truth.flux.iter().copied().step_by(every).collect();
    let length = (frames.len() - 1) * every + 1;
    let flips = flipped(&truth, &frames, every)?;
    let at = |rate_hz: f64, kind| PressureOptions { rate_hz, kind, ..PressureOptions::default() };
    let drive = |name: &str, values: &[f64], options: PressureOptions| -> Result<PathBuf> {
        let path = scoring.folder.join(format!("frames-{}-{name}.wav", scene.name()));
        write_wav_f32(&path, &[render(values, &options)?.samples], options.sample_rate_hz)?;
        Ok(path)
    };
    let all = drive("all", &truth.flux[..length], at(STEP_RATE_HZ, PressureKind::Pressure))?;
    let few = drive("flips", &flips[..length], at(STEP_RATE_HZ, PressureKind::Pressure))?;
    let envelope = drive("envelope", &frames, at(args.rate as f64, PressureKind::Envelope))?;
    Ok([
        synchrony(scoring, &all, &all, &[])?,
        synchrony(scoring, &few, &all, &[])?,
        synchrony(scoring, &envelope, &all, &[ENVELOPE])?,
    ])
}

fn simulated(scene: Scene, args: &Args) -> Result<Truth> {
    let options = Options { resolution: args.cells, ..Options::default() };
    let mut simulation = Simulation::new(scene, options)?;
    let steps = |seconds: f64| (seconds * STEP_RATE_HZ).round() as u64;
    let pre_roll = steps(scene.default_pre_roll_s());
    let front = Front::new(ISO, 2)?;
    let every = STEP_RATE_HZ as u64 / args.rate as u64;
    let mut truth = Truth { flux: vec![], sources: vec![] };
    while simulation.steps() < pre_roll + steps(args.seconds) {
        simulation.step();
        if simulation.steps() <= pre_roll {
            continue;
        }
        let frame = simulation.frame()?;
        if (truth.flux.len() as u64).is_multiple_of(every) {
            truth.sources.push(VoxelSources::of_front(&frame, ISO)?);
        }
        truth.flux.push(front.measure(&frame)?.flux);
    }
    Ok(truth)
}

/// The steps that are made of frames.
fn flipped(truth: &Truth, frames: &[f64], every: usize) -> Result<Vec<f64>> {
    let upsampler = Upsampler::new(Method::Flips, every, 1)?;
    let sources = &truth.sources;
    let changes: Changes = (1..sources.len())
        .map(|after| {
            let number = after as i64 - 1;
            (number, upsampler.change(number, &sources[after - 1], &sources[after]))
        })
        .collect();
    Ok(upsampler.series(frames, 0, &changes))
}

/// Plays a drive through the default preset, and scores the envelope of the sound against the true pressure's.
fn synchrony(scoring: &Scoring, drive: &Path, truth: &Path, settings: &[&str]) -> Result<f64> {
    let main = load(drive, None)?;
    let played = play(&Request {
        format: Format::Clap,
        values: &preset("default", settings.iter().copied())?,
        automation: &Automation::default(),
        main: &main,
        sidechain: &[],
        training: Some(reference_to(&scoring.recording)?),
        learned: None,
        block: BlockSize::Fixed(BLOCK),
        offline: false,
        reference_padding: false,
        output_channels: 1,
    })?;
    let output = drive.with_extension("output.wav");
    write_wav_f32(&output, &played.channels, main.sample_rate_hz)?;
    let paths = [truth.to_owned(), scoring.recording.clone()];
    let scores = python::score(&scoring.python, &scoring.program, &output, &paths)?;
    match scores["follow"]["envelope_sync_log"].as_f64() {
        Some(found) => Ok(found),
        None => bail!("{} gives no dB sync for {}", scoring.program.display(), output.display()),
    }
}
