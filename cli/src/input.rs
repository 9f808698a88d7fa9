//! Reading and checking of inputs.

mod standard;

use std::io::Cursor;
use std::path::Path;

use pyrophone_recording::{Broadcast, Note, Recording, decode, decode_bytes, no_progress, resample};
use pyrophone_settings::FactoryFire;

use crate::error::Error;
use crate::output::is_standard;
use crate::progress::{Work, note};

/// Share of the channels' mean power below which the power of their mean indicates that they cancel.
const CANCELLING_SHARE: f64 = 0.01;

/// Reads a sound file at its own rate, or plays a factory fire.
pub fn load(path: &Path, work: &Work) -> Result<Recording, Error> {
    load_with_time_reference(path, work).map(|(recording, _)| recording)
}

/// Reads a sound file or a factory fire, and the timeline position that it states.
pub fn load_with_time_reference(path: &Path, work: &Work) -> Result<(Recording, Option<Broadcast>), Error> {
    if is_standard(path) {
        let bytes = standard::read(work)?;
        let stage = work.stage("reading");
        let recording = stop(decode_bytes(&bytes, standard::NAME, &|done| stage.report(done)))?;
        drop(stage);
        print_notes(&recording);
        return Ok((recording, Broadcast::read(&mut Cursor::new(&bytes))));
    }
    if FactoryFire::is_meant_by(path) {
        return Ok((factory_fire(path, work)?, None));
    }
    let stage = work.stage("reading");
    let recording = stop(decode(path, &|done| stage.report(done)))?;
    drop(stage);
    print_notes(&recording);
    Ok((recording, Broadcast::of_file(path)))
}

/// Plays a factory fire.
fn factory_fire(path: &Path, work: &Work) -> Result<Recording, Error> {
    let stage = work.stage("kindling");
    let fire = pyrophone_fires::read(path, &|done| stage.report(done))?;
    stop(decode_bytes(&fire.bytes, &fire.name, &no_progress))
}

/// Notes anything odd about a recording. Cancelling channels are left out: they matter for some uses only.
fn print_notes(recording: &Recording) {
    for found in recording.notes.iter().filter(|found| **found != Note::ChannelsCancel) {
        note(&format!("{}: {found}", recording.name));
    }
}

/// Reads a sound file and resamples it to `rate_hz`.
pub fn load_at(path: &Path, rate_hz: u32, work: &Work) -> Result<Recording, Error> {
    at_rate(&load(path, work)?, rate_hz, work)
}

/// Resamples a sound to `rate_hz`.
pub fn at_rate(recording: &Recording, rate_hz: u32, work: &Work) -> Result<Recording, Error> {
    let stage = work.stage("resampling");
    stop(resample(recording, rate_hz, &|done| stage.report(done)))
}

fn stop(result: Result<Recording, pyrophone_recording::Error>) -> Result<Recording, Error> {
    result.map_err(|error| match error {
        pyrophone_recording::Error::Cancelled => Error::Cancelled,
        other => other.into(),
    })
}

/// Reads a text file.
pub fn text(path: &Path) -> Result<String, Error> {
    let not_text = |_| Error::Conflict(format!("{}: this is not a text file; choose another", path.display()));
    String::from_utf8(pyrophone_recording::read(path)?).map_err(not_text)
}

/// Channels in double precision.
pub fn as_f64(channels: &[Vec<f32>]) -> Vec<Vec<f64>> {
    channels.iter().map(|samples| samples.iter().map(|sample| f64::from(*sample)).collect()).collect()
}

/// Mean of the channels, which drives the engines; notes channels that cancel.
pub fn mean(recording: &Recording) -> Vec<f64> {
    let count = recording.channels.len() as f64;
    let mean: Vec<f64> = (0..recording.len_samples())
        .map(|index| recording.channels.iter().map(|samples| f64::from(samples[index])).sum::<f64>() / count)
        .collect();
    let power: f64 = mean.iter().map(|sample| sample * sample).sum();
    let mean_power = recording.channels.iter().flatten().map(|sample| f64::from(*sample).powi(2)).sum::<f64>() / count;
    if power < CANCELLING_SHARE * mean_power {
        note(&format!(
            "{}: its channels cancel when averaged, and their average drives the engines; invert one of them",
            recording.name
        ));
    }
    mean
}

/// Rejects an input whose rate the engines do not support.
pub fn check_rate(recording: &Recording, path: &Path) -> Result<(), Error> {
    const ALLOWED_HZ: std::ops::RangeInclusive<u32> = 8_000..=384_000;
    if ALLOWED_HZ.contains(&recording.sample_rate_hz) {
        return Ok(());
    }
    Err(Error::Conflict(format!(
        "{}: the sample rate is {} Hz, but must lie between {} and {} Hz; convert it to 48000 Hz",
        path.display(),
        recording.sample_rate_hz,
        ALLOWED_HZ.start(),
        ALLOWED_HZ.end(),
    )))
}

/// Rejects an option outside its range, NaN included.
pub fn in_range(option: &'static str, found: f64, low: f64, high: f64) -> Result<(), Error> {
    if found >= low && found <= high {
        return Ok(());
    }
    Err(Error::Option(pyrophone_synthesis::Error::OutOfRange { what: option, found, low, high }))
}
