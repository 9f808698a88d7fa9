//! A drive and a track of positions for each flame of a simulation.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

use pyrophone_flame::clusters::{Birth, Death, Point, Track, Tracker, series};
use pyrophone_flame::flux::{Flux, FluxShard, Row, Steps};
use pyrophone_flame::pressure;
use pyrophone_flame::upsample::{Method, Upsampler};
use pyrophone_recording::{Broadcast, write_file};
use rayon::prelude::*;

use super::ambisonic::{Listener, Place};
use super::measuring::Plan;
use super::signal::Signal;
use super::{scale, sound};
use crate::args::{FluxArgs, Measure, SoundKind};
use crate::error::Error;
use crate::output::{self, make_folder};
use crate::progress::{Work, note};

/// Time over which flux passes from one track to another when a front splits or merges, in seconds: three periods of
/// the pressure's high-pass.
const HANDOVER_S: f64 = 0.1;

/// Frames per thread whose clusters are found before they are followed.
const PORTION: usize = 4;

/// One track, or all tracks without a separate drive.
struct Group {
    /// Base name of its files.
    name: String,
    /// Its tracks.
    tracks: Vec<usize>,
}

/// Rejects options that do not work flame by flame.
pub fn check(args: &FluxArgs) -> Result<(), Error> {
    if args.clusters.folder.is_none() {
        return Ok(());
    }
    let conflicts = [
        (args.measure != Measure::Flux, "only --measure flux has a front that separates flames"),
        (
            args.sound.kind == SoundKind::Envelope,
            "the flames' envelopes do not add up to that of the whole; leave out --as",
        ),
        (args.timeline.retime.is_some(), "positions are not retimed; leave out --retime, and retime the written files"),
    ];
    let found = conflicts.into_iter().find(|(is_given, _)| *is_given);
    found.map_or(Ok(()), |(_, why)| Err(Error::Conflict(format!("--per-cluster: {why}"))))
}

/// Writes the folder and returns its files. `signal` is that of the whole flame, before upsampling.
pub fn write(
    folder: &Path,
    args: &FluxArgs,
    plan: &Plan,
    part: &FluxShard,
    signal: &Signal,
    work: &Work,
) -> Result<Vec<PathBuf>, Error> {
    let tracks = tracks(plan, part, work)?;
    let groups = groups(&tracks, args.clusters.count);
    let handover = (HANDOVER_S * signal.rate_hz).round() as u64;
    let fluxes = series(&tracks, handover);
    let upsampled = |signal: Signal| match &plan.upsampler {
        Some(upsampler) => signal.upsampled(upsampler, &part.changes),
        None => signal,
    };
    let whole = upsampled(signal.clone());
    let options = sound::options(&args.sound, whole.rate_hz);
    let rendered = pressure::render(&whole.flux, &pressure::Options { scale: scale::kept(&args.sound)?, ..options })?;
    scale::keep(&args.sound, rendered.scale)?;
    let added = added(signal, &whole, plan.upsampler.as_ref())?;
    let shares = shares(&groups, &tracks, signal, whole.substeps);
    let reference_samples = sound::time_reference(&args.sound, signal)?;
    let mut listener = args.clusters.listener.map(|position| {
        let samples = rendered.samples.len();
        Listener::new(position, middle(&tracks), args.up, samples, args.sound.sample_rate)
    });
    make_folder(folder)?;
    let broadcast = |name: &str| Broadcast {
        description: format!("Flame signal of {name}, {} steps per second", whole.rate_hz),
        time_reference_samples: reference_samples,
        ..Broadcast::default()
    };
    let mut files = vec![folder.join("clusters.csv")];
    write_file(&files[0], |file| write_list(file, &groups, &tracks, signal))?;
    for (group, share) in groups.iter().zip(&shares) {
        work.check()?;
        let steps = steps(group, &fluxes, &tracks, part);
        let own = Signal { flux: Flux::from_steps(&steps)?.values(), ..signal.clone() };
        let smooth = match &plan.upsampler {
            Some(upsampler) => own.upsampled(&cubic(upsampler)?, &part.changes),
            None => own,
        };
        let flux: Vec<f64> = smooth.flux.iter().zip(&added).zip(share).map(|((x, added), w)| x + w * added).collect();
        let samples = pressure::render(&flux, &pressure::Options { scale: Some(rendered.scale), ..options })?.samples;
        if let Some(listener) = &mut listener {
            listener.add(&samples, &places(group, &tracks, signal));
        }
        let broadcast = broadcast(&group.name);
        let [wav, csv] = ["wav", "csv"].map(|extension| folder.join(format!("{}.{extension}", group.name)));
        output::write_signal(&wav, vec![samples], args.sound.sample_rate, Some(&broadcast))?;
        write_file(&csv, |file| write_track(file, group, &tracks, signal))?;
        files.extend([wav, csv]);
    }
    if let Some(listener) = listener {
        let wav = folder.join("ambisonic.wav");
        let broadcast = broadcast("all flames, AmbiX of first order");
        output::write_signal(&wav, listener.into_channels(), args.sound.sample_rate, Some(&broadcast))?;
        files.push(wav);
    }
    note_tracks(&groups, &tracks);
    Ok(files)
}

/// The clusters of all fronts, followed from step to step.
fn tracks(plan: &Plan, part: &FluxShard, work: &Work) -> Result<Vec<Track>, Error> {
    let stage = work.stage("following flames");
    let measured = |index: &&usize| {
        let step = plan.sequence.numbers().nth(**index);
        step.is_some_and(|step| part.steps.get(&step).is_some_and(Option::is_some))
    };
    let indices: Vec<usize> = plan.indices.iter().filter(measured).copied().collect();
    let mut tracker = Tracker::default();
    let mut done = 0;
    for portion in indices.chunks(PORTION * rayon::current_num_threads()) {
        let found: Vec<Result<_, Error>> = portion
            .par_iter()
            .map(|index| {
                work.check()?;
                let frame = plan.read_front(*index)?;
                let clusters = plan.front.clusters(&frame).map_err(|source| plan.of_frame(*index, source))?;
                Ok((frame.number, clusters))
            })
            .collect();
        for clusters in found {
            let (step, clusters) = clusters?;
            tracker.add(step, clusters);
        }
        done += portion.len();
        stage.report(done as f32 / indices.len() as f32);
    }
    Ok(tracker.finish())
}

/// The loudest tracks, one group each, in the order of their first steps; then one group of all others.
fn groups(tracks: &[Track], most: usize) -> Vec<Group> {
    let mut order: Vec<usize> = (0..tracks.len()).collect();
    order.sort_by(|a, b| tracks[*b].variation().total_cmp(&tracks[*a].variation()));
    let (own, rest) = order.split_at(most.min(order.len()));
    let mut own = own.to_vec();
    own.sort_unstable();
    let single = |(n, track): (usize, &usize)| Group { name: format!("cluster_{:03}", n + 1), tracks: vec![*track] };
    let mut groups: Vec<Group> = own.iter().enumerate().map(single).collect();
    if !rest.is_empty() {
        groups.push(Group { name: "cluster_rest".into(), tracks: rest.to_vec() });
    }
    groups
}

/// Flux of a group at each measured step.
fn steps(group: &Group, fluxes: &[BTreeMap<i64, f64>], tracks: &[Track], part: &FluxShard) -> Steps {
    let row = |frame: i64| {
        let flux = group.tracks.iter().filter_map(|track| fluxes.get(*track)?.get(&frame)).sum();
        let area = point(group, tracks, frame).map_or(0.0, |point| point.area);
        Row { frame, flux, area, mean_curvature: None }
    };
    part.steps.iter().map(|(frame, whole)| (*frame, whole.is_some().then(|| row(*frame)))).collect()
}

/// Sums over a group at a step, with the mean position weighted by area; none if none of it burns.
fn point(group: &Group, tracks: &[Track], step: i64) -> Option<Point> {
    let points = || group.tracks.iter().filter_map(|track| tracks.get(*track)?.points.get(&step));
    let area: f64 = points().map(|point| point.area).sum();
    let mean = |axis: usize| points().map(|point| point.area * point.centroid[axis]).sum::<f64>() / area;
    let flux = points().map(|point| point.flux).sum();
    (area > 0.0).then(|| Point { flux, area, centroid: std::array::from_fn(mean) })
}

/// An upsampler that draws only the smooth curve.
fn cubic(upsampler: &Upsampler) -> Result<Upsampler, Error> {
    Ok(Upsampler::new(Method::Cubic, upsampler.substeps(), upsampler.seed())?)
}

/// The difference between upsampling and the smooth curve, for the whole flame.
fn added(measured: &Signal, whole: &Signal, upsampler: Option<&Upsampler>) -> Result<Vec<f64>, Error> {
    let Some(upsampler) = upsampler else { return Ok(vec![0.0; whole.flux.len()]) };
    let smooth = cubic(upsampler)?.series(&measured.flux, measured.first_frame, &BTreeMap::new());
    Ok(whole.flux.iter().zip(smooth).map(|(whole, smooth)| whole - smooth).collect())
}

/// Each group's share of that difference, which is only known for the whole flame: its share of the area. If nothing
/// burns, the first group gets all of it, so that the shares always add up to 1.
fn shares(groups: &[Group], tracks: &[Track], signal: &Signal, substeps: usize) -> Vec<Vec<f64>> {
    let count = signal.flux.len();
    let area = |group: &Group, n: usize| {
        let step = signal.first_frame.saturating_add(n.min(count.saturating_sub(1)) as i64);
        point(group, tracks, step).map_or(0.0, |point| point.area)
    };
    let areas: Vec<Vec<f64>> = groups.iter().map(|group| (0..=count).map(|n| area(group, n)).collect()).collect();
    let at = |areas: &[f64], step: usize| {
        let (n, share) = (step / substeps, (step % substeps) as f64 / substeps as f64);
        areas[n] * (1.0 - share) + areas[n + 1] * share
    };
    let sums: Vec<f64> = (0..count * substeps).map(|step| areas.iter().map(|areas| at(areas, step)).sum()).collect();
    let share = |(n, areas): (usize, &Vec<f64>)| {
        let of_sum = |(step, sum): (usize, &f64)| match *sum {
            sum if sum > 0.0 => at(areas, step) / sum,
            _ => f64::from(u8::from(n == 0)),
        };
        sums.iter().enumerate().map(of_sum).collect()
    };
    areas.iter().enumerate().map(share).collect()
}

/// Seconds from the first sample to a step.
fn time_s(signal: &Signal, step: i64) -> f64 {
    step.saturating_sub(signal.first_frame) as f64 / signal.rate_hz
}

/// Positions of a group over time.
fn places(group: &Group, tracks: &[Track], signal: &Signal) -> Vec<Place> {
    let steps = (0..signal.flux.len()).map(|n| signal.first_frame.saturating_add(n as i64));
    steps.filter_map(|step| Some((time_s(signal, step), point(group, tracks, step)?.centroid))).collect()
}

/// Mean position of all flames over all steps, weighted by area.
fn middle(tracks: &[Track]) -> [f64; 3] {
    let points = || tracks.iter().flat_map(|track| track.points.values());
    let area: f64 = points().map(|point| point.area).sum();
    std::array::from_fn(|axis| points().map(|point| point.area * point.centroid[axis]).sum::<f64>() / area.max(1e-30))
}

/// Writes a table of a group's positions.
fn write_track(to: &mut impl Write, group: &Group, tracks: &[Track], signal: &Signal) -> std::io::Result<()> {
    let mut to = std::io::BufWriter::new(to);
    writeln!(to, "time_s,x_m,y_m,z_m,area_m2,flux_m3_per_s")?;
    for n in 0..signal.flux.len() {
        let step = signal.first_frame.saturating_add(n as i64);
        let Some(Point { flux, area, centroid: [x, y, z] }) = point(group, tracks, step) else { continue };
        writeln!(to, "{:.9},{x:.6},{y:.6},{z:.6},{area:?},{flux:?}", time_s(signal, step))?;
    }
    to.flush()
}

/// Writes a table of all groups: when each begins and ends, and why.
fn write_list(to: &mut impl Write, groups: &[Group], tracks: &[Track], signal: &Signal) -> std::io::Result<()> {
    writeln!(to, "cluster,start_s,end_s,birth,birth_from,death,death_into,tracks")?;
    let name_of = |track: usize| {
        let group = groups.iter().find(|group| group.tracks.contains(&track));
        group.map_or("", |group| group.name.as_str())
    };
    for group in groups {
        let own = || group.tracks.iter().filter_map(|track| tracks.get(*track));
        let (start, end) = (
            own().filter_map(|track| track.points.keys().next()).min(),
            own().filter_map(|track| track.points.keys().next_back()).max(),
        );
        let (birth, death) = match (own().next(), group.tracks.len()) {
            (Some(track), 1) => (born(track.birth), died(track.death)),
            _ => (("", None), ("", None)),
        };
        let [from, into] = [birth.1, death.1].map(|track| track.map_or("", name_of));
        let seconds = |step: Option<&i64>| step.map_or(0.0, |step| time_s(signal, *step));
        let (start_s, end_s, count) = (seconds(start), seconds(end), group.tracks.len());
        writeln!(to, "{},{start_s:.6},{end_s:.6},{},{from},{},{into},{count}", group.name, birth.0, death.0)?;
    }
    Ok(())
}

fn born(birth: Birth) -> (&'static str, Option<usize>) {
    match birth {
        Birth::Start => ("start", None),
        Birth::Ignited => ("ignited", None),
        Birth::Split(from) => ("split", Some(from)),
    }
}

fn died(death: Death) -> (&'static str, Option<usize>) {
    match death {
        Death::End => ("end", None),
        Death::Extinguished => ("extinguished", None),
        Death::Merged(into) => ("merged", Some(into)),
    }
}

/// Notes the number of flames and what became of them.
fn note_tracks(groups: &[Group], tracks: &[Track]) {
    let births = |is: fn(&Birth) -> bool| tracks.iter().filter(|track| is(&track.birth)).count();
    let deaths = |is: fn(&Death) -> bool| tracks.iter().filter(|track| is(&track.death)).count();
    let (ignited, split) = (births(|b| *b == Birth::Ignited), births(|b| matches!(b, Birth::Split(_))));
    let (ended, merged) = (deaths(|d| *d == Death::Extinguished), deaths(|d| matches!(d, Death::Merged(_))));
    let rest = groups.iter().find(|group| group.tracks.len() > 1).map_or(0, |group| group.tracks.len());
    let rest = if rest > 0 { format!("; the {rest} quietest share one drive (--clusters)") } else { String::new() };
    note(&format!(
        "{} flames: {ignited} ignited later, {split} split off others, {ended} went out, {merged} joined others{rest}",
        tracks.len()
    ));
}
