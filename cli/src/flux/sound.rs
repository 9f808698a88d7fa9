//! Conversion of flux to the requested files.

use std::io::Write;
use std::path::Path;

use pyrophone_flame::flux::Flux;
use pyrophone_flame::import::Numbering;
use pyrophone_flame::pressure::{self, Advice, Options};
use pyrophone_recording::{Broadcast, write_file};

use super::signal::{LIKELY_RATE_HZ, Signal};
use super::{clock, film, scale};
use crate::args::{SoundArgs, SoundKind};
use crate::error::Error;
use crate::output;
use crate::progress::{Work, note};
use crate::report::{self, Picture, Report};
use crate::summary::Outcome;

/// Time in which a simulation settles after its start, in seconds.
const START_S: f64 = 0.05;

/// Amplitude ratio beyond which a loud start is noted: 12 dB.
const START_RATIO: f32 = 4.0;

/// Number of interpolated frames that a note lists.
const NAMED_FRAMES: usize = 8;

/// Requested files, apart from the report's.
pub fn files(args: &SoundArgs) -> impl Iterator<Item = &Path> {
    [args.output.as_deref(), args.flux_csv.as_deref()].into_iter().flatten()
}

/// Rejects options out of range, and conflicting outputs, before any file is read. `others` are outputs beside those of
/// `args`; `has_folder` is true if there is a folder of outputs too.
pub fn check(args: &SoundArgs, rate_hz: Option<f64>, others: &[&Path], has_folder: bool) -> Result<(), Error> {
    options(args, rate_hz.unwrap_or(LIKELY_RATE_HZ)).validate()?;
    scale::kept(args)?;
    let outputs: Vec<&Path> = files(args).chain(others.iter().copied()).collect();
    if outputs.is_empty() && args.report.is_none() && !has_folder {
        return Err(Error::Conflict("there is nothing to write; add --output OUT.wav".into()));
    }
    if let Some(sound) = &args.output {
        output::check(sound, &[])?;
        output::check_format(sound, 1, args.sample_rate)?;
    }
    for (index, output) in outputs.iter().enumerate() {
        if Some(*output) != args.output.as_deref() {
            output::check_file(output)?;
        }
        if outputs[..index].contains(output) {
            let message = format!("{}: two outputs have this name; rename one of them", output.display());
            return Err(Error::Conflict(message));
        }
    }
    if let Some(folder) = args.report.as_deref().filter(|path| path.exists() && !path.is_dir()) {
        let message = format!("{}: this is a file, but a report needs a folder; choose another name", folder.display());
        return Err(Error::Conflict(message));
    }
    Ok(())
}

/// The step rate. It does not matter to outputs that are bare numbers; all others need a known rate.
pub fn known_rate(args: &SoundArgs, rate_hz: Option<f64>, input: &Path) -> Result<f64, Error> {
    let needs_rate = args.output.is_some() || args.report.is_some();
    match rate_hz {
        Some(rate_hz) => Ok(rate_hz),
        None if needs_rate => Err(no_rate(input)),
        None => Ok(LIKELY_RATE_HZ),
    }
}

/// Error for an unknown step rate.
pub fn no_rate(input: &Path) -> Error {
    Error::Conflict(format!(
        "{}: its step rate is unknown; give the simulation's frames per second, as in --rate 24",
        input.display()
    ))
}

pub fn options(args: &SoundArgs, rate_hz: f64) -> Options {
    let kind = match args.kind {
        SoundKind::Pressure => pressure::PressureKind::Pressure,
        SoundKind::Envelope => pressure::PressureKind::Envelope,
    };
    let (sample_rate_hz, high_pass_hz) = (args.sample_rate, args.high_pass);
    Options { rate_hz, sample_rate_hz, kind, high_pass_hz, peak_db: args.peak_db, scale: None }
}

/// Notes the frames that were interpolated.
pub fn note_interpolated(frames: &[i64], numbering: &Numbering) {
    if frames.is_empty() {
        return;
    }
    let named: Vec<String> = frames.iter().take(NAMED_FRAMES).map(|step| numbering.label(*step)).collect();
    let more = if frames.len() > named.len() { ", ..." } else { "" };
    note(&format!("{} frames interpolated: {}{more}", frames.len(), named.join(", ")));
}

/// Notes a loud start: a simulation that begins at rest starts with one large step, to which everything else is scaled.
fn note_start(samples: &[f32], sample_rate_hz: u32) {
    let start = ((START_S * f64::from(sample_rate_hz)) as usize).min(samples.len());
    let peak = |samples: &[f32]| samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    let (first, rest) = (peak(&samples[..start]), peak(&samples[start..]));
    if rest > 0.0 && first > START_RATIO * rest {
        let above_db = 20.0 * (first / rest).log10();
        note(&format!(
            "the first {START_S} s are {above_db:.0} dB louder than everything after them, so they set the scale; leave out the start of a simulation that begins at rest"
        ));
    }
}

/// Renders `signal` and writes the outputs requested in `args`, the sound last. `flux` is the table, if there is one.
pub fn write(
    args: &SoundArgs,
    signal: &Signal,
    flux: Option<&Flux>,
    mut facts: Vec<(String, String)>,
    surfaces: Vec<(String, Picture)>,
    work: &Work,
) -> Result<Outcome, Error> {
    if args.output.is_none() && args.report.is_none() {
        return match (&args.flux_csv, flux) {
            (Some(path), Some(flux)) => {
                write_table(path, flux, signal)?;
                Ok(Outcome::default().with_files(vec![path.clone()]))
            }
            _ => Ok(Outcome::default()),
        };
    }
    let advice = Advice::on(signal.rate_hz);
    if advice != Advice::Full && args.kind == SoundKind::Pressure {
        let option = if matches!(advice, Advice::EnvelopeOnly { .. }) { " (--as envelope)" } else { "" };
        note(&format!("at {} steps per second {advice}{option}", signal.rate_hz));
    }
    let scale = scale::kept(args)?;
    let sound = pressure::render(&signal.flux, &Options { scale, ..options(args, signal.rate_hz) })?;
    work.check()?;
    if args.kind == SoundKind::Pressure {
        note_start(&sound.samples, args.sample_rate);
    }
    let mut written = vec![];
    if let (Some(path), Some(flux)) = (&args.flux_csv, flux) {
        write_table(path, flux, signal)?;
        written.push(path.as_path());
    }
    if let Some(folder) = &args.report {
        facts.push(("Steps".into(), format!("{} at {} per second", signal.flux.len(), signal.rate_hz)));
        facts.push(("Step rate".into(), advice.to_string()));
        let report = report_of(args, signal, &sound, facts, surfaces);
        report::write(folder, &report).inspect_err(|_| remove(&written))?;
    }
    let mut done = Outcome::default().with_files(written.iter().map(|path| path.to_path_buf()).collect());
    done.files.extend(args.report.iter().map(|folder| folder.join("index.html")));
    if let Some(path) = &args.output {
        let output = write_output(args, path, signal, sound).inspect_err(|_| remove(&written))?;
        done = Outcome { files: done.files, ..output };
    }
    Ok(done)
}

/// The report of a signal; its scale is added to `facts`.
fn report_of<'a>(
    args: &SoundArgs,
    signal: &'a Signal,
    sound: &'a pressure::Sound,
    mut facts: Vec<(String, String)>,
    surfaces: Vec<(String, Picture)>,
) -> Report<'a> {
    facts.push(("Scale".into(), format!("{:.4e} (peak at {} dB)", sound.scale, args.peak_db)));
    Report {
        title: "Flame signal".into(),
        facts,
        surfaces,
        flux: &signal.flux,
        area: &signal.area,
        rate_hz: signal.rate_hz,
        pressure: &sound.samples,
        sample_rate_hz: args.sample_rate,
        is_envelope: args.kind == SoundKind::Envelope,
    }
}

/// Writes the sound to `path` with its time stamp, and keeps its scale, unless it is silent.
fn write_output(args: &SoundArgs, path: &Path, signal: &Signal, sound: pressure::Sound) -> Result<Outcome, Error> {
    let is_silent = sound.samples.iter().all(|sample| *sample == 0.0);
    let reference_samples = time_reference(args, signal)?;
    let timeline = signal.timeline.as_ref();
    let now = timeline.filter(|timeline| timeline.dated).map(|_| clock::now());
    let broadcast = Broadcast {
        description: format!("Flame signal, {} steps per second", signal.rate_hz),
        time_reference_samples: reference_samples,
        date: now.as_ref().map(|(date, _)| date.clone()),
        time: now.map(|(_, time)| time),
        ixml: timeline.and_then(|timeline| film::ixml(timeline, reference_samples, args.sample_rate)),
    };
    let (scale, peak) = (sound.scale, scale::peak(&sound.samples));
    let written = output::write_signal(path, vec![sound.samples], args.sample_rate, Some(&broadcast))?;
    if is_silent {
        note(&format!("the output is silent: {}", reason_for_silence(signal)));
    } else {
        scale::keep(args, scale)?;
        note(&scale::note(args, scale, peak));
    }
    Ok(Outcome::with_sound(path, written))
}

/// Likely reason why a signal is silent.
fn reason_for_silence(signal: &Signal) -> &'static str {
    match (signal.flux.len(), signal.area.iter().all(|area| *area == 0.0)) {
        (steps, _) if steps <= signal.substeps => "there is only one frame, so nothing changes",
        (_, false) => "the flux is constant: the flame does not move, or as much gas flows in as out",
        (_, true) => "the flux is constant; is there a flame front at this iso value?",
    }
}

/// Writes a table, one row per frame; one row per step if there are more steps than frames.
fn write_table(path: &Path, flux: &Flux, signal: &Signal) -> Result<(), Error> {
    write_file(path, |file| {
        let mut file = std::io::BufWriter::new(file);
        if signal.substeps == 1 && signal.film_frame.is_none() {
            let rate_hz = signal.is_timed.then_some(signal.rate_hz);
            flux.write_csv(rate_hz, |step| signal.numbering.label(step), &mut file)?;
        } else {
            writeln!(file, "time_s,flux")?;
            let start_s = match signal.film_frame {
                Some(_) => 0.0,
                None => signal.first_frame as f64 / signal.measured_hz(),
            };
            for (step, flux) in signal.flux.iter().enumerate() {
                writeln!(file, "{:.9},{flux:?}", start_s + step as f64 / signal.rate_hz)?;
            }
        }
        file.flush()
    })?;
    Ok(())
}

/// Removes outputs already written: half of the outputs is worse than none. Only the original failure is reported.
fn remove(written: &[&Path]) {
    for path in written {
        let _ = std::fs::remove_file(path);
    }
}

/// Position of the first sample on the timeline, in samples.
pub fn time_reference(args: &SoundArgs, signal: &Signal) -> Result<u64, Error> {
    let sample_rate_hz = f64::from(args.sample_rate);
    if let Some(timeline) = &signal.timeline
        && let Some(place_s) = film::place_s(timeline, signal)?
    {
        return Ok((place_s * sample_rate_hz).round() as u64);
    }
    let start = signal.timeline.as_ref().and_then(|timeline| timeline.start_frame);
    let Some(start) = start else { return Ok(args.time_reference.unwrap_or(0)) };
    let steps = frames_since(start, signal.first_frame, &signal.numbering)?;
    Ok((steps as f64 / signal.measured_hz() * sample_rate_hz).round() as u64)
}

/// Steps from the start of the timeline to the first step.
fn frames_since(start: i64, first: i64, numbering: &Numbering) -> Result<u64, Error> {
    let steps = first.checked_sub(numbering.step_from(start)).and_then(|steps| u64::try_from(steps).ok());
    steps.ok_or_else(|| {
        let what = format!("--start-frame is {start}, but the first frame is {}", numbering.label(first));
        Error::Conflict(format!("{what}; the timeline must start there or earlier"))
    })
}
