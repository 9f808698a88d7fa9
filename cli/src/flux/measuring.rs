//! Measuring the frames of a simulation, several at a time.

use std::path::{Path, PathBuf};
use std::time::UNIX_EPOCH;

use pyrophone_flame::flux::{Row, Steps};
use pyrophone_flame::front::Front;
use pyrophone_flame::import::{PlacementChoice, Selection, Sequence};
use pyrophone_flame::{Error as FlameError, Frame};
use pyrophone_recording::{content_hash, write_file};
use rayon::prelude::*;

use super::kept::Kept;
use crate::args::{FluxArgs, MeshKind, Placement};
use crate::error::Error;
use crate::progress::{Work, note};

/// How much voxels may differ between frames, as a part of their edge: rounding.
const SAME_VOXEL: f64 = 1e-5;

/// How much a given rate may differ from the frames' own, as a part of it.
const SAME_RATE: f64 = 0.01;

/// Iso value of a field of 0 to 1.
const ISO: f64 = 0.5;

/// What is to be measured, and how.
pub struct Plan {
    /// The frames on disk.
    pub sequence: Sequence,
    /// The grids.
    pub selection: Selection,
    /// The surface.
    pub front: Front,
    /// Frames of the sequence that are asked for, counted from 0.
    pub indices: Vec<usize>,
    /// Numbers among those asked for that have no file.
    missing: Vec<i64>,
    /// Every frame's voxels have these edges.
    voxel_edges: [f64; 3],
    /// All that the numbers depend on, but for the files.
    pub settings: String,
    skip_bad: bool,
    /// Where fronts are written: of every so many frames one, from this number on.
    mesh: Option<(PathBuf, u64, i64)>,
    mesh_kind: MeshKind,
}

impl Plan {
    /// Opens the frames and looks at the first good one; says what the user may want otherwise.
    pub fn new(args: &FluxArgs, work: &Work) -> Result<Self, Error> {
        let sequence = Sequence::open(&args.input)?;
        if sequence.left_out() > 0 {
            note(&format!("{} numbered files of other sorts are left out", sequence.left_out()));
        }
        let numbers: Vec<i64> = sequence.numbers().collect();
        let (first, last) = wanted(args, &numbers)?;
        let is_wanted = |number: &i64| (first..=last).contains(number);
        let indices: Vec<usize> = (0..numbers.len()).filter(|index| is_wanted(&numbers[*index])).collect();
        let missing: Vec<i64> = sequence.missing().into_iter().filter(is_wanted).collect();
        if let (Some(frame), false) = (missing.first(), args.skip_bad) {
            return Err(Error::Conflict(format!(
                "{}: frame {frame} is missing ({} in all); add --skip-bad to interpolate, or the missing files",
                args.input.display(),
                missing.len()
            )));
        }
        let selection = Selection {
            field: args.field.clone(),
            velocity: args.velocity.clone(),
            placement: match args.placement {
                Placement::Collocated => PlacementChoice::Collocated,
                Placement::Staggered => PlacementChoice::Staggered,
                Placement::File => PlacementChoice::FromFile,
            },
        };
        let look = |index: &usize| {
            work.check()?;
            look_at(&sequence, *index, &selection, args)
        };
        // Where all are bad the first one's reason is told: most often a name that no frame has.
        let is_bad = |look: &Result<Sight, Error>| matches!(look, Err(Error::Import(_)));
        let first_look = indices.first().map_or(Err(FlameError::NoFrames.into()), look);
        let good = match first_look {
            bad if is_bad(&bad) && args.skip_bad => {
                indices.iter().skip(1).map(look).find(|look| !is_bad(look)).unwrap_or(bad)
            }
            look => look,
        };
        let Sight { iso, voxel_edges, field, velocity } = good?;
        let front = Front::new(iso, args.refine)?;
        let placement = format!("{:?}", args.placement).to_lowercase();
        let voxel = voxel_edges.map(shortly).join(" x ");
        let settings = format!(
            "iso {iso:?}, refine {}, field {field}, velocity {velocity}, placement {placement}, voxel {voxel}",
            args.refine
        );
        let mesh = args.mesh.clone().map(|folder| (folder, args.mesh_every, first));
        Ok(Self {
            sequence,
            selection,
            front,
            indices,
            missing,
            voxel_edges,
            settings,
            skip_bad: args.skip_bad,
            mesh,
            mesh_kind: args.mesh_kind,
        })
    }

    /// Every frame's numbers; none for those skipped. What is done is kept beside `output` until all is.
    pub fn measure(&self, output: &Path, work: &Work) -> Result<(Steps, Kept), Error> {
        if let Some((folder, ..)) = &self.mesh {
            make_folder(folder)?;
        }
        let mut kept = Kept::open(output, format!("{}, files {}", self.settings, self.files()));
        match self.go_on(&mut kept, work) {
            Ok(steps) => Ok((steps, kept)),
            Err(error) => Err(kept.unfinished(error)),
        }
    }

    fn go_on(&self, kept: &mut Kept, work: &Work) -> Result<Steps, Error> {
        let stage = work.stage("measuring");
        let numbers: Vec<i64> = self.sequence.numbers().collect();
        let is_done = |index: &usize| {
            let number = numbers[*index];
            kept.steps.get(&number).is_some_and(Option::is_some)
                && self.mesh_path(number).is_none_or(|path| path.is_file())
        };
        let (done, left): (Vec<usize>, Vec<usize>) = self.indices.iter().partition(|index| is_done(index));
        let mut steps: Steps = self.missing.iter().map(|number| (*number, None)).collect();
        steps.extend(done.iter().filter_map(|index| kept.steps.get_key_value(&numbers[*index])));
        if !done.is_empty() {
            note(&format!("{} of {} frames were done by the run before", done.len(), self.indices.len()));
        }
        let total = self.indices.len().max(1) as f32;
        let finished = std::sync::atomic::AtomicUsize::new(done.len());
        // In portions, so that what is done is kept and the first bad frame is always the same one.
        for portion in left.chunks(4 * rayon::current_num_threads()) {
            let results: Vec<Result<Row, Error>> = portion
                .par_iter()
                .map(|index| {
                    work.check()?;
                    let row = self.row(*index);
                    stage.at((finished.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1) as f32 / total);
                    row
                })
                .collect();
            kept.add(results.iter().flatten())?;
            for (index, result) in portion.iter().zip(results) {
                match result {
                    Ok(row) => steps.insert(row.frame, Some(row)),
                    Err(error @ (Error::Import(_) | Error::Frame { .. })) if self.skip_bad => {
                        note(&format!("frame {} is skipped: {error}", numbers[*index]));
                        steps.insert(numbers[*index], None)
                    }
                    Err(error) => return Err(error),
                };
            }
        }
        Ok(steps)
    }

    fn row(&self, index: usize) -> Result<Row, Error> {
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

    /// Frames per second: as given, else as the frames say.
    pub fn rate_hz(&self, given_hz: Option<f64>) -> Result<Option<f64>, Error> {
        let told = self.sequence.rate_hz(&self.indices);
        match (given_hz, told) {
            (Some(given_hz), Ok(Some(told_hz))) if (given_hz / told_hz - 1.0).abs() > SAME_RATE => {
                note(&format!(
                    "--rate is {given_hz}, but the frames' own times say {told_hz:.6} per second; --rate is used"
                ));
                Ok(Some(given_hz))
            }
            (Some(given_hz), _) => Ok(Some(given_hz)),
            (None, told) => Ok(told?),
        }
    }

    /// Reads a frame, whose voxels must be as large as the first one's.
    pub fn read(&self, index: usize) -> Result<Frame, Error> {
        let frame = self.sequence.read(index, &self.selection)?;
        let edges = frame.field.transform().voxel_edges();
        let is_same = |(found, expected): (&f64, &f64)| (found / expected - 1.0).abs() <= SAME_VOXEL;
        if edges.iter().zip(&self.voxel_edges).all(is_same) {
            return Ok(frame);
        }
        Err(Error::Conflict(format!(
            "{}: the voxels of frame {} measure {edges:?}, those of the first frame {:?}; all frames must have one voxel size",
            self.sequence.path_of(index).display(),
            frame.number,
            self.voxel_edges
        )))
    }

    fn of_frame(&self, index: usize, source: FlameError) -> Error {
        Error::Frame { path: self.sequence.path_of(index).display().to_string(), source: Box::new(source) }
    }

    /// Number of the first frame that is asked for, missing ones included.
    pub fn first_frame(&self) -> Option<i64> {
        let found = self.indices.first().and_then(|index| self.sequence.numbers().nth(*index));
        found.into_iter().chain(self.missing.iter().copied()).min()
    }

    /// Number of the last frame that is asked for, missing ones included.
    pub fn last_frame(&self) -> Option<i64> {
        let found = self.indices.last().and_then(|index| self.sequence.numbers().nth(*index));
        found.into_iter().chain(self.missing.iter().copied()).max()
    }

    /// All files of the simulation, whether or not they are asked for.
    pub fn simulation_files(&self) -> Vec<PathBuf> {
        let mut files: Vec<PathBuf> =
            (0..self.sequence.len()).map(|index| self.sequence.path_of(index).into()).collect();
        files.extend(files.first().map(|path| arrays_beside(path)).unwrap_or_default());
        files
    }

    fn mesh_path(&self, number: i64) -> Option<PathBuf> {
        let (folder, every, first) = self.mesh.as_ref()?;
        let name = format!("front_{number:04}.{}", self.mesh_kind.extension());
        number.abs_diff(*first).is_multiple_of(*every).then(|| folder.join(name))
    }

    /// A number for the files as they are now: names, sizes and times of change.
    fn files(&self) -> String {
        let mut paths: Vec<PathBuf> = self.indices.iter().map(|index| self.sequence.path_of(*index).into()).collect();
        let arrays = paths.first().map(|path| arrays_beside(path)).unwrap_or_default();
        if !arrays.is_empty() {
            paths = arrays;
        }
        let mut list = String::new();
        for path in paths {
            let metadata = path.metadata();
            let size = metadata.as_ref().map_or(0, std::fs::Metadata::len);
            let time = metadata.and_then(|metadata| metadata.modified()).ok();
            let time_ns = time.and_then(|time| time.duration_since(UNIX_EPOCH).ok()).map_or(0, |time| time.as_nanos());
            list += &format!("{} {size} {time_ns}\n", path.display());
        }
        content_hash(list.as_bytes()).chars().take(16).collect()
    }
}

/// All arrays in the folder of one, in order: a frame of arrays has several files, of which a sequence names the first.
/// None where `path` is no array.
fn arrays_beside(path: &Path) -> Vec<PathBuf> {
    let is_array = |path: &Path| path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("npy"));
    let folder = path.parent().filter(|_| is_array(path));
    let entries = folder.and_then(|folder| folder.read_dir().ok()).into_iter().flatten().flatten();
    let is_hidden = |path: &Path| path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."));
    let paths = entries.map(|entry| entry.path());
    let mut arrays: Vec<PathBuf> = paths.filter(|path| is_array(path) && !is_hidden(path)).collect();
    arrays.sort_unstable();
    arrays
}

/// Makes a folder and those above it.
pub fn make_folder(folder: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(folder).map_err(|error| {
        let (path, reason) = (folder.display().to_string(), error.kind().to_string());
        Error::Recording(pyrophone_recording::Error::NotWritten { path, reason })
    })
}

/// Six digits of a number, the last ones left out where they are zeros.
fn shortly(number: f64) -> String {
    format!("{number:.5e}").parse::<f64>().unwrap_or(number).to_string()
}

/// First and last number that are asked for.
fn wanted(args: &FluxArgs, numbers: &[i64]) -> Result<(i64, i64), Error> {
    let (Some(first), Some(last)) = (numbers.first(), numbers.last()) else { return Err(FlameError::NoFrames.into()) };
    match args.frames {
        None => Ok((*first, *last)),
        Some((from, to)) if from >= *first && to <= *last => Ok((from, to)),
        Some((from, to)) => Err(Error::Conflict(format!(
            "--frames is {from}-{to}, but the frames in {} are {first}-{last}; choose some of those",
            args.input.display()
        ))),
    }
}

/// What the first good frame shows.
struct Sight {
    iso: f64,
    voxel_edges: [f64; 3],
    field: String,
    velocity: String,
}

fn look_at(sequence: &Sequence, index: usize, selection: &Selection, args: &FluxArgs) -> Result<Sight, Error> {
    let description = sequence.describe(index)?;
    let selected = description.select(selection)?;
    let frame = sequence.read(index, selection)?;
    let (field, velocity) = (&description.grids[selected.field], &description.grids[selected.velocity[0]]);
    if velocity.is_staggered() && args.placement == Placement::Collocated {
        note(&format!(
            "the grid {} is staggered (components on the voxels' faces), but is taken at the voxels' centres; --placement file takes it where it stands",
            velocity.name
        ));
    }
    if field.is_unit_dependent() && args.iso.is_none() {
        return Err(Error::Conflict(format!(
            "the grid {} has a unit, so that nobody but you knows its value at the flame front; give it by --iso, or choose another --field",
            field.name
        )));
    }
    let iso = args.iso.unwrap_or(if field.is_level_set() { 0.0 } else { ISO });
    let names: Vec<&str> = selected.velocity.iter().map(|index| description.grids[*index].name.as_str()).collect();
    let velocity = if selected.is_split() { names.join(" ") } else { velocity.name.clone() };
    let voxel_edges = frame.field.transform().voxel_edges();
    Ok(Sight { iso, voxel_edges, field: field.name.clone(), velocity })
}
