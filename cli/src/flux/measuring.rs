//! Measurement of a simulation's frames, several at a time.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Row, Steps};
use pyrophone_flame::front::Front;
use pyrophone_flame::import::{PlacementChoice, Selection, Sequence};
use pyrophone_flame::upsample::{Upsampler, VoxelSources};
use pyrophone_flame::{Error as FlameError, Frame};
use pyrophone_recording::write_file;
use rayon::prelude::*;

use super::cache;
use super::kept::FluxCheckpoint;
use super::sight::Sight;
use crate::args::{FluxArgs, Measure, MeshKind, Placement};
use crate::error::Error;
use crate::frame_list::FrameList;
use crate::output::make_folder;
use crate::progress::{Work, note};

/// Relative tolerance between a given rate and the frames' own.
const SAME_RATE: f64 = 0.01;

/// Frames per thread that are measured before the checkpoint is written.
const PORTION: usize = 4;

/// Frames after a part that the change from its last frame depends on.
const AHEAD: usize = 2;

/// A plan of a measurement: which frames, and how.
pub struct Plan {
    /// The frames on disk.
    pub sequence: Sequence,
    /// The grids to read.
    pub selection: Selection,
    /// The flame front to measure.
    pub front: Front,
    /// Requested frames, as indices into the sequence.
    pub indices: Vec<usize>,
    /// Frames of all parts together, for a part that needs them.
    pub whole: Option<Whole>,
    /// The steps of the sequence's frames, ascending.
    numbers: Vec<i64>,
    /// Requested steps that have no file.
    missing: Vec<i64>,
    /// Facts from the first good frame; none without a good frame.
    pub sight: Option<Sight>,
    /// Everything that the results depend on, apart from the files.
    pub settings: String,
    measure: Measure,
    /// Source of the change from each step to the next, if upsampling is requested.
    pub upsampler: Option<Upsampler>,
    skip_bad: bool,
    /// Folder for fronts, stride in steps, and first step.
    mesh: Option<(PathBuf, u64, i64)>,
    mesh_kind: MeshKind,
}

/// Frames that belong together: those of one run or of all parts.
#[derive(Debug, Clone)]
pub struct Whole {
    /// Indices into the sequence, ascending.
    pub indices: Vec<usize>,
    /// Steps that these frames span.
    pub span: Span,
}

/// Range of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Span {
    /// First step, with or without a file.
    pub first: i64,
    /// Last step, with or without a file.
    pub last: i64,
    /// First step that has a file.
    pub first_file: i64,
}

/// Results of one step.
struct Measured {
    row: Row,
    /// Change to the next step.
    change: Option<Vec<f64>>,
}

impl Plan {
    /// Opens the frames and examines the first good one; notes anything the user may not expect.
    pub fn new(args: &FluxArgs, work: &Work) -> Result<Self, Error> {
        let sequence = Sequence::open(&args.input)?;
        note_names(&sequence);
        let numbers: Vec<i64> = sequence.numbers().collect();
        let (indices, missing) = wanted(&sequence, args.frames.as_ref());
        check_wanted(args, &sequence, &indices, &missing)?;
        let selection = selection(args);
        let look = |index: &usize| {
            work.check()?;
            Sight::of_sequence(&sequence, *index, &selection, args)
        };
        // If all are bad, the first one's reason is reported: most often a name that no frame has. A frame before
        // ignition has no field, and so nothing to report.
        let is_bad = |look: &Result<Sight, Error>| matches!(look, Err(Error::Import(_)));
        let is_unlit = |index: &usize| sequence.is_unlit(*index, &selection);
        let mut lit = indices.iter().skip_while(|index| is_unlit(index));
        let first_look = match lit.next() {
            Some(index) => look(index).map(Some),
            None => Ok(None),
        };
        let is_first_bad = matches!(&first_look, Err(Error::Import(_)));
        let sight = match first_look {
            Err(error) if is_first_bad && args.skip_bad => match lit.map(look).find(|look| !is_bad(look)) {
                Some(look) => Some(look?),
                // A farm's shard without one good frame writes an empty part.
                None if args.partial.is_some() => None,
                None => return Err(error),
            },
            look => look?,
        };
        if sight.is_none() && args.partial.is_none() && !indices.is_empty() && !args.skip_bad {
            note("nothing burns in any frame");
        }
        let mesh =
            args.mesh.clone().map(|folder| (folder, args.mesh_every, indices.first().map_or(0, |i| numbers[*i])));
        let whole = whole(args, &sequence, &indices)?;
        // A part before ignition measures the change from its last frame to the next, and the motion of its gas: for
        // both it needs the iso value and the unit that the other parts find.
        let others: Vec<usize> = match (&sight, &whole, indices.last()) {
            (None, Some(whole), _) => whole.indices.clone(),
            (None, None, Some(last)) if args.partial.is_some() => (last + 1..sequence.len()).take(AHEAD).collect(),
            _ => vec![],
        };
        let mut lit = others.iter().skip_while(|index| sequence.is_unlit(**index, &selection));
        let seen_by_others = lit.find_map(|index| Sight::of_sequence(&sequence, *index, &selection, args).ok());
        let seen = sight.as_ref().or(seen_by_others.as_ref());
        let front = Front::new(seen.map_or(args.iso.unwrap_or(0.0), |sight| sight.iso), args.refine)?;
        let selection = super::units::scaled(selection, &sequence, seen, args)?;
        let settings = sight.as_ref().map_or(String::new(), |sight| settings(args, sight, &selection));
        Ok(Self {
            sequence,
            selection,
            front,
            indices,
            whole,
            numbers,
            missing,
            sight,
            settings,
            measure: args.measure,
            upsampler: None,
            skip_bad: args.skip_bad,
            mesh,
            mesh_kind: args.mesh_kind,
        })
    }

    /// The same plan, with the changes between steps that an upsampler needs.
    pub fn with_upsampler(mut self, upsampler: Option<Upsampler>) -> Self {
        if let (Some(upsampler), Some(_)) = (&upsampler, &self.sight) {
            self.settings += &format!(", upsample {upsampler}");
        }
        self.upsampler = upsampler;
        self
    }

    /// Measures every frame; skipped frames have no numbers. Finished frames are kept beside `output` until all are
    /// done.
    pub fn measure(&self, output: &Path, work: &Work) -> Result<FluxCheckpoint, Error> {
        if let Some((folder, ..)) = &self.mesh {
            make_folder(folder)?;
        }
        let files = cache::files_of(&self.sequence, &self.indices);
        let mut kept = FluxCheckpoint::open(output, format!("{}, files {}", self.settings, cache::identity(&files)));
        match self.resume(&mut kept, work) {
            Ok(()) => Ok(kept),
            Err(error) => Err(kept.unfinished(error)),
        }
    }

    fn resume(&self, kept: &mut FluxCheckpoint, work: &Work) -> Result<(), Error> {
        let stage = work.stage("measuring");
        let numbers: Vec<i64> = self.sequence.numbers().collect();
        let is_done = |index: &usize| {
            let number = numbers[*index];
            kept.steps.get(&number).is_some_and(Option::is_some)
                && self.mesh_path(number).is_none_or(|path| path.is_file())
                && (kept.changes.contains_key(&number) || !self.tells_change(*index))
        };
        let (done, left): (Vec<usize>, Vec<usize>) = self.indices.iter().partition(|index| is_done(index));
        let mut steps: Steps = self.missing.iter().map(|number| (*number, None)).collect();
        steps.extend(done.iter().filter_map(|index| kept.steps.get_key_value(&numbers[*index])));
        if !done.is_empty() {
            note(&format!("{} of {} frames are reused from an interrupted run", done.len(), self.indices.len()));
        }
        let total = self.indices.len().max(1) as f32;
        let finished = std::sync::atomic::AtomicUsize::new(done.len());
        // Sources of the frames that more than one change needs.
        let mut sources: BTreeMap<usize, VoxelSources> = BTreeMap::new();
        // In portions, so that what is done is kept and the first bad frame is always the same one.
        for portion in left.chunks(PORTION * rayon::current_num_threads()) {
            sources = self.sources(portion, sources, work)?;
            let results: Vec<Result<Measured, Error>> = portion
                .par_iter()
                .map(|index| {
                    work.check()?;
                    let measured = Measured { row: self.row(*index)?, change: self.change(*index, &sources) };
                    stage.report((finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1) as f32 / total);
                    Ok(measured)
                })
                .collect();
            kept.add(results.iter().flatten().map(|measured| (&measured.row, measured.change.as_deref())))?;
            for (index, result) in portion.iter().zip(results) {
                match result {
                    Ok(Measured { row, change }) => {
                        kept.changes.extend(change.map(|change| (row.frame, change)));
                        steps.insert(row.frame, Some(row));
                    }
                    Err(error @ (Error::Import(_) | Error::Frame { .. })) if self.skip_bad => {
                        note(&format!("frame {} is skipped: {error}", self.label(numbers[*index])));
                        steps.insert(numbers[*index], None);
                    }
                    Err(error) => return Err(error),
                };
            }
        }
        kept.steps = steps;
        Ok(())
    }

    /// The sources of a portion's frames and of the two frames after each, requested or not: a shard looks beyond its
    /// own frames. Unreadable frames are left out; the error is reported when the frame itself is measured.
    fn sources(
        &self,
        portion: &[usize],
        known: BTreeMap<usize, VoxelSources>,
        work: &Work,
    ) -> Result<BTreeMap<usize, VoxelSources>, Error> {
        if !self.upsampler.as_ref().is_some_and(Upsampler::needs_changes) {
            return Ok(BTreeMap::new());
        }
        let ahead =
            |index: &usize| [Some(*index), self.next(*index), self.next(*index).and_then(|next| self.next(next))];
        let needed: BTreeSet<usize> = portion.iter().flat_map(ahead).flatten().collect();
        let mut sources: BTreeMap<usize, VoxelSources> =
            known.into_iter().filter(|(index, _)| needed.contains(index)).collect();
        let new: Vec<usize> = needed.into_iter().filter(|index| !sources.contains_key(index)).collect();
        let read = |index: &usize| work.check().map(|()| self.source(*index).ok().map(|source| (*index, source)));
        let found: Result<Vec<_>, Error> = new.par_iter().map(read).collect();
        sources.extend(found?.into_iter().flatten());
        Ok(sources)
    }

    /// Change from a frame to the next, if it is needed and both can be read.
    fn change(&self, index: usize, sources: &BTreeMap<usize, VoxelSources>) -> Option<Vec<f64>> {
        let next = self.next(index)?;
        let beyond = self.next(next).and_then(|beyond| sources.get(&beyond));
        let (before, after) = (sources.get(&index)?, sources.get(&next)?);
        Some(self.upsampler.as_ref()?.change(self.sequence.numbers().nth(index)?, before, after, beyond))
    }

    /// The frame of the following step, requested or not: a shard looks one frame beyond its own.
    fn next(&self, index: usize) -> Option<usize> {
        let numbers: Vec<i64> = self.sequence.numbers().skip(index).take(2).collect();
        matches!(numbers[..], [this, next] if this.checked_add(1) == Some(next)).then_some(index + 1)
    }

    fn tells_change(&self, index: usize) -> bool {
        self.upsampler.as_ref().is_some_and(Upsampler::needs_changes) && self.next(index).is_some()
    }

    /// Volume sources of a frame.
    fn source(&self, index: usize) -> Result<VoxelSources, Error> {
        let of_frame = |source| self.of_frame(index, source);
        match self.measure {
            Measure::Flux if !self.upsampler.as_ref().is_some_and(Upsampler::takes_field_alone) => {
                VoxelSources::of_front(&self.read(index)?, self.front.iso()).map_err(of_frame)
            }
            _ if self.sequence.is_unlit(index, &self.selection) => Ok(VoxelSources::default()),
            _ => VoxelSources::of_field(&self.sequence.read_field(index, &self.selection)?).map_err(of_frame),
        }
    }

    fn row(&self, index: usize) -> Result<Row, Error> {
        if self.measure != Measure::Flux {
            return self.integral(index);
        }
        let frame = self.read(index)?;
        let measure = self.front.measure(&frame).map_err(|source| self.of_frame(index, source))?;
        if let Some(path) = self.mesh_path(frame.number) {
            let mesh = self.front.mesh(&frame.field).map_err(|source| self.of_frame(index, source))?;
            write_file(&path, |file| {
                let mut file = std::io::BufWriter::new(file);
                match self.mesh_kind {
                    MeshKind::Ply => mesh.write_ply(&mut file)?,
                    MeshKind::Obj => mesh.write_obj(&mut file)?,
                }
                std::io::Write::flush(&mut file)
            })?;
        }
        Ok(Row::new(frame.number, &measure))
    }

    /// The field's sum over the frame, or its change to the next frame; neither needs a front.
    fn integral(&self, index: usize) -> Result<Row, Error> {
        let source = self.source(index)?;
        let flux = match (self.measure, self.next(index)) {
            (Measure::Change, Some(next)) => source.difference(&self.source(next)?),
            // The last frame changes as the one before it did.
            (Measure::Change, None) if index > 0 => self.source(index - 1)?.difference(&source),
            (Measure::Change, None) => 0.0,
            _ => source.total(),
        };
        let frame = self.sequence.numbers().nth(index).unwrap_or_default();
        Ok(Row { frame, flux, area: 0.0, mean_curvature: None })
    }

    /// Frames per second: as given, otherwise as stated by the frames.
    pub fn rate_hz(&self, given_hz: Option<f64>) -> Result<Option<f64>, Error> {
        // A single frame gives no rate, but a shard of one frame has neighbours.
        let near = |index: &usize| index.saturating_sub(1)..=(index + 1).min(self.sequence.len() - 1);
        let asked =
            if self.indices.len() > 1 { self.indices.clone() } else { self.indices.iter().flat_map(near).collect() };
        let told = self.sequence.rate_hz(&asked);
        // A frame in the user's sense may be several steps, or a part of one.
        let given_hz = given_hz.map(|frames_hz| frames_hz * self.sequence.numbering().steps_per_frame());
        match (given_hz, told) {
            (Some(given_hz), Ok(Some(told_hz))) if (given_hz / told_hz - 1.0).abs() > SAME_RATE => {
                note(&format!(
                    "--rate is {given_hz}, but the frames' own times give {told_hz:.6} per second; --rate is used"
                ));
                Ok(Some(given_hz))
            }
            (Some(given_hz), _) => Ok(Some(given_hz)),
            (None, told) => Ok(told?),
        }
    }

    /// Reads a frame; a frame before ignition is empty.
    pub fn read(&self, index: usize) -> Result<Frame, Error> {
        self.sequence.read(index, &self.selection).or_else(|error| {
            if self.sequence.is_unlit(index, &self.selection) {
                let number = self.sequence.numbers().nth(index).unwrap_or_default();
                return Ok(Frame::unlit(number));
            }
            Err(error.into())
        })
    }

    /// Error with the path of the frame's file.
    pub fn of_frame(&self, index: usize, source: FlameError) -> Error {
        Error::Frame { path: self.sequence.path_of(index).display().to_string(), source: Box::new(source) }
    }

    /// First requested step, including missing ones.
    pub fn first_frame(&self) -> Option<i64> {
        span(&self.numbers, &self.indices, &self.missing).map(|span| span.first)
    }

    /// The requested frames; none if there are none.
    pub fn own(&self) -> Option<Whole> {
        let span = span(&self.numbers, &self.indices, &self.missing)?;
        Some(Whole { indices: self.indices.clone(), span })
    }

    /// The frame of a step, if it is one of the requested frames.
    pub fn index_of(&self, step: i64, among: &[usize]) -> Option<usize> {
        let index = self.numbers.binary_search(&step).ok()?;
        among.binary_search(&index).is_ok().then_some(index)
    }

    /// Number of a step in its file's name.
    pub fn label(&self, step: i64) -> String {
        self.sequence.numbering().label(step)
    }

    fn mesh_path(&self, number: i64) -> Option<PathBuf> {
        let (folder, every, first) = self.mesh.as_ref()?;
        let name = match self.sequence.numbering().is_plain() {
            true => format!("front_{number:04}.{}", self.mesh_kind.extension()),
            false => format!("front_{}.{}", self.label(number), self.mesh_kind.extension()),
        };
        number.abs_diff(*first).is_multiple_of(*every).then(|| folder.join(name))
    }
}

/// The frames and the missing steps of a list; without a list, all frames.
fn wanted(sequence: &Sequence, list: Option<&FrameList>) -> (Vec<usize>, Vec<i64>) {
    let is_wanted = |step: &i64| list.is_none_or(|list| list.holds(*step, sequence.numbering()));
    let frames = sequence.numbers().enumerate().filter(|(_, step)| is_wanted(step));
    (frames.map(|(index, _)| index).collect(), sequence.missing().into_iter().filter(is_wanted).collect())
}

/// Frames of all parts together, for a part that needs them.
fn whole(args: &FluxArgs, sequence: &Sequence, own: &[usize]) -> Result<Option<Whole>, Error> {
    if args.partial_with.is_empty() {
        return Ok(None);
    }
    let numbers: Vec<i64> = sequence.numbers().collect();
    let (indices, missing) = wanted(sequence, args.partial_of.as_ref());
    let span = span(&numbers, &indices, &missing);
    let is_outside = |index: &&usize| indices.binary_search(index).is_err();
    match (span, own.iter().find(is_outside), &args.partial_of) {
        (Some(span), None, _) => Ok(Some(Whole { indices, span })),
        (None, None, None) => Ok(None),
        (_, outside, list) => {
            let list = list.as_ref().map(ToString::to_string).unwrap_or_default();
            let which = outside.and_then(|index| numbers.get(*index)).map(|step| sequence.numbering().label(*step));
            let what = which
                .map_or("contains no frame".into(), |frame| format!("does not contain frame {frame} of this part"));
            let shown = args.input.display();
            Err(Error::Conflict(format!(
                "{shown}: --partial-of is {list}, which {what}; name the frames of all parts together"
            )))
        }
    }
}

/// First and last step, including missing steps; none without any frame.
fn span(numbers: &[i64], indices: &[usize], missing: &[i64]) -> Option<Span> {
    let step = |index: Option<&usize>| index.and_then(|index| numbers.get(*index)).copied();
    let (first_file, last_file) = (step(indices.first())?, step(indices.last())?);
    let first = missing.first().map_or(first_file, |missing| first_file.min(*missing));
    let last = missing.last().map_or(last_file, |missing| last_file.max(*missing));
    Some(Span { first, last, first_file })
}

fn selection(args: &FluxArgs) -> Selection {
    let is_usual = args.field.eq_ignore_ascii_case("flame");
    Selection {
        field: if args.measure == Measure::Divergence && is_usual { "divergence".into() } else { args.field.clone() },
        velocity: args.velocity.clone(),
        velocity_scale: 1.0,
        placement: match args.placement {
            Placement::Collocated => PlacementChoice::Collocated,
            Placement::Staggered => PlacementChoice::Staggered,
            Placement::File => PlacementChoice::FromFile,
        },
    }
}

/// Everything that the results depend on, apart from the files.
fn settings(args: &FluxArgs, sight: &Sight, selection: &Selection) -> String {
    let Sight { iso, field, velocity, .. } = sight;
    match args.measure {
        Measure::Flux => {
            let placement = format!("{:?}", args.placement).to_lowercase();
            let scale = match selection.velocity_scale {
                1.0 => String::new(),
                scale => format!(" times {scale:?}"),
            };
            let refine = args.refine;
            format!("iso {iso:?}, refine {refine}, field {field}, velocity {velocity}{scale}, placement {placement}")
        }
        measure => format!("{} of field {field}", format!("{measure:?}").to_lowercase()),
    }
}

/// Notes anything unusual about the file names.
fn note_names(sequence: &Sequence) {
    if sequence.left_out() > 0 {
        note(&format!("{} numbered files with other names are ignored", sequence.left_out()));
    }
    let numbering = sequence.numbering();
    if !numbering.is_plain() {
        let per_frame = numbering.steps_per_frame();
        note(&format!(
            "the files' numbers make {numbering}: there are {per_frame:.3} steps per frame of --rate, so frequencies up to {:.3} times --rate are valid",
            0.5 * per_frame
        ));
    }
}

/// Rejects missing frames, and a choice without any frame; only a shard may be empty.
fn check_wanted(args: &FluxArgs, sequence: &Sequence, indices: &[usize], missing: &[i64]) -> Result<(), Error> {
    let shown = args.input.display();
    if let (Some(step), false) = (missing.first(), args.skip_bad) {
        return Err(Error::Conflict(format!(
            "{shown}: frame {} is missing ({} in all); add the missing files, or interpolate them with --skip-bad",
            sequence.numbering().label(*step),
            missing.len()
        )));
    }
    let Some(list) = args.frames.as_ref().filter(|_| indices.is_empty()) else { return Ok(()) };
    let ends = [sequence.numbers().next(), sequence.numbers().last()];
    let [first, last] = ends.map(|step| sequence.numbering().label(step.unwrap_or_default()));
    let message = format!("--frames is {list}, but the frames in {shown} are {first}-{last}");
    if args.partial.is_none() {
        return Err(Error::Conflict(format!("{message}; choose from those")));
    }
    note(&format!("{message}: the part is empty"));
    Ok(())
}
