//! `pyrophone flux-merge`: one signal from the parts that were measured apart.

use std::path::PathBuf;

use pyrophone_flame::flux::{Flux, FluxShard};
use pyrophone_flame::upsample::Upsampler;
use pyrophone_recording::check_not_among;

use crate::args::FluxMergeArgs;
use crate::error::Error;
use crate::flux::signal::Signal;
use crate::flux::sound;
use crate::input::text;
use crate::progress::Work;
use crate::summary::Done;

/// Writes what one run over all frames would have written, bit for bit.
pub fn run(args: &FluxMergeArgs, work: &Work) -> Result<Done, Error> {
    sound::check(&args.sound, args.timeline.rate, &[])?;
    let shards = shards(&args.shards)?;
    let shards: Vec<_> = shards.iter().map(|path| path.as_path()).collect();
    for output in sound::files(&args.sound) {
        check_not_among(output, &shards)?;
    }
    let mut parts = vec![];
    for path in shards {
        let name = path.display().to_string();
        parts.push((name.clone(), FluxShard::read(&text(path)?, &name)?));
        work.check()?;
    }
    let merged = FluxShard::merge(&parts)?;
    let flux = Flux::from_steps(&merged.steps)?;
    sound::note_interpolated(&flux.interpolated, &merged.numbering);
    let given_hz = args.timeline.rate.map(|frames_hz| frames_hz * merged.numbering.steps_per_frame());
    let rate_hz = given_hz.or(merged.rate_hz);
    sound::known_rate(&args.sound, rate_hz, shards_name(&args.shards))?;
    let signal = Signal::of_flux(&flux, rate_hz).counted(merged.numbering).on_timeline(&args.timeline);
    let signal = match Upsampler::of_settings(&merged.settings) {
        Some(upsampler) => signal.upsampled(&upsampler, &merged.changes),
        None => signal,
    };
    let signal = signal.retimed()?;
    let facts =
        vec![("Measured with".into(), merged.settings), ("Merged from".into(), format!("{} parts", parts.len()))];
    sound::write(&args.sound, &signal, Some(&flux), facts, vec![], work)
}

/// The parts, those in folders in the order of their names.
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
            let message = format!(
                "{}: no parts here; name a folder in which flux --partial has written .csv files",
                path.display()
            );
            return Err(Error::Conflict(message));
        }
        found.sort_unstable();
        shards.append(&mut found);
    }
    Ok(shards)
}

/// The first part, by which the whole is named.
fn shards_name(shards: &[PathBuf]) -> &std::path::Path {
    shards.first().map_or(std::path::Path::new("the parts"), |path| path.as_path())
}
