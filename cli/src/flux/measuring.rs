//! Measurement of a simulation's frames, several at a time.

mod steps;
mod wanted;

use std::path::PathBuf;

use pyrophone_flame::front::{Front, Refinement};
use pyrophone_flame::import::{Error as ImportError, PlacementChoice, Selection, Sequence};
use pyrophone_flame::upsample::Upsampler;
use pyrophone_flame::{Error as FlameError, Frame};

pub use wanted::{Span, Whole};
use wanted::{check_wanted, span, wanted, whole};

use super::sight::Sight;
use crate::args::{FluxArgs, Measure, MeshKind, Placement};
use crate::error::Error;
use crate::progress::{Work, note};

/// Relative tolerance between a given rate and the frames' own.
const SAME_RATE: f64 = 0.01;

/// Subdivision if each cluster is measured.
const PER_CLUSTER: usize = 3;

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

impl Plan {
    /// Opens the frames and examines the first good one; notes anything the user may not expect.
    pub fn new(args: &FluxArgs, work: &Work) -> Result<Self, Error> {
        let sequence = Sequence::open(&args.input)?;
        note_names(&sequence);
        let numbers: Vec<i64> = sequence.numbers().collect();
        let (indices, missing) = wanted(&sequence, args.frames.as_ref());
        check_wanted(args, &sequence, &indices, &missing)?;
        let selection = selection(args);
        let sight = Sight::of_first(&sequence, &indices, &selection, args, work)?;
        if sight.is_none() && args.partial.file.is_none() && !indices.is_empty() && !args.skip_bad {
            note("nothing burns in any frame");
        }
        let first_step = indices.first().map_or(0, |index| numbers[*index]);
        let mesh = args.mesh.folder.clone().map(|folder| (folder, args.mesh.every, first_step));
        let whole = whole(args, &sequence, &indices)?;
        // A part before ignition measures the change from its last frame to the next, and the motion of its gas: for
        // both it needs the iso value and the unit that the other parts find.
        let others: Vec<usize> = match (&sight, &whole, indices.last()) {
            (None, Some(whole), _) => whole.indices.clone(),
            (None, None, Some(last)) if args.partial.file.is_some() => (last + 1..sequence.len()).take(AHEAD).collect(),
            _ => vec![],
        };
        let seen_by_others = Sight::of_any(&sequence, &others, &selection, args);
        let seen = sight.as_ref().or(seen_by_others.as_ref());
        let front = Front::new(seen.map_or(args.iso.unwrap_or(0.0), |sight| sight.iso), refinement(args))?;
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
            mesh_kind: args.mesh.kind,
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

    /// Frames per second: as given, otherwise as stated by the frames.
    pub fn rate_hz(&self, given_hz: Option<f64>) -> Result<Option<f64>, Error> {
        // A single frame gives no rate, but a shard of one frame has neighbours.
        let near = |index: &usize| index.saturating_sub(1)..=(index + 1).min(self.sequence.len() - 1);
        let requested =
            if self.indices.len() > 1 { self.indices.clone() } else { self.indices.iter().flat_map(near).collect() };
        let stated = self.sequence.rate_hz(&requested);
        // A frame in the user's sense may be several steps, or a part of one.
        let given_hz = given_hz.map(|frames_hz| frames_hz * self.sequence.numbering().steps_per_frame());
        match (given_hz, stated) {
            (Some(given_hz), Ok(Some(stated_hz))) if (given_hz / stated_hz - 1.0).abs() > SAME_RATE => {
                note(&format!(
                    "--rate is {given_hz}, but the frames' own times give {stated_hz:.6} per second; --rate is used"
                ));
                Ok(Some(given_hz))
            }
            (Some(given_hz), _) => Ok(Some(given_hz)),
            (None, stated) => Ok(stated?),
        }
    }

    /// Reads a frame; a frame before ignition is empty.
    pub fn read(&self, index: usize) -> Result<Frame, Error> {
        self.lit(index, self.sequence.read(index, &self.selection))
    }

    /// Reads what the flux of a frame depends on; a frame before ignition is empty.
    pub fn read_front(&self, index: usize) -> Result<Frame, Error> {
        self.lit(index, self.sequence.read_front(index, &self.selection, &self.front))
    }

    /// What was read of a frame, or an empty frame before ignition.
    fn lit(&self, index: usize, read: Result<Frame, ImportError>) -> Result<Frame, Error> {
        read.or_else(|error| {
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
}

fn selection(args: &FluxArgs) -> Selection {
    let is_usual = args.field.eq_ignore_ascii_case("flame");
    Selection {
        field: if args.measure == Measure::Divergence && is_usual { "divergence".into() } else { args.field.clone() },
        velocity: args.velocity.grid.clone(),
        velocity_scale: 1.0,
        placement: match args.velocity.placement {
            Placement::Collocated => PlacementChoice::Collocated,
            Placement::Staggered => PlacementChoice::Staggered,
            Placement::File => PlacementChoice::FromFile,
        },
    }
}

/// The front's subdivision. Clusters must add up to the whole, and their sizes differ, so theirs is fixed.
fn refinement(args: &FluxArgs) -> Refinement {
    match args.refine {
        None if args.clusters.folder.is_some() => Refinement::Fixed(PER_CLUSTER),
        given => given.into(),
    }
}

/// Everything that the results depend on, apart from the files.
fn settings(args: &FluxArgs, sight: &Sight, selection: &Selection) -> String {
    let Sight { iso, field, velocity, .. } = sight;
    match args.measure {
        Measure::Flux => {
            let placement = format!("{:?}", args.velocity.placement).to_lowercase();
            let scale = match selection.velocity_scale {
                1.0 => String::new(),
                scale => format!(" times {scale:?}"),
            };
            let refine = refinement(args);
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
