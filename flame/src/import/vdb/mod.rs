//! OpenVDB files, versions 220 to 225.
//!
//! ```text
//! magic | version | library | offsets? | uuid | metadata | grids: descriptor, body
//! body: compression | metadata | transform | topology with branches' values | leaves' values
//! ```
//!
//! A grid's body is decoded only on request. In files without offsets, the bodies before it are skipped.

mod blosc;
mod cursor;
mod header;
mod kind;
mod tree;
mod values;

use std::collections::BTreeMap;

use self::cursor::Cursor;
use self::header::{Descriptor, Header, Metadata};
use self::kind::GridKind;
use self::tree::{Nothing, Tree, Wanted};
use self::values::{FLAGGED_VERSION, ValueLayout, ZIP};
use super::blender::DomainBox;
use super::budget::{Budget, check_file_size};
use super::error::{FormatFault, damaged, shown};
use super::model::{GridInfo, GridSource, check_components};
use crate::grid::{Grid, Region};

const MAGIC: [u8; 8] = [0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
/// File versions of OpenVDB 3 to 13.
const VERSIONS: std::ops::RangeInclusive<u32> = 220..=225;
/// A UUID as text.
const UUID_BYTES: usize = 36;
const MOST_GRIDS: usize = 4096;

/// Bytes of the shortest descriptor.
const LEAST_DESCRIPTOR_BYTES: usize = 36;

/// An OpenVDB file in memory, with readable grids.
#[derive(Debug, Clone)]
pub struct Vdb<'a> {
    bytes: &'a [u8],
    version: u32,
    infos: Vec<GridInfo>,
    bodies: Vec<Body>,
    budget: Budget,
}

/// Location and layout of a stored grid.
#[derive(Debug, Clone)]
struct Body {
    header: Result<Header, FormatFault>,
    kind: Option<GridKind>,
    tree: String,
    /// Index of the grid whose tree this one shares.
    parent: Result<Option<usize>, FormatFault>,
    /// Range from the tree's first byte to the end of its bytes.
    extent: (usize, usize),
}

impl<'a> Vdb<'a> {
    /// Reads the headers of all grids.
    ///
    /// # Errors
    /// If the file itself makes no sense; faults of a single grid are reported when that grid is read, unless the file
    /// has no offsets for skipping it.
    pub fn open(bytes: &'a [u8]) -> Result<Self, FormatFault> {
        check_file_size(bytes.len() as u64)?;
        let mut cursor = Cursor::within(bytes, 0, bytes.len())?;
        if bytes.get(..MAGIC.len()) != Some(&MAGIC[..]) {
            return damaged("it lacks the OpenVDB signature");
        }
        cursor.read_bytes(MAGIC.len())?;
        let version = cursor.u32()?;
        if !VERSIONS.contains(&version) {
            let advice = "write the file with OpenVDB 3 to 13 (file versions 220 to 225)";
            return Err(FormatFault::Unsupported { found: format!("OpenVDB file version {version}"), advice });
        }
        cursor.read_bytes(8)?;
        let has_offsets = cursor.u8()? != 0;
        let compression = if version < FLAGGED_VERSION && cursor.u8()? != 0 { ZIP } else { 0 };
        cursor.read_bytes(UUID_BYTES)?;
        Metadata::read(&mut cursor)?;
        let budget = Budget::of_file(bytes.len() as u64);
        let mut index = Index::new(version, compression, has_offsets, budget.clone());
        let found = cursor.i32()?;
        let count = usize::try_from(found).unwrap_or(usize::MAX);
        if count > MOST_GRIDS {
            return damaged(format!("{found} grids, 0 to {MOST_GRIDS} are allowed"));
        }
        cursor.check_room("grids", count, LEAST_DESCRIPTOR_BYTES)?;
        for _ in 0..count {
            index.grid(&mut cursor)?;
        }
        index.find_parents();
        Ok(Self { bytes, version, infos: index.infos, bodies: index.bodies, budget })
    }

    /// Places the grids in the domain of which the file holds a part.
    pub(in crate::import) fn place(&mut self, domain: &DomainBox) {
        for (body, info) in self.bodies.iter_mut().zip(&mut self.infos) {
            let Ok(header) = &mut body.header else { continue };
            let (Some(cells), Ok(transform)) = (header.metadata.cells, &header.transform) else { continue };
            if let Some(transform) = domain.transform(cells, transform.voxel_edges()[0]) {
                info.voxel_edges = Some(transform.voxel_edges());
                header.transform = Ok(transform);
            }
        }
    }

    fn read<const N: usize>(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<N>, FormatFault> {
        let name = check_components(&self.infos, index, N)?.name.clone();
        let missing = || FormatFault::Damaged(format!("grid {} has no tree", shown(&name)));
        let own = self.bodies.get(index).ok_or_else(missing)?;
        let transform = own.header.clone()?.transform?;
        let body = match own.parent.clone()? {
            Some(parent) => self.bodies.get(parent).ok_or_else(missing)?,
            None => own,
        };
        let header = body.header.clone()?;
        let kind = body.kind.ok_or_else(missing)?;
        let layout = layout(self.version, &header, kind);
        let cursor = Cursor::within(self.bytes, body.extent.0, body.extent.1)?;
        let tree = Tree::open(cursor, layout, &mut self.budget)?;
        let background = *tree.background().first_chunk().ok_or_else(missing)?;
        let mut sink =
            Wanted { grid: Grid::new(background, transform), part: region.map(|region| region.within(&transform)) };
        tree.read(&mut sink)?;
        Ok(sink.grid)
    }
}

impl GridSource for Vdb<'_> {
    fn grids(&self) -> &[GridInfo] {
        &self.infos
    }

    fn scalar_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<1>, FormatFault> {
        self.read(index, region)
    }

    fn vectors_within(&mut self, index: usize, region: Option<&Region>) -> Result<Grid<3>, FormatFault> {
        self.read(index, region)
    }
}

fn layout(version: u32, header: &Header, kind: GridKind) -> ValueLayout {
    let half = header.metadata.half && kind.has_half_form;
    ValueLayout { version, compression: header.compression, kind, half }
}

/// The grids found so far.
struct Index {
    version: u32,
    compression: u32,
    has_offsets: bool,
    unique: BTreeMap<String, usize>,
    parents: Vec<String>,
    bodies: Vec<Body>,
    infos: Vec<GridInfo>,
    budget: Budget,
}

impl Index {
    fn new(version: u32, compression: u32, has_offsets: bool, budget: Budget) -> Self {
        let unique = BTreeMap::new();
        Self { version, compression, has_offsets, unique, parents: vec![], bodies: vec![], infos: vec![], budget }
    }

    /// Reads one descriptor and the header of its body, and moves to the next.
    fn grid(&mut self, cursor: &mut Cursor) -> Result<(), FormatFault> {
        let descriptor = Descriptor::read(cursor)?;
        if self.unique.insert(descriptor.unique_name.clone(), self.bodies.len()).is_some() {
            return damaged(format!("two grids named {}", shown(&descriptor.unique_name)));
        }
        let (kind_name, kind) = kind::of_tree(&descriptor.tree);
        let (header, extent) = if self.has_offsets {
            let (start, end) = descriptor.extent(cursor.offset(), cursor.end())?;
            let mut body = cursor.part(start, end)?;
            cursor.forward_to(end)?;
            let header = Header::read(&mut body, self.version, self.compression);
            (header, (body.offset(), end))
        } else {
            let header = Header::read(cursor, self.version, self.compression)?;
            let start = cursor.offset();
            if descriptor.parent.is_empty() {
                self.pass_over(cursor, &descriptor, &header, kind)?;
            }
            (Ok(header), (start, cursor.offset()))
        };
        self.infos.push(info(descriptor.name(), kind_name, kind, header.as_ref().ok()));
        self.bodies.push(Body { header, kind, tree: descriptor.tree, parent: Ok(None), extent });
        self.parents.push(descriptor.parent);
        Ok(())
    }

    fn pass_over(
        &mut self,
        cursor: &mut Cursor,
        descriptor: &Descriptor,
        header: &Header,
        kind: Option<GridKind>,
    ) -> Result<(), FormatFault> {
        let Some(kind) = kind else {
            let found = format!("grid {} ({})", shown(descriptor.name()), shown(&descriptor.tree));
            let advice = "the file has no offsets for skipping it: write the file to disk instead of a stream, or without this grid";
            return Err(FormatFault::Unsupported { found, advice });
        };
        let tree = Tree::open(cursor.clone(), layout(self.version, header, kind), &mut self.budget)?;
        let end = tree.read(&mut Nothing)?;
        cursor.forward_to(end)
    }

    /// Links the grids that share a tree. A parent has its own tree, of the same type.
    fn find_parents(&mut self) {
        for (index, parent) in self.parents.iter().enumerate().filter(|(_, parent)| !parent.is_empty()) {
            let tree = self.bodies.get(index).map(|body| body.tree.clone());
            let fits = |found: &&usize| {
                self.parents.get(**found).is_some_and(String::is_empty)
                    && self.bodies.get(**found).map(|body| &body.tree) == tree.as_ref()
            };
            let found = self.unique.get(parent).filter(fits).copied();
            let missing = || FormatFault::Damaged(format!("an instance of grid {}, which is missing", shown(parent)));
            if let Some(body) = self.bodies.get_mut(index) {
                body.parent = found.map(Some).ok_or_else(missing);
            }
        }
    }
}

fn info(name: &str, kind_name: String, kind: Option<GridKind>, header: Option<&Header>) -> GridInfo {
    let metadata = header.map(|header| header.metadata.clone()).unwrap_or_default();
    let transform = header.and_then(|header| header.transform.as_ref().ok());
    GridInfo {
        name: name.to_owned(),
        kind: kind_name,
        components: kind.map_or(0, |kind| kind.readable_components()),
        class: metadata.class,
        in_voxels: metadata.in_voxels,
        is_blender: metadata.is_blender,
        voxel_edges: transform.map(|transform| transform.voxel_edges()),
    }
}
