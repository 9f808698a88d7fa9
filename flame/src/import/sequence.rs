//! A simulation's frames on disk.

use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::assemble::Assembly;
use super::blender::DomainBox;
use super::buffers::Buffers;
use super::description::Description;
use super::error::{Error, shown_path};
use super::file;
use super::format::Format;
use super::listing::{self, FrameFiles, Listing};
use super::model::{GridSource, Selection};
use super::names;
use super::npy::Npy;
use super::npz::Npz;
use super::numbering::{Numbering, Pattern};
use super::vdb::Vdb;
use crate::advection;
use crate::frame::Frame;
use crate::front::Front;
use crate::grid::Grid;
use crate::velocity::Velocity;

/// Largest number of missing frames between the first and the last.
const MOST_MISSING: u64 = 1_000_000;

/// Tolerance of a frame's time against an even grid, in steps.
const MOST_UNEVEN: f64 = 0.02;

/// The frames of a folder, or of a single file. Frames are counted from 0 in the order of their numbers.
#[derive(Debug, Clone)]
pub struct Sequence {
    path: PathBuf,
    frames: Vec<FrameFiles>,
    left_out: usize,
    numbering: Numbering,
    buffers: Arc<Buffers>,
}

impl Sequence {
    /// Opens a folder of numbered `.vdb`, `.npz` or `.npy` files (`<field>_<number>.npy`, one for each field), the
    /// files of a folder whose names match a pattern such as `fire.####.vdb`, or one file. File contents are not read
    /// yet.
    ///
    /// # Errors
    /// If there are no frames, frames of several sorts, two files for one frame, or more than a million missing
    /// numbers.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let listing = match path.metadata() {
            Ok(metadata) if metadata.is_dir() => listing::of_folder(path)?,
            Ok(_) => listing::of_single(path)?,
            Err(error) => match path.file_name().and_then(|name| Pattern::of_file_name(&name.to_string_lossy())) {
                Some(pattern) => listing::of_pattern(path, &pattern)?,
                None => return Err(Error::of_system(path)(error)),
            },
        };
        let Listing { frames, left_out, numbering } = listing;
        let buffers = Arc::default();
        let sequence = Self { path: path.to_path_buf(), frames, left_out, numbering, buffers };
        if let Some((first, last, missing)) = sequence.span().filter(|(.., missing)| *missing > MOST_MISSING) {
            return Err(Error::Gap { path: shown_path(path), first, last, missing, allowed: MOST_MISSING });
        }
        Ok(sequence)
    }

    /// First number, last number, and count of numbers without a file.
    fn span(&self) -> Option<(i64, i64, u64)> {
        let (first, last) = (self.frames.first()?.number, self.frames.last()?.number);
        Some((first, last, last.abs_diff(first).saturating_sub(self.frames.len() as u64 - 1)))
    }

    /// Relation of the numbers in file names to steps.
    pub fn numbering(&self) -> &Numbering {
        &self.numbering
    }

    /// The frames' steps in ascending order: their numbers, if those are consecutive.
    pub fn numbers(&self) -> impl Iterator<Item = i64> + '_ {
        self.frames.iter().map(|frame| frame.number)
    }

    /// Number of frames; at least one.
    pub fn len(&self) -> usize {
        self.frames.len()
    }

    /// Always false: a sequence without frames cannot be opened.
    pub fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Steps without a file, between the first and the last.
    pub fn missing(&self) -> Vec<i64> {
        let pairs = self.frames.windows(2).filter_map(|pair| Some((pair.first()?.number, pair.last()?.number)));
        pairs.flat_map(|(before, after)| before + 1..after).collect()
    }

    /// Number of numbered files of other sorts in the folder, which are left out.
    pub fn left_out(&self) -> usize {
        self.left_out
    }

    /// The file of a frame, or the first of several; the sequence's own path if there is no such frame.
    pub fn path_of(&self, index: usize) -> &Path {
        let file = self.frames.get(index).and_then(|frame| frame.files.first());
        file.map_or(&self.path, |(_, path)| path)
    }

    /// Time of a frame in seconds, if its file states it: only `.npz` does.
    pub fn time_s(&self, index: usize) -> Option<f64> {
        let is_npz = self.frames.get(index).is_some_and(|frame| frame.format == Format::Npz);
        if !is_npz {
            return None;
        }
        self.with_source(index, |_, source| Ok(source.time_s())).ok().flatten()
    }

    /// Frames per second, if at least two of `indices` state their time.
    ///
    /// # Errors
    /// If their times are not proportional to their numbers (within 2 % of a step).
    pub fn rate_hz(&self, indices: &[usize]) -> Result<Option<f64>, Error> {
        let timed = |index: &usize| Some((self.frames.get(*index)?.number, self.time_s(*index)?));
        let times: Vec<(i64, f64)> = indices.iter().filter_map(timed).collect();
        // Unreadable frames state nothing, but the readable ones are enough.
        let [(first, start_s), .., (last, end_s)] = times.as_slice() else { return Ok(None) };
        let step_s = (end_s - start_s) / last.abs_diff(*first) as f64;
        let expected_s = |number: i64| start_s + number.abs_diff(*first) as f64 * step_s;
        let is_off = |(number, time_s): &&(i64, f64)| (time_s - expected_s(*number)).abs() > MOST_UNEVEN * step_s;
        if !(step_s.is_finite() && step_s > 0.0) || times.iter().any(|time| is_off(&time)) {
            return Err(Error::UnevenTimes { path: shown_path(&self.path) });
        }
        Ok(Some(snapped_rate_hz(1.0 / step_s)))
    }

    /// Description of a frame, from its headers.
    ///
    /// # Errors
    /// If there is no frame `index`, or its file cannot be read.
    pub fn describe(&self, index: usize) -> Result<Description, Error> {
        let path = shown_path(self.path_of(index));
        self.with_source(index, |_, source| Ok(Description { path, grids: source.grids().to_vec() }))
    }

    /// Reads the field and the velocity of a frame.
    ///
    /// The field is larger in the flame (a level set is negated); the velocity is in world units per unit of simulation
    /// time, with the selection's scale and placement.
    ///
    /// # Errors
    /// Names the file and the reason; also if a value in either is not finite.
    pub fn read(&self, index: usize, selection: &Selection) -> Result<Frame, Error> {
        let path = self.path_of(index);
        self.with_source(index, |number, source| {
            let selected = names::select(source.grids(), selection).map_err(Error::of_file(path))?;
            let mut assembly = Assembly { source, path, region: None };
            let field = assembly.field(selected.field)?;
            let velocity = assembly.velocity(&selected, selection.placement)?;
            Ok(Frame { number, field, velocity: scaled(velocity, selection) })
        })
    }

    /// Reads the field of a frame, and the velocity near its front alone: all that [`Front::measure`] needs.
    ///
    /// # Errors
    /// As [`read`](Self::read); of the velocity, only what is read is checked. A field without a front can be read, even
    /// if it cannot be measured.
    pub fn read_front(&self, index: usize, selection: &Selection, front: &Front) -> Result<Frame, Error> {
        let path = self.path_of(index);
        self.with_source(index, |number, source| {
            let selected = names::select(source.grids(), selection).map_err(Error::of_file(path))?;
            let field = Assembly { source, path, region: None }.field(selected.field)?;
            // What cannot be measured is reported when it is.
            let region = front.region(&field).ok();
            let velocity =
                Assembly { source, path, region: region.as_ref() }.velocity(&selected, selection.placement)?;
            Ok(Frame { number, field, velocity: scaled(velocity, selection) })
        })
    }

    /// Reads only the field of a frame; larger in the flame.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_field(&self, index: usize, selection: &Selection) -> Result<Grid<1>, Error> {
        let path = self.path_of(index);
        self.with_source(index, |_, source| {
            let field = names::select_field(source.grids(), selection).map_err(Error::of_file(path))?;
            Assembly { source, path, region: None }.field(field)
        })
    }

    /// Reads a quantity carried by the gas of a frame (density, smoke, temperature), if there is one, and the flow where
    /// [`Fitting`](crate::advection::Fitting) examines it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_carried(&self, index: usize, selection: &Selection) -> Result<Option<(Grid<1>, Velocity)>, Error> {
        let path = self.path_of(index);
        self.with_source(index, |_, source| {
            let Some(carried) = names::carried(source.grids()) else { return Ok(None) };
            let selected = names::select(source.grids(), selection).map_err(Error::of_file(path))?;
            let field = Assembly { source, path, region: None }.field(carried)?;
            let region = advection::region(&field);
            let flow = Assembly { source, path, region: Some(&region) }.velocity(&selected, selection.placement)?;
            Ok(Some((field, scaled(flow, selection))))
        })
    }

    /// Reads only the quantity carried by the gas, if there is one.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_carried_field(&self, index: usize) -> Result<Option<Grid<1>>, Error> {
        let path = self.path_of(index);
        self.with_source(index, |_, source| {
            let carried = names::carried(source.grids());
            carried.map(|carried| Assembly { source, path, region: None }.field(carried)).transpose()
        })
    }

    /// True for a frame before ignition: its file can be read but has no grids at all, or an empty field.
    pub fn is_unlit(&self, index: usize, selection: &Selection) -> bool {
        let path = self.path_of(index);
        let is_unlit = self.with_source(index, |_, source| {
            if source.grids().is_empty() {
                return Ok(true);
            }
            let field = names::select_field(source.grids(), selection).map_err(Error::of_file(path))?;
            let field = Assembly { source, path, region: None }.field(field)?;
            Ok(field.bounds().is_none() && field.tiles().next().is_none())
        });
        is_unlit.unwrap_or(false)
    }

    /// Opens a frame's files for `use_it`.
    fn with_source<T>(
        &self,
        index: usize,
        use_it: impl FnOnce(i64, &mut dyn GridSource) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let found = self.frames.len();
        let missing = || Error::NoFrame { path: shown_path(&self.path), index, found };
        let frame = self.frames.get(index).ok_or_else(missing)?;
        let path = self.path_of(index);
        let failure = Error::of_file(path);
        match frame.format {
            Format::Vdb => self.buffers.with_file(path, |bytes| {
                let mut vdb = Vdb::open(bytes).map_err(failure)?;
                if vdb.grids().iter().any(|grid| grid.is_blender)
                    && let Some(domain) = DomainBox::beside(path)
                {
                    vdb.place(&domain);
                }
                use_it(frame.number, &mut vdb)
            }),
            Format::Npz => {
                let (file, _) = file::open(path)?;
                use_it(frame.number, &mut Npz::open(BufReader::new(file)).map_err(failure)?)
            }
            Format::Npy => use_it(frame.number, &mut Npy::open(&frame.files).map_err(failure)?),
        }
    }
}

/// The velocity in the selection's unit.
fn scaled(velocity: Velocity, selection: &Selection) -> Velocity {
    match selection.velocity_scale {
        1.0 => velocity,
        scale => velocity.scaled(scale),
    }
}

/// Relative tolerance for recognising usual rates: times are written with few digits.
const SAME_RATE: f64 = 1e-6;

/// The whole rate, or television rate (n · 1000/1001), that a rate equals up to rounding; otherwise the rate itself.
pub(super) fn snapped_rate_hz(rate_hz: f64) -> f64 {
    let usual = [1.0, 1000.0 / 1001.0].map(|part| (rate_hz / part).round() * part);
    let is_near = |usual: &f64| (usual / rate_hz - 1.0).abs() < SAME_RATE;
    // Nine digits, so that parts of a simulation find the same rate as the whole.
    let rounded = || format!("{rate_hz:.8e}").parse().unwrap_or(rate_hz);
    usual.into_iter().find(is_near).unwrap_or_else(rounded)
}
