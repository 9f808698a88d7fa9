//! `pyrophone flux-merge`: one signal from the parts that were measured apart.

use pyrophone_flame::flux::{Flux, Partial};
use pyrophone_recording::check_not_among;

use crate::args::FluxMergeArgs;
use crate::error::Error;
use crate::flux::sound::{self, Signal};
use crate::input::text;
use crate::progress::Work;
use crate::summary::Done;

/// Writes what one run over all frames would have written, bit for bit.
pub fn run(args: &FluxMergeArgs, work: &Work) -> Result<Done, Error> {
    sound::check(&args.sound, args.timeline.rate, &[])?;
    let shards: Vec<_> = args.shards.iter().map(|path| path.as_path()).collect();
    for output in sound::files(&args.sound) {
        check_not_among(output, &shards)?;
    }
    let mut parts = vec![];
    for path in shards {
        let name = path.display().to_string();
        parts.push((name.clone(), Partial::read(&text(path)?, &name)?));
        work.check()?;
    }
    let merged = Partial::merge(&parts)?;
    let flux = Flux::from_steps(&merged.steps)?;
    sound::note_interpolated(&flux.interpolated);
    let rate_hz = sound::known_rate(&args.sound, args.timeline.rate, shards_name(&args.shards))?;
    let signal = Signal::of_flux(&flux, rate_hz).on_timeline(args.timeline.start_frame);
    let facts =
        vec![("Measured with".into(), merged.settings), ("Merged from".into(), format!("{} parts", parts.len()))];
    sound::write(&args.sound, &signal, Some(&flux), facts, vec![], work)
}

/// The first part, by which the whole is named.
fn shards_name(shards: &[std::path::PathBuf]) -> &std::path::Path {
    shards.first().map_or(std::path::Path::new("the parts"), |path| path.as_path())
}
