//! `cargo xtask demo`: fire from every engine, on a page with players and pictures.

pub mod comparisons;
mod fire;
mod flame;
mod loudness;
mod page;
pub mod plots;
mod signals;
mod studio;

use std::path::PathBuf;

use anyhow::{Context, Result};
use pyrophone_recording::Recording;
use pyrophone_synthesis::controls::DriveMode;

use crate::bounce::{load, preset};
use crate::project;
use page::{Pair, Section};
use studio::{Beside, Job, Sound, Studio};

/// Options of `cargo xtask demo`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Low-frequency flame signal, mono or stereo [default: a simulated one]
    #[arg(long, value_name = "IN.wav")]
    input: Option<PathBuf>,
    /// Fire recording for the texture engine [default: a real one if one is found, otherwise a generated one]
    #[arg(long, value_name = "T.wav")]
    training: Option<PathBuf>,
    /// Folder to write to [default: target/demo]
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Name, title and description of each factory preset.
const PRESETS: [(&str, &str, &str); 9] = [
    (
        "default",
        "Default",
        "The settings of a new instance: texture matched without slow loudness changes, then given the flame's loudness, over the flame's own low end.",
    ),
    (
        "extend",
        "Extension",
        "The flame's own low end and, above 180 Hz, noise that continues its level and slope. Needs no recording.",
    ),
    ("texture", "Texture", "Pieces of the recording, chosen to follow the flame's movement, with a gate for live use."),
    (
        "texture-paper",
        "Texture, as published",
        "Exact search, with the input's loudness learnt in a first pass, and no gate: during silence, the recording's quietest moment repeats.",
    ),
    (
        "flame",
        "Built-in flame",
        "From a silent input: the plug-in simulates its own flame, here a campfire. Scene, intensity and wind are parameters.",
    ),
    (
        "campfire",
        "Campfire",
        "From a silent input: the same campfire with vortex sound of the hot gas above it, which follows the simulated motion.",
    ),
    (
        "flamethrower",
        "Flamethrower",
        "From a silent input: a long jet; its roar is vortex sound that follows the simulated motion.",
    ),
    ("explosion", "Explosion", "From a silent input: bursts, then rising gas, limited as by a microphone."),
    (
        "swinging-torch",
        "Swinging torch",
        "From a silent input: a swung torch, whose whoosh is vortex sound that follows the motion.",
    ),
];

/// Writes the page and prints its path.
pub fn run(args: &Args) -> Result<()> {
    let folder = args.output.clone().unwrap_or_else(|| project::target_dir().join("demo"));
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let studio = Studio::new(folder);
    let (heard, training) = sources(&studio, args)?;
    let (engines, pair) = engines(&studio, args, &heard, &training)?;
    let mut sections = vec![engines, systems(&studio, &heard, &training)?];
    match comparisons::reference_folder() {
        Some(reference) => sections.extend(comparisons::sections(&studio, &reference)?),
        None => {
            eprintln!("there is no reference data (PYROPHONE_REFERENCE), so the page has no comparisons with the paper")
        }
    }
    let path = studio.folder().join("index.html");
    std::fs::write(&path, page::render(&pair, &sections)).with_context(|| path.display().to_string())?;
    println!("{}", path.canonicalize().unwrap_or(path).display());
    Ok(())
}

/// One input through every factory preset, and the pair of the input and the first preset's output.
fn engines(studio: &Studio, args: &Args, flame: &DemoSource, fire: &DemoSource) -> Result<(Section, Pair)> {
    let input = &flame.recording;
    let mut rows = vec![
        studio.row(
            "input",
            "Input",
            &format!("{} Most of it lies below 180 Hz, where small loudspeakers play nothing.", flame.note),
            &flame.sound,
            &Beside::Input,
        )?,
        studio.row("training", "Recording", &fire.note, &fire.sound, &Beside::Training)?,
    ];
    let silence = Recording { channels: vec![vec![0.0; input.len_samples()]; 2], ..input.clone() };
    let silence_sound = Sound::new(silence.channels.clone(), silence.sample_rate_hz, "");
    let mut pair = None;
    for (name, title, note) in PRESETS {
        let values = preset(name, [])?;
        let uses_recording = name != "extend";
        let burns = values.controls().drive.mode == DriveMode::Flame;
        let (played, heard) = if burns { (&silence, &silence_sound) } else { (input, &flame.sound) };
        let rendered = studio.render(&Job {
            input: played,
            training: uses_recording.then_some(fire.path.as_path()),
            values: &values,
            output_channels: 2,
        })?;
        let beside = Beside::Result {
            input: heard,
            training: uses_recording.then_some(&fire.sound),
            alpha: (name == "extend").then_some(2.5),
        };
        let mut row = studio.row(name, title, note, &rendered.sound, &beside)?;
        row.facts.push(rendered.speed());
        row.facts.push(format!("preset {name}"));
        rows.push(row);
        if pair.is_none() {
            pair = Some(studio.pair([&flame.sound, &rendered.sound], ["input", name])?);
        }
    }
    let intro = if args.input.is_none() || args.training.is_none() {
        "Sounds marked <b class=generated>Simulated</b> or <b class=generated>Generated</b> are not recordings. The demo makes them, so \
         that it works on any machine. To use your own sounds, run \
         <code>cargo xtask demo --input flame.wav --training fire.wav</code>."
    } else {
        "Your sounds, bounced through the CLAP plugin with each factory preset."
    };
    let section = Section { title: "One flame, every engine".into(), intro: intro.into(), rows, ..Section::default() };
    Ok((section, pair.context("there are no presets")?))
}

/// A sound and its description on the page.
struct DemoSource {
    path: PathBuf,
    note: String,
    recording: Recording,
    sound: Sound,
}

impl DemoSource {
    fn new(found: fire::Found) -> Result<Self> {
        let recording = load(&found.path, None)?;
        let sound = Sound::new(recording.channels.clone(), recording.sample_rate_hz, &found.rights);
        Ok(Self { path: found.path, note: found.note, recording, sound })
    }
}

/// Input and recording.
fn sources(studio: &Studio, args: &Args) -> Result<(DemoSource, DemoSource)> {
    let flame = match &args.input {
        Some(path) => fire::own(path),
        None => fire::simulated(studio.folder())?,
    };
    let fire = match &args.training {
        Some(path) => fire::own(path),
        None => match fire::recorded(studio.folder()) {
            Some(found) => found,
            None => fire::generated(studio.folder())?,
        },
    };
    Ok((DemoSource::new(flame)?, DemoSource::new(fire)?))
}

/// The systems of the papers, each alone and all together: name, title, description, and the levels of the layers.
const SYSTEMS: [(&str, &str, &str, [&str; 4]); 4] = [
    (
        "system-extension",
        "Spectral bandwidth extension",
        "Chadwick & James 2011, §4: the flame's low end, and noise that continues its spectrum.",
        ["0", "0", "off", "off"],
    ),
    (
        "system-texture",
        "Synchronised texture",
        "Chadwick & James 2011, §5, matched without slow loudness changes: a recording that moves with the flame.",
        ["off", "off", "0", "off"],
    ),
    (
        "system-vortex",
        "Vortex sound",
        "Dobashi, Yamamoto & Nishita 2004: the sound that turbulent hot gas radiates; the flame's loudness sets the gas's speed.",
        ["off", "off", "off", "0"],
    ),
    (
        "system-together",
        "All together",
        "Texture over the flame's low end, extension for air, vortex sound for the whoosh in between.",
        ["off", "-9", "0", "0"],
    ),
];

/// One input through the three papers' systems.
fn systems(studio: &Studio, flame: &DemoSource, fire: &DemoSource) -> Result<Section> {
    let mut rows = vec![];
    for (name, title, note, [low, extension, texture, vortex]) in SYSTEMS {
        let levels = [("low", low), ("extension", extension), ("texture", texture), ("vortex", vortex)];
        let levels = levels.map(|(layer, level)| format!("{layer}_level={level}"));
        let values = preset("default", levels.iter().map(String::as_str))?;
        let uses_recording = texture != "off";
        let rendered = studio.render(&Job {
            input: &flame.recording,
            training: uses_recording.then_some(fire.path.as_path()),
            values: &values,
            output_channels: 2,
        })?;
        let beside =
            Beside::Result { input: &flame.sound, training: uses_recording.then_some(&fire.sound), alpha: None };
        let mut row = studio.row(name, title, note, &rendered.sound, &beside)?;
        row.facts.push(rendered.speed());
        rows.push(row);
    }
    let intro = "Each system alone, with the input above, and all of them as layers of one instance.";
    Ok(Section { title: "Three systems, side by side".into(), intro: intro.into(), rows, ..Section::default() })
}
