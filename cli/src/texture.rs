//! `pyrophone texture`: texture synthesis as published.

use std::path::Path;
use std::sync::Arc;

use pyrophone_recording::{Note, Recording};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::texture::offline::{Options, synthesize};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};

use crate::args::TextureArgs;
use crate::error::Error;
use crate::progress::{Work, note};
use crate::summary::Outcome;
use crate::{input, output};

/// Writes the fire made from `training` that follows `input`.
pub fn run(args: &TextureArgs, work: &Work) -> Result<Outcome, Error> {
    let shape =
        PyramidConfig { levels: args.levels, window: args.window, feature: args.feature, falloff: args.falloff };
    let options = Options { dynamic_range: !args.no_dynamic_range, scaling_alpha: args.scaling_alpha, eps: args.eps };
    check(args)?;
    output::check(&args.output, &[&args.input, &args.training])?;

    let (signal, broadcast) = input::load_with_time_reference(&args.input, work)?;
    let training = input::load_at(&args.training, signal.sample_rate_hz, work)?;
    output::check_format(&args.output, training.channels.len(), signal.sample_rate_hz)?;
    let dictionary = index(&training, &args.training, &shape, work)?;
    let drive = input::mean(&signal);
    let fire = {
        let stage = work.stage("texture");
        synthesize(&drive, &dictionary, &options, &|done| stage.report(done)).map_err(Error::of_file(&args.input))?
    };
    let fire: Vec<Vec<f32>> =
        fire.into_iter().map(|samples| samples.into_iter().map(|sample| sample as f32).collect()).collect();
    work.check()?;
    let sound = output::write(&args.output, fire, signal.sample_rate_hz, broadcast.as_ref())?;
    Ok(Outcome::with_sound(&args.output, sound))
}

/// The dictionary of a training sound at its own rate, for the published program.
fn index(training: &Recording, path: &Path, shape: &PyramidConfig, work: &Work) -> Result<Arc<Dictionary>, Error> {
    note_if_cancelling(training);
    let stage = work.stage("indexing");
    let channels = input::as_f64(&training.channels);
    let rate_hz = f64::from(training.sample_rate_hz);
    let dictionary =
        Dictionary::new(&channels, rate_hz, shape, &|done| stage.report(done)).map_err(Error::of_file(path))?;
    check_windows(&dictionary, path)?;
    Ok(Arc::new(dictionary))
}

/// Notes channels of the training sound that cancel.
pub fn note_if_cancelling(training: &Recording) {
    if training.notes.contains(&Note::ChannelsCancel) {
        note(&format!("{}: {}", training.name, Note::ChannelsCancel));
    }
}

/// Rejects a dictionary without a single complete window to search.
pub fn check_windows(dictionary: &Dictionary, path: &Path) -> Result<(), Error> {
    if (0..dictionary.shape().top()).any(|level| dictionary.index(level).is_some()) {
        return Ok(());
    }
    Err(Error::Conflict(format!(
        "{}: {:.3} s is too short for one texture window; use a longer recording or fewer levels",
        path.display(),
        dictionary.seconds(),
    )))
}

/// Rejects options out of range before any file is read.
fn check(args: &TextureArgs) -> Result<(), Error> {
    let structure = EngineConfig {
        levels: args.levels,
        window: args.window,
        feature: args.feature,
        falloff: args.falloff,
        ..EngineConfig::default()
    };
    structure.validate().map_err(Error::Option)?;
    input::in_range("--scaling-alpha", args.scaling_alpha, 0.0, 1.0)?;
    input::in_range("--eps", args.eps, 0.0, 1000.0)
}
