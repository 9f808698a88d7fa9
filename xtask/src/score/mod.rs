//! `cargo xtask score`: how near the results come to their recordings, in figures.
//!
//! Every flame signal of the reference folder is played with every recording there through the built CLAP
//! plugin, as a host does in real time, in both dynamics modes. The folder's own program scores the
//! results; the table goes into docs/sound.md, pictures into target/demo.

mod python;
mod table;

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, bail, ensure};
use pyrophone_host::Format;
use pyrophone_host::bounce::BlockSize;
use pyrophone_recording::write_wav_f32;
use pyrophone_settings::Automation;

use crate::bounce::{Request, load, play, preset, reference as reference_to};
use crate::demo::comparisons::reference_folder;
use crate::demo::plots::spectrogram;
use crate::project;
use table::Scored;

/// Options of `cargo xtask score`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scoring program [default: tools/score.py beside the reference folder]
    #[arg(long, value_name = "score.py")]
    program: Option<PathBuf>,
    /// Set a parameter in both modes; may be repeated. docs/sound.md is then left as it is
    #[arg(long = "set", value_name = "id=value")]
    settings: Vec<String>,
}

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
                let main = load(input_path, None)?;
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
                let output = folder.join(format!("{name}.wav"));
                write_wav_f32(&output, &played.channels, main.sample_rate_hz)?;
                spectrogram(&pictures.join(format!("{name}.png")), &played.channels, main.sample_rate_hz)?;
                eprintln!("  {input} on {training}, {mode}");
                let (input, training) = (input.clone(), training.clone());
                jobs.push(Job { input, training, mode, output, paths: [input_path.clone(), training_path.clone()] });
            }
        }
    }
    ensure!(!jobs.is_empty(), "{} holds no pairs", reference.display());
    eprintln!("scoring {} results", jobs.len());
    let scored = score(&jobs, &python, &program)?;
    let report = table::report(&scored);
    println!("{report}");
    if args.settings.is_empty() {
        let page = project::root().join("docs/sound.md");
        table::write_between_markers(&page, &report)?;
        println!("{}", page.display());
    }
    Ok(())
}

/// One result to be scored.
struct Job {
    input: String,
    training: String,
    mode: &'static str,
    output: PathBuf,
    /// Files of input and recording.
    paths: [PathBuf; 2],
}

/// The WAV files of a folder by name.
fn sounds(folder: &Path) -> Result<Vec<(String, PathBuf)>> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if let (true, Some(stem)) = (path.extension().is_some_and(|x| x == "wav"), path.file_stem()) {
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
                    let figures = python::score(python, program, &job.output, &job.paths);
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
            Ok(Scored { input, training, mode: job.mode, figures: figures? })
        })
        .collect()
}
