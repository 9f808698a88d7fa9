//! `pyrophone flux-merge`: one signal from parts that were measured separately.

use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Flux, FluxShard};
use pyrophone_flame::speed_field::stride;
use pyrophone_flame::upsample::Upsampler;
use pyrophone_recording::check_not_among;

use crate::args::FluxMergeArgs;
use crate::error::Error;
use crate::flux::joining::{self, Extras};
use crate::flux::signal::Signal;
use crate::flux::{motion, pictures, sound};
use crate::input::text;
use crate::progress::{Work, note};
use crate::report::Picture;
use crate::summary::Outcome;

/// Values with their labels, in the order of the page.
type Labelled<T> = Vec<(String, T)>;

/// Writes what one run over all frames would have written, bit for bit.
pub fn run(args: &FluxMergeArgs, work: &Work) -> Result<Outcome, Error> {
    let others: Vec<&Path> = args.speed_field.iter().map(|path| path.as_path()).collect();
    sound::check(&args.sound, args.timeline.rate, &others, false)?;
    let shards = shards(&args.shards)?;
    let shards: Vec<_> = shards.iter().map(|path| path.as_path()).collect();
    for output in sound::files(&args.sound).chain(args.speed_field.as_deref()) {
        check_not_among(output, &shards)?;
    }
    let mut parts = vec![];
    for path in &shards {
        let name = path.display().to_string();
        parts.push((name.clone(), FluxShard::read(&text(path)?, &name)?));
        work.check()?;
    }
    let merged = FluxShard::merge(&parts)?;
    let extras = extras(args, &shards, &merged)?;
    let flux = Flux::from_steps(&merged.steps)?;
    sound::note_interpolated(&flux.interpolated, &merged.numbering);
    let given_hz = args.timeline.rate.map(|frames_hz| frames_hz * merged.numbering.steps_per_frame());
    let rate_hz = given_hz.or(merged.rate_hz);
    sound::known_rate(&args.sound, rate_hz, shards_name(&args.shards))?;
    let signal = Signal::of_flux(&flux, rate_hz).counted(merged.numbering).on_timeline(&args.timeline);
    let mut files = vec![];
    if let Some(path) = &args.speed_field {
        speed_field(path, args, extras.as_ref(), &signal)?;
        files.push(path.clone());
    }
    if sound::files(&args.sound).next().is_none() && args.sound.report.is_none() {
        return Ok(Outcome::default().with_files(files));
    }
    let (facts, surfaces) = facts(args, extras.as_ref(), &merged, &flux, rate_hz, parts.len(), work);
    let signal = match Upsampler::of_settings(&merged.settings) {
        Some(upsampler) => signal.upsampled(&upsampler, &merged.changes),
        None => signal,
    };
    let done = sound::write(&args.sound, &signal.retimed()?, Some(&flux), facts, surfaces, work)?;
    Ok(done.with_files(files))
}

/// Facts and pictures for the report: those of a single run, if the parts hold them.
fn facts(
    args: &FluxMergeArgs,
    extras: Option<&Extras>,
    merged: &FluxShard,
    flux: &Flux,
    rate_hz: Option<f64>,
    parts: usize,
    work: &Work,
) -> (Labelled<String>, Labelled<Picture>) {
    if let Some((facts, fronts, span)) = extras.filter(|_| args.sound.report.is_some()).and_then(Extras::report) {
        let pictures = pictures::draw(&fronts, &merged.numbering, rate_hz, span.first_file, work);
        return (facts.labelled(&merged.settings, flux, args.up, rate_hz, &merged.numbering), pictures);
    }
    if args.sound.report.is_some() {
        note("the parts contain no pictures, so the report has none; measure them with --partial-with report");
    }
    let from = ("Merged from".into(), format!("{parts} parts"));
    (vec![("Measured with".into(), merged.settings.clone()), from], vec![])
}

/// Extra data of the parts, if it is needed.
fn extras(args: &FluxMergeArgs, shards: &[&Path], merged: &FluxShard) -> Result<Option<Extras>, Error> {
    if args.speed_field.is_none() && args.sound.report.is_none() {
        return Ok(None);
    }
    let found = Extras::read(shards)?;
    if let (Some(extras), Some((first, _)), Some((last, _))) =
        (&found, merged.steps.first_key_value(), merged.steps.last_key_value())
    {
        extras.check(*first, *last, |step| merged.numbering.label(step))?;
    }
    Ok(found)
}

/// Joins the parts' speeds into one field.
fn speed_field(path: &Path, args: &FluxMergeArgs, extras: Option<&Extras>, signal: &Signal) -> Result<(), Error> {
    let first_part = shards_name(&args.shards);
    let extras = extras.ok_or_else(|| joining::no_speeds(&first_part.display().to_string()))?;
    let (survey, speeds) = extras.speeds()?;
    if !signal.is_timed {
        return Err(sound::no_rate(first_part));
    }
    if stride(signal.rate_hz) != survey.every {
        let message = format!(
            "--rate is {}, but the parts' speeds were measured with a stride of {} steps, for another rate; measure them with this --rate",
            signal.rate_hz, survey.every
        );
        return Err(Error::Conflict(message));
    }
    let start_s = sound::time_reference(&args.sound, signal)? as f64 / f64::from(args.sound.sample_rate);
    motion::write(path, &survey.field(&speeds, args.up, signal.rate_hz, start_s)?)
}

/// The parts; those in folders in the order of their names.
fn shards(named: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    let mut shards = vec![];
    for path in named {
        let Some(entries) = path.is_dir().then(|| path.read_dir().ok()).flatten() else {
            shards.push(path.clone());
            continue;
        };
        let found = entries.flatten().map(|entry| entry.path());
        let is_part = |path: &PathBuf| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        let mut found: Vec<PathBuf> = found.filter(is_part).collect();
        if found.is_empty() {
            let message =
                format!("{}: no parts here; name a folder of .csv files written by flux --partial", path.display());
            return Err(Error::Conflict(message));
        }
        found.sort_unstable();
        shards.append(&mut found);
    }
    Ok(shards)
}

/// The first part, which messages name for all of them.
fn shards_name(shards: &[PathBuf]) -> &std::path::Path {
    shards.first().map_or(std::path::Path::new("the parts"), |path| path.as_path())
}
