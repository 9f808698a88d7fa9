//! A frame of `.npy` files, one for each field.

use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use super::array::{components, grid};
use super::header::Header;
use crate::grid::{Grid, Region, Transform};
use crate::import::budget::{Budget, check_file_size};
use crate::import::error::FormatFault;
use crate::import::model::{GridInfo, GridSource, check_components};

/// The `.npy` files of one frame. Their voxels have edges of 1, and the first one is at 0.
#[derive(Debug)]
pub struct Npy {
    files: Vec<PathBuf>,
    infos: Vec<GridInfo>,
    /// Headers, or the reason why a file cannot be read; reported only if that file is used.
    headers: Vec<Result<Header, FormatFault>>,
    transform: Transform,
    budget: Budget,
}

impl Npy {
    /// Reads the headers of files, each given with the name of its field.
    ///
    /// # Errors
    /// If the voxels' transform is unusable. An unreadable file is an error only when it is used.
    pub fn open(fields: &[(String, PathBuf)]) -> Result<Self, FormatFault> {
        let transform = Transform::uniform(1.0, [0.0; 3])?;
        let (mut files, mut infos, mut headers, mut all_bytes) = (vec![], vec![], vec![], 0u64);
        for (name, path) in fields {
            let opened = open(path);
            let header = opened.map(|(header, _, bytes)| {
                all_bytes = all_bytes.saturating_add(bytes);
                header
            });
            let known = header.as_ref().ok();
            infos.push(GridInfo {
                name: name.clone(),
                kind: known.map_or_else(|| "unreadable".into(), Header::kind),
                // An unreadable file is still found by its name, so that the reason is reported.
                components: known.map_or(1, |header| components(&header.shape)),
                voxel_edges: Some(transform.voxel_edges()),
                ..GridInfo::default()
            });
            headers.push(header);
            files.push(path.clone());
        }
        Ok(Self { files, infos, headers, transform, budget: Budget::of_file(all_bytes) })
    }

    fn read<const N: usize>(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<N>, FormatFault> {
        check_components(&self.infos, index, N)?;
        if let Some(Err(fault)) = self.headers.get(index) {
            return Err(fault.clone());
        }
        let missing = || FormatFault::Unreadable("it has disappeared".into());
        let (header, mut reader, _) = open(self.files.get(index).ok_or_else(missing)?)?;
        if components(&header.shape) != N {
            return Err(FormatFault::Damaged("it changed while it was read".into()));
        }
        grid(&header, &mut reader, self.transform, region, &mut self.budget)
    }
}

/// The header, the reader positioned after it, and the file's size in bytes.
fn open(path: &Path) -> Result<(Header, BufReader<File>, u64), FormatFault> {
    let unreadable = |error: std::io::Error| FormatFault::Unreadable(error.kind().to_string());
    let file = File::open(path).map_err(unreadable)?;
    let bytes = file.metadata().map_err(unreadable)?.len();
    check_file_size(bytes)?;
    let mut reader = BufReader::new(file);
    let header = Header::read(&mut reader)?;
    header.check_size(bytes)?;
    Ok((header, reader, bytes))
}

impl GridSource for Npy {
    fn grids(&self) -> &[GridInfo] {
        &self.infos
    }

    fn scalar_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<1>, FormatFault> {
        self.read(index, region)
    }

    fn vectors_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<3>, FormatFault> {
        self.read(index, region)
    }

    fn path_of(&self, index: usize) -> Option<&Path> {
        self.files.get(index).map(PathBuf::as_path)
    }
}
