//! `cargo xtask score`: likeness of the results to their recordings, in figures.
//!
//! Every flame signal of the reference folder is played with every recording there through the built CLAP plugin, as a
//! host does in real time, in both dynamics modes; and a rumble, the flames, speech and drums with every real
//! recording. Each starts at three positions, since a single draw is not conclusive. The folder's own programs score
//! the results; the tables go into docs/sound.md, pictures into target/demo.
//!
//! | module | content |
//! |---|---|
//! | `drives` | drives for the real recordings |
//! | `real` | the real recordings |
//! | `python` | the scoring programs |
//! | `table` | the table of the pairs |

mod drives;
pub mod python;
mod real;
mod table;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, bail, ensure};
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::{Recording, write_wav_f32};
use pyrophone_settings::Automation;
use serde_json::Value;

use crate::bounce::{Request, load, play, preset, reference as reference_to};
use crate::demo::comparisons::reference_folder;
use crate::demo::plots::spectrogram;
use crate::project;
use table::Scored;

/// Options of `cargo xtask score`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scoring program [default: tools/score.py beside the reference folder]; crackle.py is expected beside it
    #[arg(long, value_name = "score.py")]
    program: Option<PathBuf>,
    /// Score only one of the two tables, without changing docs/sound.md
    #[arg(long, value_enum)]
    only: Option<Table>,
    /// Set a parameter in both modes, without changing docs/sound.md; may be repeated
    #[arg(long = "set", value_name = "id=value")]
    settings: Vec<String>,
}

/// Tables of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Table {
    /// The flames and recordings of the paper
    Pairs,
    /// Real recordings
    Real,
}

/// Samples of the input that are left out at its start, draw by draw.
const OFFSETS: [usize; 3] = [0, 1237, 2941];

/// The presets compared: the name in the table, the preset.
const MODES: [(&str, &str); 2] = [("companded", "default"), ("paper", "texture")];
/// Samples in a block.
const BLOCK: usize = 512;

/// Bounces, scores, and writes the page.
pub fn run(args: &Args) -> Result<()> {
    let Some(reference) = reference_folder() else {
        bail!("there is no reference data; set PYROPHONE_REFERENCE to its folder");
    };
    let program = match &args.program {
        Some(program) => program.clone(),
        None => reference.join("../tools/score.py"),
    };
    ensure!(program.is_file(), "{} is missing; name the scoring program with --program", program.display());
    let python = python::with_scipy(&project::target_dir())?;
    let folder = project::target_dir().join("score");
    let pictures = project::target_dir().join("demo");
    for folder in [&folder, &pictures] {
        std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    }

    let mut report = String::new();
    if args.only != Some(Table::Real) {
        report += &table::report(&pairs(args, &reference, &folder, &pictures, [&python, &program])?);
    }
    if args.only != Some(Table::Pairs) {
        let crackle = program.with_file_name("crackle.py");
        ensure!(crackle.is_file(), "{} is missing; it belongs beside the scoring program", crackle.display());
        report += &real::report(&real::ScorePlace {
            reference: &reference,
            folder: &folder,
            python: &python,
            programs: [&program, &crackle],
            settings: &args.settings,
        })?;
    }
    println!("{report}");
    if args.settings.is_empty() && args.only.is_none() {
        let page = project::root().join("docs/sound.md");
        table::write_between_markers(&page, &report)?;
        println!("{}", page.display());
    }
    Ok(())
}

/// Plays and scores the paper's pairs.
fn pairs(
    args: &Args,
    reference: &Path,
    folder: &Path,
    pictures: &Path,
    [python, program]: [&Path; 2],
) -> Result<Vec<Scored>> {
    let (inputs, trainings) = (sounds(&reference.join("signals"))?, sounds(&reference.join("training"))?);
    for (kind, paths) in [("input", &inputs), ("recording", &trainings)] {
        for (name, path) in paths {
            let sound = load(path, None)?;
            spectrogram(&pictures.join(format!("{kind}-{name}.png")), &sound.channels, sound.sample_rate_hz)?;
        }
    }
    let mut jobs = Vec::new();
    for (input, input_path) in &inputs {
        for (training, training_path) in &trainings {
            for (mode, preset_name) in MODES {
                let values = preset(preset_name, args.settings.iter().map(String::as_str))?;
                let mut draws = Vec::new();
                for offset in OFFSETS {
                    let main = later(&load(input_path, None)?, offset);
                    let played = play(&Request {
                        format: Format::Clap,
                        values: &values,
                        automation: &Automation::default(),
                        main: &main,
                        sidechain: &[],
                        training: Some(reference_to(training_path)?),
                        learned: None,
                        block: BlockSize::Fixed(BLOCK),
                        offline: false,
                        reference_padding: false,
                        output_channels: 1,
                    })?;
                    let name = format!("{input}-on-{training}-{mode}");
                    let output = folder.join(format!("{name}-{offset}.wav"));
                    write_wav_f32(&output, &played.channels, main.sample_rate_hz)?;
                    let driven = folder.join(format!("{input}-{offset}.wav"));
                    write_wav_f32(&driven, &main.channels, main.sample_rate_hz)?;
                    if offset == OFFSETS[0] {
                        let picture = pictures.join(format!("{name}.png"));
                        spectrogram(&picture, &played.channels, main.sample_rate_hz)?;
                    }
                    draws.push([output, driven]);
                }
                eprintln!("  {input} on {training}, {mode}");
                let (input, training) = (input.clone(), training.clone());
                jobs.push(Job { input, training, mode, draws, recording: training_path.clone() });
            }
        }
    }
    ensure!(!jobs.is_empty(), "{} holds no pairs", reference.display());
    eprintln!("scoring {} results", jobs.len() * OFFSETS.len());
    score(&jobs, python, program)
}

/// A sound without its first samples.
fn later(sound: &Recording, offset: usize) -> Recording {
    let mut later = sound.clone();
    later.channels.iter_mut().for_each(|channel| drop(channel.drain(..offset.min(channel.len()))));
    later
}

/// One result to be scored.
struct Job {
    input: String,
    training: String,
    mode: &'static str,
    /// Files of output and input, draw by draw.
    draws: Vec<[PathBuf; 2]>,
    /// File of the recording.
    recording: PathBuf,
}

/// The WAV and FLAC files of a folder by name.
pub fn sounds(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry?.path();
        let is_sound = path.extension().is_some_and(|extension| extension == "wav" || extension == "flac");
        if let (true, Some(stem)) = (is_sound, path.file_stem()) {
            found.push((stem.to_string_lossy().into_owned(), path));
        }
    }
    found.sort();
    Ok(found)
}

/// Scores all jobs, as many at once as there are processors.
fn score(jobs: &[Job], python: &Path, program: &Path) -> Result<Vec<Scored>> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new(Vec::new());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                while let Some((number, job)) = {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    jobs.get(number).map(|job| (number, job))
                } {
                    let figures = job.draws.iter().map(|[output, input]| {
                        python::score(python, program, output, &[input.clone(), job.recording.clone()])
                    });
                    let figures: Result<Vec<Value>> = figures.collect();
                    results.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((number, figures));
                }
            });
        }
    });
    let mut results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.sort_by_key(|(number, _)| *number);
    results
        .into_iter()
        .zip(jobs)
        .map(|((_, figures), job)| {
            let (input, training) = (job.input.clone(), job.training.clone());
            Ok(Scored { input, training, mode: job.mode, draws: figures? })
        })
        .collect()
}
