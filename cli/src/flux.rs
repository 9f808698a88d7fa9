//! `pyrophone flux`: the flame signal of a simulation, or of a series of flux.

mod cache;
mod clock;
mod film;
mod kept;
mod measuring;
pub mod motion;
mod retime;
mod scale;
mod sight;
pub mod signal;
pub mod sound;
mod units;
pub mod upsampling;

use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Flux, FluxShard};
use pyrophone_flame::import::{Series, Timing};
use pyrophone_recording::{check_not_among, write_file};
use rayon::prelude::*;

use self::measuring::Plan;
use self::signal::Signal;
use crate::args::FluxArgs;
use crate::error::Error;
use crate::input;
use crate::progress::Work;
use crate::report::{self, Picture};
use crate::summary::Done;

/// Pictures of the front in a report.
const PICTURES: usize = 12;

/// Tables of flux; other files are sounds or simulations.
const TABLES: [&str; 5] = ["csv", "tsv", "txt", "dat", "npy"];

/// Sounds whose samples are flux.
const SOUNDS: [&str; 13] =
    ["wav", "wave", "bwf", "rf64", "w64", "aif", "aiff", "aifc", "caf", "flac", "ogg", "oga", "mp3"];

/// Measures the frames of `input`, or takes its series, and writes what was asked for.
pub fn run(args: &FluxArgs, work: &Work) -> Result<Done, Error> {
    let others: Vec<&Path> = args.partial.iter().chain(&args.speed_field).map(|path| path.as_path()).collect();
    sound::check(&args.sound, args.timeline.rate, &others)?;
    pyrophone_flame::Front::new(args.iso.unwrap_or(0.0), args.refine)?;
    let extension = args.input.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let is_series = TABLES.contains(&extension.as_str()) || SOUNDS.contains(&extension.as_str());
    if is_series && !args.input.is_dir() {
        series(args, SOUNDS.contains(&extension.as_str()), work)
    } else {
        simulation(args, work)
    }
}

/// A series goes straight to pressure.
fn series(args: &FluxArgs, is_sound: bool, work: &Work) -> Result<Done, Error> {
    let given = [
        ("--iso", args.iso.is_some()),
        ("--frames", args.frames.is_some()),
        ("--partial", args.partial.is_some()),
        ("--mesh", args.mesh.is_some()),
        ("--flux-csv", args.sound.flux_csv.is_some()),
        ("--speed-field", args.speed_field.is_some()),
        ("--rate", is_sound && args.timeline.rate.is_some()),
    ];
    let shown = args.input.display();
    if let Some((option, _)) = given.iter().find(|(_, given)| *given) {
        let what = if is_sound { "a sound, with a rate of its own" } else { "a series" };
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
                let message = format!("{shown}: its times are uneven, but steps must be even; resample the series");
                return Err(Error::Conflict(message));
            }
            Timing::Times(_) => 0,
        };
        let rate_hz = args.timeline.rate.or(series.rate_hz).ok_or_else(|| sound::no_rate(&args.input))?;
        Signal::of_series(series.values, first, rate_hz)
    };
    let facts = vec![("Series".into(), shown.to_string())];
    sound::write(&args.sound, &signal.on_timeline(&args.timeline).retimed()?, None, facts, vec![], work)
}

fn simulation(args: &FluxArgs, work: &Work) -> Result<Done, Error> {
    let plan = Plan::new(args, work)?;
    let others = args.partial.as_deref().into_iter().chain(args.speed_field.as_deref());
    let outputs: Vec<&Path> = sound::files(&args.sound).chain(others).collect();
    let files = cache::files(&plan.sequence);
    let inputs: Vec<&Path> = files.iter().map(|path| path.as_path()).collect();
    for output in &outputs {
        check_not_among(output, &inputs)?;
    }
    let Some(beside) = outputs.first().copied().or(args.sound.report.as_deref()) else { return Ok(Done::default()) };
    // Before the long work, not behind it.
    let rate_hz = plan.rate_hz(args.timeline.rate)?;
    if rate_hz.is_none() && args.speed_field.is_some() {
        return Err(sound::no_rate(&args.input));
    }
    sound::known_rate(&args.sound, rate_hz, &args.input)?;
    check_place(args, &plan, rate_hz)?;
    let plan = plan.with_upsampler(upsampling::chosen(args, rate_hz)?);
    let checked = units::check(&plan.sequence, &plan.selection, &plan.indices, rate_hz, work)?;
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

/// Refuses a place on the timeline that the sound cannot have.
fn check_place(args: &FluxArgs, plan: &Plan, rate_hz: Option<f64>) -> Result<(), Error> {
    let Some(first) = plan.first_frame() else { return Ok(()) };
    let rate_hz = rate_hz.unwrap_or(signal::LIKELY_RATE_HZ);
    let signal = Signal::of_series(vec![0.0], first, rate_hz).counted(*plan.sequence.numbering());
    sound::time_reference(&args.sound, &signal.on_timeline(&args.timeline).retimed()?).map(|_| ())
}

/// Everything that was asked for, from what was measured.
fn write(
    args: &FluxArgs,
    plan: &Plan,
    rate_hz: Option<f64>,
    checked: Option<String>,
    part: &FluxShard,
    work: &Work,
) -> Result<Done, Error> {
    let files: Vec<PathBuf> = args.partial.iter().chain(&args.speed_field).cloned().collect();
    if let Some(path) = &args.partial {
        write_file(path, |file| part.write(file))?;
    }
    let is_sound = args.sound.report.is_some() || sound::files(&args.sound).next().is_some();
    if !is_sound && args.speed_field.is_none() {
        return Ok(Done { files, ..Done::default() });
    }
    let flux = Flux::from_steps(&part.steps)?;
    sound::note_interpolated(&flux.interpolated, plan.sequence.numbering());
    let signal = Signal::of_flux(&flux, rate_hz).counted(*plan.sequence.numbering());
    let signal = signal.on_timeline(&args.timeline);
    if let (Some(path), Some(rate_hz)) = (&args.speed_field, rate_hz) {
        let start_s = sound::time_reference(&args.sound, &signal)? as f64 / f64::from(args.sound.sample_rate);
        motion::write_of_frames(path, plan, args.up, rate_hz, start_s, work)?;
    }
    if !is_sound {
        return Ok(Done { files, ..Done::default() });
    }
    let surfaces = if args.sound.report.is_some() { surfaces(plan, rate_hz, work)? } else { vec![] };
    let mut facts = vec![
        ("Simulation".into(), args.input.display().to_string()),
        ("Measured with".into(), plan.settings.clone()),
        ("Interpolated".into(), format!("{} of {} frames", flux.interpolated.len(), flux.rows.len())),
    ];
    if let Some(sight) = &plan.sight {
        let first =
            format!("voxel {}; what burns in the first frame spans {}", sight.voxel_text(), sight.extent_text());
        facts.push(("Size".into(), format!("{first} (world units)")));
    }
    let [x, y, z] = ["first", "second", "third"];
    let up = match args.up {
        crate::args::UpAxis::Y => y,
        crate::args::UpAxis::Z => z,
    };
    facts
        .push(("Axes".into(), format!("{x}, {y}, {z} as in the files; the {up} points up for the speed field (--up)")));
    let told_hz = rate_hz.map_or("unknown".into(), |rate_hz| format!("{rate_hz} measured steps a second"));
    facts.push(("Rate".into(), format!("{told_hz}, {}", plan.sequence.numbering())));
    facts.extend(checked.map(|checked| ("Rate and unit".into(), checked)));
    let signal = match &plan.upsampler {
        Some(upsampler) => signal.upsampled(upsampler, &part.changes),
        None => signal,
    };
    let signal = signal.retimed()?;
    let done = sound::write(&args.sound, &signal, Some(&flux), facts, surfaces, work)?;
    Ok(done.with_files(files))
}

/// Pictures of the front at even distances, in one view.
fn surfaces(plan: &Plan, rate_hz: Option<f64>, work: &Work) -> Result<Vec<(String, Picture)>, Error> {
    let stage = work.stage("drawing");
    let last = plan.indices.len().saturating_sub(1);
    let count = PICTURES.min(plan.indices.len());
    let chosen: Vec<usize> = (0..count).map(|n| plan.indices[n * last / count.saturating_sub(1).max(1)]).collect();
    let first = plan.sequence.numbers().nth(plan.indices.first().copied().unwrap_or(0)).unwrap_or(0);
    let drawn: Result<Vec<_>, Error> = chosen
        .par_iter()
        .map(|index| {
            work.check()?;
            // Frames that were skipped have no picture either.
            let frame = plan.read(*index).ok();
            Ok(frame.and_then(|frame| Some((frame.number, plan.front.mesh(&frame.field).ok()?))))
        })
        .collect();
    let drawn: Vec<_> = drawn?.into_iter().flatten().collect();
    stage.at(0.5);
    let view = report::View::of(drawn.iter().map(|(_, mesh)| mesh));
    let time_s = |number: i64| rate_hz.map(|rate_hz| number.saturating_sub(first) as f64 / rate_hz);
    let label = |number: i64| format!("frame {} · {:.3} s", plan.label(number), time_s(number).unwrap_or_default());
    Ok(drawn.par_iter().map(|(number, mesh)| (label(*number), view.draw(mesh))).collect())
}
