//! Writes OpenVDB files of every version and codec.

use std::io::Write;

use super::Random;
use super::trees::{Written, random_tree};

pub const ZIP: u32 = 1;
pub const ACTIVE_MASK: u32 = 2;
pub const BLOSC: u32 = 4;

/// Storage of all grids of a file.
#[derive(Debug, Clone, Copy)]
pub struct Form {
    pub version: u32,
    pub compression: u32,
    pub half: bool,
    pub offsets: bool,
}

/// A grid to be written.
#[derive(Debug, Clone)]
pub struct Plan {
    pub unique_name: String,
    /// `float`, `vec3s`...
    pub kind: &'static str,
    /// Shares the tree of the grid of this unique name.
    pub parent: String,
    pub metadata: Vec<(&'static str, &'static str, Vec<u8>)>,
    pub map: (&'static str, Vec<u8>),
    /// The tree in bytes (topology, leaves); a random one where there is none.
    pub tree: Option<(Vec<u8>, Vec<u8>)>,
}

impl Plan {
    pub fn new(name: &str, kind: &'static str) -> Self {
        let map = ("UniformScaleMap", doubles(&[vec![0.5; 6], vec![2.0; 3], vec![4.0; 3], vec![1.0; 3]].concat()));
        Self { unique_name: name.into(), kind, parent: String::new(), metadata: vec![], map, tree: None }
    }

    pub fn instance(name: &str, kind: &'static str, parent: &str) -> Self {
        Self { parent: parent.into(), ..Self::new(name, kind) }
    }

    pub fn with(mut self, name: &'static str, kind: &'static str, value: &[u8]) -> Self {
        self.metadata.push((name, kind, value.into()));
        self
    }

    pub fn placed(mut self, map: &'static str, numbers: &[f64]) -> Self {
        self.map = (map, doubles(numbers));
        self
    }
}

/// A file and, for each grid with a tree, what it must hold.
pub struct VdbFile {
    pub bytes: Vec<u8>,
    pub written: Vec<Option<Written>>,
}

pub fn write(form: Form, plans: &[Plan], random: &mut Random) -> VdbFile {
    let mut bytes = vec![0x20, 0x42, 0x44, 0x56, 0, 0, 0, 0];
    for number in [form.version, 10, 0] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.push(u8::from(form.offsets));
    if form.version < 222 {
        bytes.push(u8::from(form.compression & ZIP != 0));
    }
    bytes.extend(b"01234567-89ab-cdef-0123-456789abcdef");
    bytes.extend(metadata(&[("creator", "string", b"test".to_vec())]));
    bytes.extend((plans.len() as i32).to_le_bytes());
    let mut written = vec![];
    for plan in plans {
        let suffix = if form.half { "_HalfFloat" } else { "" };
        bytes.extend(text(&plan.unique_name));
        bytes.extend(text(&format!("Tree_{}_5_4_3{suffix}", plan.kind)));
        bytes.extend(text(&plan.parent));
        let head = head(form, plan);
        let (topology, leaves) = if plan.parent.is_empty() {
            let random_written = |random: &mut Random| random_tree(form, plan.kind, random);
            let (topology, leaves, truth) = match &plan.tree {
                Some((topology, leaves)) => (topology.clone(), leaves.clone(), None),
                None => {
                    let (topology, leaves, truth) = random_written(random);
                    (topology, leaves, Some(truth))
                }
            };
            written.push(truth);
            (topology, leaves)
        } else {
            written.push(None);
            (vec![], vec![])
        };
        let start = bytes.len() + 24;
        let positions =
            [start, start + head.len() + topology.len(), start + head.len() + topology.len() + leaves.len()];
        for (place, position) in positions.into_iter().enumerate() {
            let given = form.offsets && (place != 1 || plan.parent.is_empty());
            bytes.extend(if given { position as i64 } else { 0 }.to_le_bytes());
        }
        bytes.extend([head, topology, leaves].concat());
    }
    VdbFile { bytes, written }
}

fn head(form: Form, plan: &Plan) -> Vec<u8> {
    let mut entries = plan.metadata.clone();
    entries.push(("name", "string", plan.unique_name.clone().into_bytes()));
    entries.push(("file_voxel_count", "int64", vec![0xFF; 8]));
    entries.push(("odd", "__unheard_of", vec![1, 2, 3]));
    if form.half {
        entries.push(("is_saved_as_half_float", "bool", vec![1]));
    }
    let compression = if form.version >= 222 { form.compression.to_le_bytes().to_vec() } else { vec![] };
    [compression, metadata(&entries), text(plan.map.0), plan.map.1.clone()].concat()
}

fn metadata(entries: &[(&str, &str, Vec<u8>)]) -> Vec<u8> {
    let mut bytes = (entries.len() as u32).to_le_bytes().to_vec();
    for (name, kind, value) in entries {
        bytes.extend(text(name));
        bytes.extend(text(kind));
        bytes.extend((value.len() as u32).to_le_bytes());
        bytes.extend(value);
    }
    bytes
}

pub fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

pub fn doubles(numbers: &[f64]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// An array as the codec has it: stored or packed, as chance will.
pub fn packed(bytes: &[u8], compression: u32, random: &mut Random) -> Vec<u8> {
    if compression & (ZIP | BLOSC) == 0 {
        return bytes.to_vec();
    }
    let chunk = match () {
        () if random.chance(0.2) => vec![],
        () if compression & BLOSC != 0 => blosc(bytes, random),
        () => {
            let mut encoder = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::default());
            encoder.write_all(bytes).unwrap();
            encoder.finish().unwrap()
        }
    };
    if chunk.is_empty() {
        return [&(-(bytes.len() as i64)).to_le_bytes()[..], bytes].concat();
    }
    [&(chunk.len() as i64).to_le_bytes()[..], &chunk].concat()
}

/// A Blosc chunk of shuffled LZ4, in one block or several, split or not.
fn blosc(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let type_size = random.pick(&[1usize, 2, 4, 12]);
    let blocks = [bytes.len(), 128 * type_size, 256 * type_size];
    let block_size = random.pick(&blocks).min(bytes.len() / type_size * type_size).max(1);
    let split = random.chance(0.7);
    let count = bytes.len().div_ceil(block_size);
    let (mut starts, mut body) = (vec![], vec![]);
    for block in bytes.chunks(block_size) {
        starts.extend(((16 + 4 * count + body.len()) as i32).to_le_bytes());
        let values = block.len() / type_size;
        let planes = (0..type_size).flat_map(|place| (0..values).map(move |i| block[i * type_size + place]));
        let shuffled: Vec<u8> = planes.chain(block[values * type_size..].iter().copied()).collect();
        let splits = split && block_size / type_size >= 128 && block.len() == block_size;
        let streams = if splits { type_size } else { 1 };
        for stream in shuffled.chunks(shuffled.len() / streams) {
            let packed = lz4_flex::block::compress(stream);
            let kept = if packed.len() < stream.len() { &packed } else { stream };
            body.extend((kept.len() as i32).to_le_bytes());
            body.extend(kept);
        }
    }
    let flags = 1 | 1 << 5 | if split { 0 } else { 16 };
    let mut chunk = vec![2, 1, flags, type_size as u8];
    for size in [bytes.len(), block_size, 16 + starts.len() + body.len()] {
        chunk.extend((size as u32).to_le_bytes());
    }
    [chunk, starts, body].concat()
}
