//! `cargo xtask bounce`: a file through the built plugin, in a headless host.
//!
//! For any preset the output equals that of `pyrophone render`, bit for bit. A recording that a preset names is not loaded:
//! give it by `--training`.

mod play;

use std::path::{Path, PathBuf};
use std::str::FromStr;

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use pyrophone_host::bounce::BlockSize;
use pyrophone_host::{BusLayout, Format};
use pyrophone_recording::{Recording, check_finite, check_not_among, decode, no_progress, resample, write_wav_f32};
use pyrophone_settings::session::{Learned, RecordingReference};
use pyrophone_settings::table::DYNAMIC_RANGES;
use pyrophone_settings::{Automation, Id, Preset, Values};
use pyrophone_synthesis::chain::learn;
use pyrophone_synthesis::structure::MatchingMode;

pub use play::{Request, play};

/// Options of `cargo xtask bounce`.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The bundle to load: clap or vst3
    #[arg(long)]
    format: Format,
    /// Main input: mono, stereo, 5.0 or 5.1
    #[arg(long, value_name = "IN.wav")]
    input: PathBuf,
    /// Sound for the sidechain, cut or padded with silence to the input's length
    #[arg(long, value_name = "S.wav")]
    sidechain: Option<PathBuf>,
    /// Fire recording that texture draws from
    #[arg(long, visible_alias = "recording", value_name = "T.wav")]
    training: Option<PathBuf>,
    /// Name of a factory preset or a preset's file
    #[arg(long, value_name = "NAME|FILE", default_value = "default")]
    preset: String,
    /// Source of the input's loudness distribution, instead of the preset's choice
    #[arg(long, value_enum)]
    dynamic_range: Option<DynamicRange>,
    /// File to learn that distribution from, instead of a first pass over the input
    #[arg(long, value_name = "FILE.wav")]
    learn: Option<PathBuf>,
    /// Parameter automation: rows of time_s,id,value or sample,id,value, optionally with ,curve (step or linear)
    #[arg(long, value_name = "FILE.csv")]
    automation: Option<PathBuf>,
    /// Parameter to set after loading the preset; may be repeated
    #[arg(long = "set", value_name = "id=value")]
    settings: Vec<String>,
    /// Frames per block, or `random` or `random:SEED` for blocks of 0 to 1024 frames
    #[arg(long, value_name = "N|random", default_value = "512")]
    block: Block,
    /// Tell the plugin that the host renders offline
    #[arg(long)]
    offline: bool,
    /// Add the zeros that the published program puts before and after the input, and trim them again
    #[arg(long)]
    reference_padding: bool,
    /// Resample the input to this rate first
    #[arg(long, value_name = "HZ")]
    sample_rate: Option<u32>,
    /// Channels of the output: 1, 2, 5 (5.0) or 6 (5.1) [default: as many as the input's]
    #[arg(long, value_name = "N")]
    channels: Option<usize>,
    /// File to write: 32-bit float, as long as the input
    #[arg(long, value_name = "OUT.wav")]
    output: PathBuf,
}

/// Values of `--dynamic-range`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum DynamicRange {
    /// No mapping
    Off,
    /// From --learn, or from a first pass over the input
    Learned,
    /// Estimated during playback
    Running,
}

/// Value of `--block`.
#[derive(Debug, Clone)]
struct Block(BlockSize);

impl FromStr for Block {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let random = |seed| BlockSize::Random { seed, max: 1024 };
        let not_understood = || format!("`{text}` is neither 1 to 65536 frames nor random nor random:SEED");
        let size = match text.split_once(':') {
            None if text == "random" => random(1),
            Some(("random", seed)) => random(seed.parse().map_err(|_| not_understood())?),
            _ => BlockSize::Fixed(
                text.parse().ok().filter(|frames| (1..=65_536).contains(frames)).ok_or_else(not_understood)?,
            ),
        };
        Ok(Self(size))
    }
}

/// Plays the file and writes the output.
pub fn run(args: &Args) -> Result<()> {
    let values = values(args)?;
    check_not_among(&args.output, &sources(args))?;
    let automation = args.automation.as_deref().map(Automation::load).transpose()?.unwrap_or_default();
    let main = load(&args.input, args.sample_rate)?;
    let rate_hz = main.sample_rate_hz;
    let sidechain = args.sidechain.as_deref().map(|path| load(path, Some(rate_hz))).transpose()?;
    let sidechain = sidechain.map_or_else(Vec::new, |sound| fitted(sound.channels, main.len_samples()));

    let learned = if needs_learning(&values, &automation, f64::from(rate_hz)) {
        Some(match &args.learn {
            Some(path) => learned(&values, &load(path, Some(rate_hz))?, &[])?,
            None => learned(&values, &main, &sidechain)?,
        })
    } else {
        None
    };
    let played = play(&Request {
        format: args.format,
        values: &values,
        automation: &automation,
        main: &main,
        sidechain: &sidechain,
        training: args.training.as_deref().map(reference).transpose()?,
        learned,
        block: args.block.0.clone(),
        offline: args.offline,
        reference_padding: args.reference_padding,
        output_channels: args.channels.unwrap_or(main.channels.len()),
    })?;
    check_finite(&args.output, &played.channels)?;
    write_wav_f32(&args.output, &played.channels, rate_hz)?;
    let ready = match &args.training {
        Some(_) => format!("recording ready in {:.2} s", played.loading.as_secs_f64()),
        None => "no recording".to_owned(),
    };
    eprintln!(
        "{}: latency {} samples, {ready}, {:.2} s of sound played in {:.2} s",
        args.output.display(),
        played.latency_samples,
        main.duration_s(),
        played.playing.as_secs_f64(),
    );
    Ok(())
}

/// Files from which the output is made.
fn sources(args: &Args) -> Vec<&Path> {
    let optional = [&args.sidechain, &args.training, &args.learn, &args.automation];
    let given = optional.into_iter().flatten().map(PathBuf::as_path);
    [args.input.as_path(), Path::new(&args.preset)].into_iter().chain(given).collect()
}

/// The preset, then `--dynamic-range` (or `--learn`, which implies the learned one), then `--set`.
fn values(args: &Args) -> Result<Values> {
    let choice = match (args.dynamic_range, &args.learn) {
        (Some(DynamicRange::Learned) | None, Some(_)) => Some(DynamicRange::Learned),
        (Some(_), Some(_)) => {
            bail!("--learn contradicts --dynamic-range off and --dynamic-range running; leave one of them out")
        }
        (choice, None) => choice,
    };
    let choice = choice.map(|choice| match choice {
        DynamicRange::Off => "dynamic_range=off",
        DynamicRange::Learned => "dynamic_range=learned",
        DynamicRange::Running => "dynamic_range=running",
    });
    preset(&args.preset, choice.into_iter().chain(args.settings.iter().map(String::as_str)))
}

/// A preset's values, changed by settings `id=value`.
pub fn preset<'a>(name: &str, settings: impl IntoIterator<Item = &'a str>) -> Result<Values> {
    let mut values = Preset::find(name)?.values;
    for setting in settings {
        let (id, text) = setting
            .split_once('=')
            .with_context(|| format!("--set {setting}: there is no '='; write it as in --set alpha=3.0"))?;
        values.set_text(id.trim(), text)?;
    }
    values.structure().validate()?;
    Ok(values)
}

/// Reads a sound and resamples it to a given rate.
pub fn load(path: &Path, rate_hz: Option<u32>) -> Result<Recording> {
    let sound = decode(path, &no_progress)?;
    match rate_hz {
        Some(rate_hz) => Ok(resample(&sound, rate_hz, &no_progress)?),
        None => Ok(sound),
    }
}

/// A recording as a session names it.
pub fn reference(path: &Path) -> Result<RecordingReference> {
    let content_hash = decode(path, &no_progress)?.content_hash;
    let path = path.canonicalize().with_context(|| path.display().to_string())?;
    let path = path.to_str().with_context(|| format!("{} is not UTF-8; rename it", path.display()))?.to_owned();
    Ok(RecordingReference { path, content_hash, embedded: None })
}

/// The distribution of the input's amplitudes, in the form stored in a session.
pub fn learned(values: &Values, main: &Recording, sidechain: &[Vec<f32>]) -> Result<Learned> {
    let sample_rate_hz = f64::from(main.sample_rate_hz);
    let structure = values.structure();
    let distribution = learn(sample_rate_hz, &structure, &values.controls(), &main.channels, sidechain)
        .with_context(|| main.name.clone())?;
    Ok(Learned {
        sample_rate_hz,
        levels: structure.levels,
        companded: structure.dynamics == MatchingMode::Companded,
        quantiles: distribution.quantiles().to_vec(),
    })
}

fn needs_learning(values: &Values, automation: &Automation, rate_hz: f64) -> bool {
    let is_learned = |plain: f64| DYNAMIC_RANGES.get(plain as usize) == Some(&"learned");
    let events = automation.events(rate_hz);
    is_learned(values.get(Id::DynamicRange))
        || events.iter().any(|event| event.parameter == Id::DynamicRange as usize && is_learned(event.value))
}

fn fitted(mut channels: Vec<Vec<f32>>, samples: usize) -> Vec<Vec<f32>> {
    channels.iter_mut().for_each(|channel| channel.resize(samples, 0.0));
    channels
}

/// Possible numbers of channels of a plugin's bus: mono, stereo, 5.0 and 5.1.
const BUSES: [usize; 4] = [1, 2, 5, 6];

/// Channels of a bus; a sidechain may have none. The plugin decides on valid combinations.
fn bus(what: &str, channels: usize) -> Result<u32> {
    ensure!(
        BUSES.contains(&channels) || what == SIDECHAIN && channels == 0,
        "the {what} has {channels} channels, but the plugin takes 1, 2, 5 (5.0) or 6 (5.1); mix it to one of these"
    );
    Ok(channels as u32)
}

/// Name of the optional bus.
const SIDECHAIN: &str = "sidechain";

/// The plugin's buses for a request; an unsupported layout fails at activation.
fn layout(request: &Request<'_>) -> Result<BusLayout> {
    Ok(BusLayout {
        input: bus("input", request.main.channels.len())?,
        sidechain: bus(SIDECHAIN, request.sidechain.len())?,
        output: bus("output", request.output_channels)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_of_the_plugin_is_taken() {
        for channels in BUSES {
            assert_eq!(bus("input", channels).unwrap(), channels as u32);
            assert_eq!(bus(SIDECHAIN, channels).unwrap(), channels as u32);
        }
        assert_eq!(bus(SIDECHAIN, 0).unwrap(), 0);
        for channels in [0, 3, 4, 7, 8] {
            let error = bus("output", channels).unwrap_err().to_string();
            assert!(error.contains(&format!("{channels} channels")) && error.contains("5.1"), "{error}");
        }
    }
}
