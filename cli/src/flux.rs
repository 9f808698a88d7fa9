//! `pyrophone flux`: the flame signal of a simulation or of a flux series.

mod ambisonic;
mod cache;
mod clock;
pub mod extras;
pub mod facts;
mod film;
pub mod joining;
mod kept;
pub mod measuring;
pub mod motion;
mod per_cluster;
pub mod pictures;
mod retime;
mod scale;
mod sight;
pub mod signal;
pub mod sound;
mod units;
pub mod upsampling;

use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Changes, Flux, FluxShard};
use pyrophone_flame::import::{Series, Timing};
use pyrophone_recording::{check_not_among, write_file};

use self::extras::PartExtras;
use self::facts::CacheFacts;
use self::measuring::Plan;
use self::motion::Survey;
use self::signal::Signal;
use crate::args::{FluxArgs, PartialWith};
use crate::error::Error;
use crate::input::{self, in_range};
use crate::progress::Work;
use crate::summary::Outcome;

/// Extensions of flux tables; other files are sounds or simulations.
const TABLES: [&str; 5] = ["csv", "tsv", "txt", "dat", "npy"];

/// Extensions of sounds whose samples are flux.
const SOUNDS: [&str; 13] =
    ["wav", "wave", "bwf", "rf64", "w64", "aif", "aiff", "aifc", "caf", "flac", "ogg", "oga", "mp3"];

/// Measures the frames of `input`, or reads its series, and writes the requested outputs.
pub fn run(args: &FluxArgs, work: &Work) -> Result<Outcome, Error> {
    let others: Vec<&Path> = args.partial.file.iter().chain(&args.speed_field).map(|path| path.as_path()).collect();
    sound::check(&args.sound, args.timeline.rate, &others, args.clusters.folder.is_some())?;
    pyrophone_flame::Front::new(args.iso.unwrap_or(0.0), args.refine)?;
    in_range("--clusters", args.clusters.count as f64, 1.0, 256.0)?;
    per_cluster::check(args)?;
    let extension = args.input.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_series = TABLES.contains(&extension.as_str()) || SOUNDS.contains(&extension.as_str());
    if is_series && !args.input.is_dir() {
        series(args, SOUNDS.contains(&extension.as_str()), work)
    } else {
        // On a thread of the pool, which measures too: what one thread has freed is of no use to another, and a large
        // cache's first look would hold its memory until the end.
        rayon::scope(|_| simulation(args, work))
    }
}

/// Turns a series into pressure; nothing needs to be measured.
fn series(args: &FluxArgs, is_sound: bool, work: &Work) -> Result<Outcome, Error> {
    let given = [
        ("--iso", args.iso.is_some()),
        ("--frames", args.frames.is_some()),
        ("--partial", args.partial.file.is_some()),
        ("--mesh", args.mesh.folder.is_some()),
        ("--per-cluster", args.clusters.folder.is_some()),
        ("--flux-csv", args.sound.flux_csv.is_some()),
        ("--speed-field", args.speed_field.is_some()),
        ("--rate", is_sound && args.timeline.rate.is_some()),
    ];
    let shown = args.input.display();
    if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
        let what = if is_sound { "a sound file, which has its own rate" } else { "a series" };
        let message = format!("{shown}: this is {what}, not a simulation, so {option} does not apply; leave it out");
        return Err(Error::Conflict(message));
    }
    for output in sound::files(&args.sound) {
        check_not_among(output, &[&args.input])?;
    }
    let signal = if is_sound {
        let recording = input::load(&args.input, work)?;
        Signal::of_series(input::mean(&recording), 0, f64::from(recording.sample_rate_hz))
    } else {
        let series = Series::read(&args.input)?;
        let first = match series.timing {
            Timing::Frames(first) => first,
            Timing::Times(_) if series.rate_hz.is_none() => {
                let message = format!("{shown}: its time steps are uneven, but must be even; resample the series");
                return Err(Error::Conflict(message));
            }
            Timing::Times(_) => 0,
        };
        let rate_hz = args.timeline.rate.or(series.rate_hz).ok_or_else(|| sound::no_rate(&args.input))?;
        Signal::of_series(series.values, first, rate_hz)
    };
    let signal = match upsampling::chosen(args, upsampling::Content::Series, Some(signal.rate_hz))? {
        Some(upsampler) => signal.upsampled(&upsampler, &Changes::new()),
        None => signal,
    };
    let facts = vec![("Series".into(), shown.to_string())];
    sound::write(&args.sound, &signal.on_timeline(&args.timeline).retimed()?, None, facts, vec![], work)
}

fn simulation(args: &FluxArgs, work: &Work) -> Result<Outcome, Error> {
    let plan = Plan::new(args, work)?;
    let others = args.partial.file.as_deref().into_iter().chain(args.speed_field.as_deref());
    let outputs: Vec<&Path> = sound::files(&args.sound).chain(others).collect();
    let files = cache::files(&plan.sequence);
    let inputs: Vec<&Path> = files.iter().map(|path| path.as_path()).collect();
    for output in &outputs {
        check_not_among(output, &inputs)?;
    }
    let folders = args.sound.report.as_deref().or(args.clusters.folder.as_deref());
    let Some(beside) = outputs.first().copied().or(folders) else { return Ok(Outcome::default()) };
    // Before the long work, not behind it.
    let rate_hz = plan.rate_hz(args.timeline.rate)?;
    let needs_rate = args.speed_field.is_some() || args.clusters.folder.is_some();
    if rate_hz.is_none() && (needs_rate || holds(args, PartialWith::SpeedField)) {
        return Err(sound::no_rate(&args.input));
    }
    sound::known_rate(&args.sound, rate_hz, &args.input)?;
    check_place(args, &plan, rate_hz)?;
    let plan = plan.with_upsampler(upsampling::chosen(args, upsampling::Content::of_measure(args.measure), rate_hz)?);
    let indices = if holds(args, PartialWith::Report) { plan.whole.as_ref().map(|whole| &whole.indices) } else { None };
    let indices = indices.unwrap_or(&plan.indices);
    let checked = units::check(&plan.sequence, &plan.selection, indices, rate_hz, work)?;
    let kept = plan.measure(beside, work)?;
    let part = FluxShard {
        settings: plan.settings.clone(),
        cache: cache::identity(&files),
        rate_hz,
        numbering: *plan.sequence.numbering(),
        steps: kept.steps.clone(),
        changes: kept.changes.clone(),
    };
    match write(args, &plan, rate_hz, checked, &part, work) {
        Ok(done) => {
            kept.remove();
            Ok(done)
        }
        Err(error) => Err(kept.unfinished(error)),
    }
}

/// Rejects a timeline position that the sound cannot have.
fn check_place(args: &FluxArgs, plan: &Plan, rate_hz: Option<f64>) -> Result<(), Error> {
    let Some(first) = plan.first_frame() else { return Ok(()) };
    let rate_hz = rate_hz.unwrap_or(signal::LIKELY_RATE_HZ);
    let signal = Signal::of_series(vec![0.0], first, rate_hz).counted(*plan.sequence.numbering());
    sound::time_reference(&args.sound, &signal.on_timeline(&args.timeline).retimed()?).map(|_| ())
}

/// True if parts should hold `what` in addition to their table.
fn holds(args: &FluxArgs, what: PartialWith) -> bool {
    args.partial.with.contains(&what)
}

/// Writes the requested outputs from the measurements.
fn write(
    args: &FluxArgs,
    plan: &Plan,
    rate_hz: Option<f64>,
    checked: Option<String>,
    part: &FluxShard,
    work: &Work,
) -> Result<Outcome, Error> {
    let facts = CacheFacts::of_plan(plan, &args.input, checked);
    let mut files: Vec<PathBuf> = vec![];
    if let Some(path) = &args.partial.file {
        let extras = extras(args, plan, rate_hz, facts.clone(), work)?;
        write_file(path, |file| part.write(file))?;
        files.push(path.clone());
        files.extend(extras.map(|extras| extras.write(path)).transpose()?);
    }
    files.extend(args.speed_field.clone());
    let is_sound = args.sound.report.is_some() || sound::files(&args.sound).next().is_some();
    if !is_sound && args.speed_field.is_none() && args.clusters.folder.is_none() {
        return Ok(Outcome { files, ..Outcome::default() });
    }
    let flux = Flux::from_steps(&part.steps)?;
    sound::note_interpolated(&flux.interpolated, plan.sequence.numbering());
    let signal = Signal::of_flux(&flux, rate_hz).counted(*plan.sequence.numbering());
    let signal = signal.on_timeline(&args.timeline);
    // Output for its own frames; those of other parts are read for the merge alone.
    let own = plan.own().ok_or(pyrophone_flame::Error::NoFrames)?;
    if let (Some(path), Some(rate_hz)) = (&args.speed_field, rate_hz) {
        let start_s = sound::time_reference(&args.sound, &signal)? as f64 / f64::from(args.sound.sample_rate);
        let survey = Survey::new(plan, &own, rate_hz, work)?;
        motion::write(path, &survey.field(&survey.measure(plan, work)?, args.up, rate_hz, start_s)?)?;
    }
    if let Some(folder) = &args.clusters.folder {
        files.extend(per_cluster::write(folder, args, plan, part, &signal, work)?);
    }
    if !is_sound {
        return Ok(Outcome { files, ..Outcome::default() });
    }
    let mut surfaces = vec![];
    if args.sound.report.is_some() {
        let fronts = pictures::fronts(plan, &own, work)?;
        surfaces = pictures::draw(&fronts, plan.sequence.numbering(), rate_hz, own.span.first_file, work);
    }
    let facts = facts.labelled(&plan.settings, &flux, args.up, rate_hz, plan.sequence.numbering());
    let signal = match &plan.upsampler {
        Some(upsampler) => signal.upsampled(upsampler, &part.changes),
        None => signal,
    };
    let signal = signal.retimed()?;
    let done = sound::write(&args.sound, &signal, Some(&flux), facts, surfaces, work)?;
    Ok(done.with_files(files))
}

/// Data of a part beyond its table; none if nothing was requested, or if no frame of the whole exists.
fn extras(
    args: &FluxArgs,
    plan: &Plan,
    rate_hz: Option<f64>,
    facts: CacheFacts,
    work: &Work,
) -> Result<Option<PartExtras>, Error> {
    let Some(whole) = plan.whole.as_ref().filter(|_| !args.partial.with.is_empty()) else { return Ok(None) };
    let survey = match rate_hz.filter(|_| holds(args, PartialWith::SpeedField)) {
        Some(rate_hz) => Some(Survey::new(plan, whole, rate_hz, work)?),
        None => None,
    };
    let speeds = survey.map(|survey| Ok::<_, Error>((survey, survey.measure(plan, work)?))).transpose()?;
    let fronts = if holds(args, PartialWith::Report) { Some(pictures::fronts(plan, whole, work)?) } else { None };
    let first_own = plan.own().map_or(i64::MAX, |own| own.span.first);
    Ok(Some(PartExtras { span: whole.span, first_own, facts, speeds, fronts }))
}
