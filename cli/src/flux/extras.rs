//! Data of a part beyond its table, for merging speed fields and reports: `PART.csv.extra`.
//!
//! ```text
//! magic | hash of the part's table | facts | speeds? | fronts? | hash of everything before
//! ```
//!
//! Numbers are little-endian and read back bit for bit.

use std::io::Write;
use std::path::{Path, PathBuf};

use pyrophone_flame::front::Mesh;
use pyrophone_recording::{content_hash, write_file};

use super::facts::CacheFacts;
use super::measuring::Span;
use super::motion::{Speeds, Survey};
use crate::error::Error;

mod bytes;

use bytes::{Reader, Writer};

/// Start of the file; its last character is the version.
const MAGIC: &[u8] = b"pyrophone extra 1";

/// Characters of a hash.
const HASH: usize = 64;

/// Longest side of a flow's box, in voxels: far beyond any simulation.
const MOST_VOXELS: f64 = 1e6;

/// Fronts to be drawn, with their steps.
pub type Fronts = Vec<(i64, Mesh)>;

/// Contents of the file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PartExtras {
    /// Steps of all parts together.
    pub span: Span,
    /// First step of this part itself; the highest number if it has none.
    pub first_own: i64,
    /// Facts about the cache.
    pub facts: CacheFacts,
    /// Part of a speed field.
    pub speeds: Option<(Survey, Speeds)>,
    /// The part's share of a report's pictures.
    pub fronts: Option<Fronts>,
}

/// Path of a part's extra file.
pub fn path_of(part: &Path) -> PathBuf {
    let mut name = part.file_name().unwrap_or_default().to_os_string();
    name.push(".extra");
    part.with_file_name(name)
}

impl PartExtras {
    /// Writes the extra file of the part in `table`, which must exist already.
    ///
    /// # Errors
    /// If either file cannot be read or written.
    pub fn write(&self, table: &Path) -> Result<PathBuf, Error> {
        let path = path_of(table);
        let bytes = self.to_bytes(&hash_of(table)?);
        write_file(&path, |file| file.write_all(&bytes))?;
        Ok(path)
    }

    /// Reads the extra file of the part in `table`.
    ///
    /// # Errors
    /// If it does not exist, was truncated or modified, or does not match the part's table.
    pub fn read(table: &Path) -> Result<Self, Error> {
        let path = path_of(table);
        let refused = |reason: &str| Error::Conflict(format!("{}: {reason}", path.display()));
        let again = "measure the part again with --partial-with";
        let bytes = std::fs::read(&path).map_err(|error| refused(&format!("{}; {again}", error.kind())))?;
        let (table_hash, extras) = Self::from_bytes(&bytes)
            .ok_or_else(|| refused(&format!("it was truncated or modified, or comes from another version; {again}")))?;
        if table_hash != hash_of(table)? {
            return Err(refused(&format!("it does not match the present {}; {again}", table.display())));
        }
        Ok(extras)
    }

    fn to_bytes(&self, table_hash: &str) -> Vec<u8> {
        let mut to = Writer::default();
        to.raw(MAGIC);
        to.text(table_hash);
        [self.span.first, self.span.last, self.span.first_file, self.first_own]
            .into_iter()
            .for_each(|step| to.i64(step));
        to.text(&self.facts.simulation);
        to.optional(self.facts.size.as_ref(), |to, size| to.text(size));
        to.optional(self.facts.check.as_ref(), |to, check| to.text(check));
        to.optional(self.speeds.as_ref(), |to, (survey, speeds)| write_speeds(to, survey, speeds));
        to.optional(self.fronts.as_ref(), write_fronts);
        let hash = content_hash(&to.bytes);
        to.raw(hash.as_bytes());
        to.bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<(String, Self)> {
        let (body, hash) = bytes.split_at_checked(bytes.len().checked_sub(HASH)?)?;
        if content_hash(body).as_bytes() != hash {
            return None;
        }
        let mut from = Reader::new(body.strip_prefix(MAGIC)?);
        let table_hash = from.text()?;
        let span = Span { first: from.i64()?, last: from.i64()?, first_file: from.i64()? };
        let first_own = from.i64()?;
        let facts = CacheFacts {
            simulation: from.text()?,
            size: from.optional(Reader::text)?,
            check: from.optional(Reader::text)?,
        };
        let speeds = from.optional(|from| read_speeds(from, span))?;
        let fronts = from.optional(read_fronts)?;
        from.is_at_end().then_some((table_hash, Self { span, first_own, facts, speeds, fronts }))
    }
}

fn hash_of(table: &Path) -> Result<String, Error> {
    let failed = |error: std::io::Error| Error::Conflict(format!("{}: {}", table.display(), error.kind()));
    Ok(content_hash(&std::fs::read(table).map_err(failed)?))
}

fn write_speeds(to: &mut Writer, survey: &Survey, speeds: &Speeds) {
    to.count(survey.every);
    to.f64(survey.voxel);
    to.optional(survey.extent.as_ref(), |to, extent| extent.iter().flatten().for_each(|x| to.f64(*x)));
    to.count(speeds.len() as u64);
    for (step, speeds) in speeds {
        to.i64(*step);
        to.count(speeds.len() as u64);
        speeds.iter().for_each(|speed| to.raw(&speed.to_le_bytes()));
    }
}

fn read_speeds(from: &mut Reader<'_>, span: Span) -> Option<(Survey, Speeds)> {
    let (every, voxel) = (from.count()?, from.f64()?);
    let extent = from.optional(|from| Some([from.position()?, from.position()?]))?;
    let is_sane =
        |[low, high]: [[f64; 3]; 2]| (0..3).all(|axis| (0.0..MOST_VOXELS * voxel).contains(&(high[axis] - low[axis])));
    if every == 0 || !extent.is_none_or(is_sane) {
        return None;
    }
    let mut speeds = Speeds::new();
    for _ in 0..from.count()? {
        let step = from.i64()?;
        let count = from.count_of(4)?;
        let values: Option<Vec<f32>> = (0..count).map(|_| from.array().map(f32::from_le_bytes)).collect();
        speeds.insert(step, values?);
    }
    Some((Survey { span, every, extent, voxel }, speeds))
}

fn write_fronts(to: &mut Writer, fronts: &Fronts) {
    to.count(fronts.len() as u64);
    for (step, mesh) in fronts {
        to.i64(*step);
        to.count(mesh.vertices.len() as u64);
        mesh.vertices.iter().flatten().for_each(|x| to.f64(*x));
        to.count(mesh.triangles.len() as u64);
        mesh.triangles.iter().flatten().for_each(|corner| to.raw(&corner.to_le_bytes()));
    }
}

fn read_fronts(from: &mut Reader<'_>) -> Option<Fronts> {
    let mut fronts = vec![];
    for _ in 0..from.count()? {
        let step = from.i64()?;
        let count = from.count_of(24)?;
        let vertices: Option<Vec<[f64; 3]>> = (0..count).map(|_| from.position()).collect();
        let vertices = vertices?;
        let count = from.count_of(12)?;
        let mut corner = || from.array().map(u32::from_le_bytes).filter(|corner| (*corner as usize) < vertices.len());
        let triangles: Option<Vec<[u32; 3]>> = (0..count).map(|_| Some([corner()?, corner()?, corner()?])).collect();
        fronts.push((step, Mesh { triangles: triangles?, vertices }));
    }
    Some(fronts)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extras() -> PartExtras {
        let vertices = vec![[0.1, -2.0, 3.0], [f64::MIN_POSITIVE, 1.0 / 3.0, -0.0], [1e300, 0.0, 7.0]];
        let span = Span { first: -3, last: 9, first_file: -2 };
        let survey = Survey { span, every: 2, extent: Some([[0.0; 3], [1.0, 2.0, 0.1]]), voxel: 0.1 };
        PartExtras {
            span,
            first_own: -3,
            facts: CacheFacts { simulation: "für/fire".into(), size: Some("voxel".into()), check: None },
            speeds: Some((survey, Speeds::from([(-3, vec![0.5, 1.0 / 3.0]), (1, vec![])]))),
            fronts: Some(vec![(4, Mesh { vertices, triangles: vec![[0, 1, 2], [2, 1, 0]] }), (5, Mesh::default())]),
        }
    }

    #[test]
    fn extras_read_back_as_they_were() {
        for extras in [extras(), PartExtras::default()] {
            let bytes = extras.to_bytes("abc");
            assert_eq!(PartExtras::from_bytes(&bytes), Some(("abc".to_owned(), extras)));
        }
    }

    #[test]
    fn cut_changed_and_absurd_extras_are_refused() {
        let bytes = extras().to_bytes("abc");
        for length in 0..bytes.len() {
            assert_eq!(PartExtras::from_bytes(&bytes[..length]), None, "{length}");
        }
        let body = &bytes[..bytes.len() - HASH];
        // Even with a right hash, no number in it makes it panic or ask for more memory than it has bytes.
        for at in MAGIC.len()..body.len() {
            let mut changed = body.to_vec();
            changed[at] ^= 0xff;
            let hash = content_hash(&changed);
            changed.extend(hash.as_bytes());
            let _ = PartExtras::from_bytes(&changed);
        }
        let mut far = extras();
        far.speeds.as_mut().unwrap().0.extent = Some([[0.0; 3], [1e300, 0.0, 0.0]]);
        assert_eq!(PartExtras::from_bytes(&far.to_bytes("abc")), None);
    }
}
