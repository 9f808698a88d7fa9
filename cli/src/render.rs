//! `pyrophone render`: the plug-in's whole signal chain.

mod play;
mod recordings;
mod source;
mod training;

use std::path::Path;
use std::sync::Arc;

use pyrophone_flame::live::{Inline, LiveFlow};
use pyrophone_recording::{MAX_CHANNELS, Recording};
use pyrophone_settings::automation::Event;
use pyrophone_settings::table::{DRIVE_MODES, DYNAMIC_RANGES, VORTEX_FLOWS};
use pyrophone_settings::{Automation, Id, Preset, Values};
use pyrophone_synthesis::chain::{Chain, Channels, learn};
use pyrophone_synthesis::controls::Fuel;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::Distribution;
use pyrophone_synthesis::vortex::{Simulator, SpeedField};

use self::play::{BLOCK_SAMPLES, Score, play};
use self::recordings::Recordings;
use self::source::Source;
use crate::args::RenderArgs;
use crate::error::Error;
use crate::progress::{Work, note};
use crate::summary::Outcome;
use crate::{input, output};

/// Writes the plug-in's output for `input`, played from position 0, with the latency cut off.
pub fn run(args: &RenderArgs, work: &Work) -> Result<Outcome, Error> {
    let preset = Preset::find(&args.preset)?;
    let values = values(args, &preset)?;
    let recordings = Recordings::new(args, &preset, &values);
    let automation = match &args.automation {
        Some(path) => Automation::load(path)?,
        None => Automation::default(),
    };
    if args.learn.is_some() && args.dynamic_range.is_some_and(|choice| choice != crate::args::DynamicRange::Learned) {
        let message = "--learn contradicts --dynamic-range off and --dynamic-range running; leave one of them out";
        return Err(Error::Conflict(message.into()));
    }
    check_output(args, &recordings)?;

    let source = Source::load(args, &values, &automation, work)?;
    let main = &source.recording;
    let rate_hz = f64::from(main.sample_rate_hz);
    let outputs = output_channels(args, main)?;
    output::check_format(&args.output, outputs, main.sample_rate_hz)?;
    let events = automation.events(rate_hz);
    let field = args.speed_field.as_deref().map(speed_field).transpose()?;
    check_sound(args, &recordings, &values, &events)?;

    let sidechain = sidechain(args, main, work)?;
    note_unused_options(args, &values, &events);
    let structure = values.structure();
    let channels = Channels { input: main.channels.len(), sidechain: sidechain.len(), output: outputs };
    let mut chain = Chain::new(rate_hz, channels, &structure).map_err(Error::of_file(&source.name))?;
    recordings.load(&mut chain, &values, work)?;
    simulate_gas(&mut chain)?;
    if let Some(field) = field {
        drop(chain.swap_field(Some(Arc::new(field))));
    }
    if needs_learning(&values, &events) {
        let distribution = learned(args, &values, &source, &sidechain, work)?;
        drop(chain.swap_distribution(Some(Arc::new(distribution))));
    }
    let score = Score { main: &main.channels, sidechain: &sidechain, outputs, values, events: &events };
    let rendered = {
        let stage = work.stage("rendering");
        play(&mut chain, &score, BLOCK_SAMPLES, &|done| stage.report(done))?
    };
    if chain.take_meters().cancels {
        note("the input's channels cancel when averaged, and their average drives the engines; invert one of them");
    }
    let sound = output::write(&args.output, rendered, main.sample_rate_hz, source.broadcast.as_ref())?;
    Ok(Outcome { latency_samples: Some(chain.latency_samples()), ..Outcome::with_sound(&args.output, sound) })
}

/// Rejects an output that cannot be written or would overwrite one of its sources.
fn check_output(args: &RenderArgs, recordings: &Recordings) -> Result<(), Error> {
    let sources = [&args.input, &args.sidechain, &args.learn, &args.speed_field, &args.automation];
    let sources = sources.into_iter().flatten().map(|path| path.as_path()).chain(recordings.paths());
    let sources: Vec<&Path> = sources.chain([Path::new(&args.preset)]).collect();
    output::check(&args.output, &sources)
}

fn speed_field(path: &Path) -> Result<SpeedField, Error> {
    SpeedField::from_bytes(&pyrophone_recording::read(path)?).map_err(Error::of_file(path))
}

/// Gas for the vortex flow `live`, simulated on demand.
fn simulate_gas(chain: &mut Chain) -> Result<(), Error> {
    let step_s = chain.live_step_s();
    let flows = [LiveFlow::new(step_s)?, LiveFlow::new(step_s)?];
    let places = flows[0].places();
    let simulators = flows.map(|flow| Box::new(Inline::new(flow)) as Box<dyn Simulator>);
    chain.set_simulators(simulators, &places).map_err(Error::Option)
}

/// The preset's values, then `--dynamic-range` (or `--learn`, which implies `learned`), then `--set`.
fn values(args: &RenderArgs, preset: &Preset) -> Result<Values, Error> {
    let mut values = preset.values;
    let learn = args.learn.as_ref().map(|_| crate::args::DynamicRange::Learned);
    if let Some(choice) = args.dynamic_range.or(learn) {
        let (id, text) = choice.as_setting();
        values.set_text(id, text)?;
    }
    for setting in &args.settings {
        let Some((id, text)) = setting.split_once('=') else {
            let message = format!("--set {setting}: there is no '='; write it as in --set alpha=3.0");
            return Err(Error::Conflict(message.replace(['\n', '\r'], " ")));
        };
        values.set_text(id.trim(), text)?;
    }
    values.structure().validate().map_err(Error::Option)?;
    Ok(values)
}

fn output_channels(args: &RenderArgs, main: &Recording) -> Result<usize, Error> {
    // Without an input file, any number of channels is possible.
    let least = if args.input.is_some() { main.channels.len() } else { 1 };
    let found = args.channels.unwrap_or(main.channels.len());
    if (least..=MAX_CHANNELS).contains(&found) {
        return Ok(found);
    }
    let least = if args.input.is_some() { format!("the input's {least}") } else { least.to_string() };
    Err(Error::Conflict(format!(
        "--channels is {found}, but must lie between {least} and {MAX_CHANNELS}; choose a number in that range"
    )))
}

/// Checks that something will sound. Texture without a recording is silent: an error if nothing else sounds, otherwise
/// a note.
fn check_sound(args: &RenderArgs, recordings: &Recordings, values: &Values, events: &[Event]) -> Result<(), Error> {
    let may_sound = |id: Id| {
        let off = |plain: f64| id.parameter().is_off(plain);
        !off(values.get(id)) || events.iter().any(|event| event.parameter == id as usize && !off(event.value))
    };
    let field = |plain: f64| VORTEX_FLOWS.get(plain as usize) == Some(&"field");
    let mut flows = events.iter().filter(|event| event.parameter == Id::VortexFlow as usize);
    let follows = field(values.get(Id::VortexFlow)) || flows.any(|event| field(event.value));
    if args.speed_field.is_some() && !(follows && may_sound(Id::VortexLevel)) {
        note("the speed field is not used; set vortex_flow=field and a vortex_level");
    }
    let is_set = |id: Id, is_wanted: fn(f64) -> bool| {
        is_wanted(values.get(id)) || events.iter().any(|event| event.parameter == id as usize && is_wanted(event.value))
    };
    let uses_second = is_set(Id::RecordingBlend, |blend| blend > 0.0) || is_set(Id::RecordingSlot, |slot| slot == 1.0);
    if args.recording_b.is_some() && !uses_second {
        note("the second recording is not used; set a recording_blend, or recording_slot=2");
    }
    if recordings.has_first() || args.recording_b.is_some() && uses_second || !may_sound(Id::TextureLevel) {
        return Ok(());
    }
    if values.structure().dynamics == MatchingMode::Companded {
        if values.controls().crackle.fuel != Fuel::Off {
            return Ok(());
        }
        note("there is no --training, so spectral extension replaces texture");
        return Ok(());
    }
    if [Id::LowLevel, Id::ExtensionLevel, Id::VortexLevel].into_iter().any(may_sound) {
        note("there is no --training, so the texture layer is silent");
        return Ok(());
    }
    let message = format!("preset {}: only texture is on, but there is no recording; add --training", args.preset);
    Err(Error::Conflict(message))
}

/// Notes inputs that the drive does not use.
fn note_unused_options(args: &RenderArgs, values: &Values, events: &[Event]) {
    let listens = |wanted: &dyn Fn(&str) -> bool| {
        let is_wanted = |plain: f64| DRIVE_MODES.get(plain as usize).is_some_and(|mode| wanted(mode));
        let mut modes = events.iter().filter(|event| event.parameter == Id::DriveMode as usize);
        is_wanted(values.get(Id::DriveMode)) || modes.any(|event| is_wanted(event.value))
    };
    if args.input.is_some() && !listens(&|mode| mode != "flame") {
        note(
            "drive_mode is flame: a built-in flame drives the engines, and the input only sets length, sample rate and channels; \
             choose another drive_mode to use its sound",
        );
    }
    if args.sidechain.is_some() && !listens(&|mode| mode == "envelope") {
        note("the sidechain is not used; set drive_mode=envelope");
    }
}

/// The sidechain's channels at the input's rate and length: cut, or padded with silence.
fn sidechain(args: &RenderArgs, main: &Recording, work: &Work) -> Result<Vec<Vec<f32>>, Error> {
    let Some(path) = &args.sidechain else { return Ok(vec![]) };
    let mut channels = input::load_at(path, main.sample_rate_hz, work)?.channels;
    for samples in &mut channels {
        samples.resize(main.len_samples(), 0.0);
    }
    Ok(channels)
}

fn needs_learning(values: &Values, events: &[Event]) -> bool {
    let is_learned = |plain: f64| DYNAMIC_RANGES.get(plain as usize) == Some(&"learned");
    is_learned(values.get(Id::DynamicRange))
        || events.iter().any(|event| event.parameter == Id::DynamicRange as usize && is_learned(event.value))
}

/// The distribution from `--learn`, otherwise from a first pass over the input.
fn learned(
    args: &RenderArgs,
    values: &Values,
    source: &Source,
    sidechain: &[Vec<f32>],
    work: &Work,
) -> Result<Distribution, Error> {
    let main = &source.recording;
    let rate_hz = f64::from(main.sample_rate_hz);
    let learn = |path: &Path, sound: &[Vec<f32>], sidechain: &[Vec<f32>]| {
        learn(rate_hz, &values.structure(), &values.controls(), sound, sidechain).map_err(Error::of_file(path))
    };
    match &args.learn {
        Some(path) => learn(path, &input::load_at(path, main.sample_rate_hz, work)?.channels, &[]),
        None => learn(&source.name, &main.channels, sidechain),
    }
}
