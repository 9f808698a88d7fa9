//! NumPy's `.npz`: arrays in a zip file.
//!
//! Every member `name.npy` of three axes is a scalar field, every one of four axes with three components first or last
//! is a vector field. `voxel_size` (one number, else 1) and `origin` (three, else 0) state their position, `time_s`
//! (one number) their time.

mod arrays;
mod write;

use std::collections::BTreeSet;
use std::io::{Read, Seek};

use zip::ZipArchive;
use zip::result::ZipError;

use self::arrays::{ORIGIN, TIME, VOXEL_SIZE};
use super::budget::{Budget, check_file_size};
use super::error::{FormatFault, damaged, shown};
use super::model::{GridInfo, GridSource, check_components};
use super::npy::{Header, components, fault_of, grid};
use crate::grid::{Grid, Region, Transform};

pub use self::write::{DenseFrame, write_frame};

/// Largest number of members in an archive.
const MOST_MEMBERS: usize = 4096;

/// An archive of arrays.
#[derive(Debug)]
pub struct Npz<R> {
    archive: ZipArchive<R>,
    infos: Vec<GridInfo>,
    /// Index of each grid in the archive, or the reason why it cannot be read.
    members: Vec<Result<usize, FormatFault>>,
    transform: Transform,
    time_s: Option<f64>,
    budget: Budget,
}

impl<R: Read + Seek> Npz<R> {
    /// Reads the archive's directory and the headers of its arrays.
    ///
    /// # Errors
    /// If the archive makes no sense; faults of a single array are reported when that array is read.
    pub fn open(mut reader: R) -> Result<Self, FormatFault> {
        let file_bytes = reader.seek(std::io::SeekFrom::End(0)).map_err(|error| fault_of(&error))?;
        check_file_size(file_bytes)?;
        let mut archive = ZipArchive::new(reader).map_err(|error| fault_of_zip(&error))?;
        if archive.len() > MOST_MEMBERS {
            let (found, allowed) = (archive.len() as u64, MOST_MEMBERS as u64);
            return Err(FormatFault::TooLarge { what: "arrays in the archive", found, allowed });
        }
        if archive.has_duplicate_names() {
            return damaged("two members of the archive have the same name");
        }
        if archive.has_overlapping_entries().map_err(|error| fault_of_zip(&error))? {
            return damaged("members of the archive overlap");
        }
        let mut npz = Self {
            archive,
            infos: vec![],
            members: vec![],
            transform: Transform::uniform(1.0, [0.0; 3])?,
            time_s: None,
            budget: Budget::of_file(file_bytes),
        };
        npz.find_grids()?;
        Ok(npz)
    }

    fn find_grids(&mut self) -> Result<(), FormatFault> {
        let (mut voxel_size, mut origin) = (1.0, [0.0; 3]);
        let mut seen = BTreeSet::new();
        for index in 0..self.archive.len() {
            let Some(name) = self.array_name(index) else { continue };
            if !seen.insert(name.clone()) {
                return damaged(format!("two arrays are named {}", shown(&name)));
            }
            match name.as_str() {
                VOXEL_SIZE => [voxel_size] = self.numbers(index, VOXEL_SIZE)?,
                ORIGIN => origin = self.numbers(index, ORIGIN)?,
                // An invalid time does no harm: the user knows the rate.
                TIME => {
                    self.time_s =
                        self.numbers(index, TIME).ok().map(|[time_s]| time_s).filter(|time_s| time_s.is_finite())
                }
                _ => {
                    let header = self.member(index).map(|(header, _)| header);
                    self.infos.push(GridInfo {
                        name,
                        kind: header.as_ref().map_or_else(|_| "unreadable".into(), Header::kind),
                        // An unreadable array is still found by its name, so that the reason is reported.
                        components: header.as_ref().map_or(1, |header| components(&header.shape)),
                        ..GridInfo::default()
                    });
                    self.members.push(header.map(|_| index));
                }
            }
        }
        if voxel_size <= 0.0 {
            return damaged(format!("{VOXEL_SIZE} is {voxel_size}, but must be above 0"));
        }
        self.transform = Transform::uniform(voxel_size, origin)?;
        for info in &mut self.infos {
            info.voxel_edges = Some(self.transform.voxel_edges());
        }
        Ok(())
    }

    /// The name of a member's array, without folders.
    fn array_name(&self, index: usize) -> Option<String> {
        let name = self.archive.name_for_index(index)?.ok()?;
        let base = name.rsplit(['/', '\\']).next().unwrap_or_default();
        base.strip_suffix(".npy").map(str::to_owned)
    }

    /// An array's header and the reader positioned after it. Never yields more bytes than the directory states.
    fn member(&mut self, index: usize) -> Result<(Header, impl Read), FormatFault> {
        let file = self.archive.by_index(index).map_err(|error| fault_of_zip(&error))?;
        if !matches!(file.compression(), zip::CompressionMethod::Stored | zip::CompressionMethod::Deflated) {
            return Err(unsupported(file.compression().to_string()));
        }
        let size = file.size();
        // One more byte reveals a member that is longer than stated.
        let mut reader = file.take(size.saturating_add(1));
        let header = Header::read(&mut reader)?;
        header.check_size(size)?;
        Ok((header, reader))
    }

    /// A member of `N` numbers, all of them finite.
    fn numbers<const N: usize>(&mut self, index: usize, name: &str) -> Result<[f64; N], FormatFault> {
        let (header, mut reader) = self.member(index)?;
        if header.count()? != N as u64 {
            return damaged(format!("{name} is an array of shape {:?}; {N} numbers are expected", header.shape));
        }
        let (mut numbers, mut at) = ([0.0; N], 0);
        header.values(&mut reader, |value| {
            if let Some(number) = numbers.get_mut(at) {
                *number = value;
            }
            at += 1;
        })?;
        Ok(numbers)
    }

    fn read<const N: usize>(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<N>, FormatFault> {
        let name = check_components(&self.infos, index, N)?.name.clone();
        let missing = || FormatFault::Damaged(format!("array {} is missing", shown(&name)));
        let member = self.members.get(index).cloned().ok_or_else(missing)??;
        let (transform, mut budget) = (self.transform, self.budget.clone());
        let (header, mut reader) = self.member(member)?;
        let read = grid(&header, &mut reader, transform, region, &mut budget);
        drop(reader);
        self.budget = budget;
        read
    }
}

impl<R: Read + Seek> GridSource for Npz<R> {
    fn grids(&self) -> &[GridInfo] {
        &self.infos
    }

    fn scalar_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<1>, FormatFault> {
        self.read(index, region)
    }

    fn vectors_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<3>, FormatFault> {
        self.read(index, region)
    }

    fn time_s(&self) -> Option<f64> {
        self.time_s
    }
}

fn unsupported(found: String) -> FormatFault {
    let advice = "write it with numpy.savez or numpy.savez_compressed";
    FormatFault::Unsupported { found: format!("an archive with {}", shown(&found)), advice }
}

fn fault_of_zip(error: &ZipError) -> FormatFault {
    match error {
        ZipError::Io(error) => fault_of(error),
        ZipError::UnsupportedArchive(what) => unsupported((*what).to_owned()),
        error => FormatFault::Damaged(shown(&error.to_string())),
    }
}
