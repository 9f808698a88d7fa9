//! Measurement of a plan's frames, portion by portion.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use pyrophone_flame::flux::{Row, Steps};
use pyrophone_flame::upsample::{Upsampler, VoxelSources};
use pyrophone_recording::write_file;
use rayon::prelude::*;

use super::Plan;
use crate::args::{Measure, MeshKind};
use crate::error::Error;
use crate::flux::cache;
use crate::flux::kept::FluxCheckpoint;
use crate::output::make_folder;
use crate::progress::{Work, note};

/// Frames per thread that are measured before the checkpoint is written.
const PORTION: usize = 4;

/// The same, if their sources are kept until the changes between them are known: those of a large frame take much memory.
const PORTION_WITH_SOURCES: usize = 1;

/// What the change from a frame to the next needs.
struct Seen {
    source: VoxelSources,
    /// The frame's flux, if it was found on the way.
    row: Option<Row>,
}

/// Results of one step.
struct Measured {
    row: Row,
    /// Change to the next step.
    change: Option<Vec<f64>>,
}

impl Plan {
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

    /// Measures what has not been kept.
    fn resume(&self, kept: &mut FluxCheckpoint, work: &Work) -> Result<(), Error> {
        let stage = work.stage("measuring");
        let numbers: Vec<i64> = self.sequence.numbers().collect();
        let is_done = |index: &usize| {
            let number = numbers[*index];
            kept.steps.get(&number).is_some_and(Option::is_some)
                && self.mesh_path(number).is_none_or(|path| path.is_file())
                && (kept.changes.contains_key(&number) || !self.needs_change(*index))
        };
        let (done, left): (Vec<usize>, Vec<usize>) = self.indices.iter().partition(|index| is_done(index));
        let mut steps: Steps = self.missing.iter().map(|number| (*number, None)).collect();
        steps.extend(done.iter().filter_map(|index| kept.steps.get_key_value(&numbers[*index])));
        if !done.is_empty() {
            note(&format!("{} of {} frames are reused from an interrupted run", done.len(), self.indices.len()));
        }
        let total = self.indices.len().max(1) as f32;
        let finished = std::sync::atomic::AtomicUsize::new(done.len());
        // What is known of the frames that more than one change needs.
        let mut seen: BTreeMap<usize, Seen> = BTreeMap::new();
        // In portions, so that what is done is kept and the first bad frame is always the same one.
        let has_changes = self.upsampler.as_ref().is_some_and(Upsampler::needs_changes);
        let per_thread = if has_changes { PORTION_WITH_SOURCES } else { PORTION };
        for portion in left.chunks(per_thread * rayon::current_num_threads()) {
            seen = self.see(portion, seen, work)?;
            let is_shared = portion.len() < rayon::current_num_threads();
            let results: Vec<Result<Measured, Error>> = portion
                .par_iter()
                .map(|index| {
                    work.check()?;
                    let known = seen.get(index).and_then(|seen| seen.row).map(Ok);
                    let row = known.unwrap_or_else(|| self.row(*index, is_shared))?;
                    let measured = Measured { row, change: self.change(*index, &seen) };
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

    /// What changes need of a portion's frames and of the frame after each, requested or not: a shard looks beyond its own
    /// frames. Unreadable frames are left out; the error is reported when the frame itself is measured.
    fn see(
        &self,
        portion: &[usize],
        known: BTreeMap<usize, Seen>,
        work: &Work,
    ) -> Result<BTreeMap<usize, Seen>, Error> {
        if !self.upsampler.as_ref().is_some_and(Upsampler::needs_changes) {
            return Ok(BTreeMap::new());
        }
        let ahead = |index: &usize| [Some(*index), self.next(*index)];
        let needed: BTreeSet<usize> = portion.iter().flat_map(ahead).flatten().collect();
        let mut seen: BTreeMap<usize, Seen> = known.into_iter().filter(|(index, _)| needed.contains(index)).collect();
        let new: Vec<usize> = needed.into_iter().filter(|index| !seen.contains_key(index)).collect();
        let look = |index: &usize| work.check().map(|()| self.seen(*index).ok().map(|seen| (*index, seen)));
        let found: Result<Vec<_>, Error> = new.par_iter().map(look).collect();
        seen.extend(found?.into_iter().flatten());
        Ok(seen)
    }

    /// What changes need of a frame; its flux too, if that takes no second reading.
    fn seen(&self, index: usize) -> Result<Seen, Error> {
        if !self.needs_flow() || self.mesh.is_some() {
            return Ok(Seen { source: self.source(index)?, row: None });
        }
        let frame = self.read(index)?;
        let of_frame = |source| self.of_frame(index, source);
        let measure = self.front.measure_on_this_thread(&frame).map_err(of_frame)?;
        let source = VoxelSources::of_front(&frame, self.front.iso()).map_err(of_frame)?;
        Ok(Seen { source, row: Some(Row::new(frame.number, &measure)) })
    }

    /// Change from a frame to the next, if it is needed and both can be read.
    fn change(&self, index: usize, seen: &BTreeMap<usize, Seen>) -> Option<Vec<f64>> {
        let next = self.next(index)?;
        let (before, after) = (seen.get(&index)?, seen.get(&next)?);
        Some(self.upsampler.as_ref()?.change(self.sequence.numbers().nth(index)?, &before.source, &after.source))
    }

    /// The frame of the following step, requested or not: a shard looks one frame beyond its own.
    fn next(&self, index: usize) -> Option<usize> {
        let numbers: Vec<i64> = self.sequence.numbers().skip(index).take(2).collect();
        matches!(numbers[..], [this, next] if this.checked_add(1) == Some(next)).then_some(index + 1)
    }

    fn needs_change(&self, index: usize) -> bool {
        self.upsampler.as_ref().is_some_and(Upsampler::needs_changes) && self.next(index).is_some()
    }

    /// True if the changes between frames need the flow inside the front.
    fn needs_flow(&self) -> bool {
        let needs = |upsampler: &Upsampler| upsampler.needs_changes() && !upsampler.needs_field_only();
        self.measure == Measure::Flux && self.upsampler.as_ref().is_some_and(needs)
    }

    /// Volume sources of a frame.
    fn source(&self, index: usize) -> Result<VoxelSources, Error> {
        let of_frame = |source| self.of_frame(index, source);
        match self.measure {
            _ if self.needs_flow() => VoxelSources::of_front(&self.read(index)?, self.front.iso()).map_err(of_frame),
            _ if self.sequence.is_unlit(index, &self.selection) => Ok(VoxelSources::default()),
            _ => VoxelSources::of_field(&self.sequence.read_field(index, &self.selection)?).map_err(of_frame),
        }
    }

    /// Results of one frame; if there are fewer frames than threads, these share it.
    fn row(&self, index: usize, is_shared: bool) -> Result<Row, Error> {
        if self.measure != Measure::Flux {
            return self.integral(index);
        }
        // Flips need the whole flow: if they cannot have it, the frame is as bad for them.
        let frame = if self.needs_flow() { self.read(index)? } else { self.read_front(index)? };
        let measure = if is_shared { self.front.measure(&frame) } else { self.front.measure_on_this_thread(&frame) };
        let measure = measure.map_err(|source| self.of_frame(index, source))?;
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

    fn mesh_path(&self, number: i64) -> Option<PathBuf> {
        let (folder, every, first) = self.mesh.as_ref()?;
        let name = match self.sequence.numbering().is_plain() {
            true => format!("front_{number:04}.{}", self.mesh_kind.extension()),
            false => format!("front_{}.{}", self.label(number), self.mesh_kind.extension()),
        };
        number.abs_diff(*first).is_multiple_of(*every).then(|| folder.join(name))
    }
}
