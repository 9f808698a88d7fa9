//! Damaged and malicious files: nothing panics, nothing runs on, nothing eats the memory.
//!
//! Each test mutates files for three seconds, or with `PYROPHONE_SOAK=1` for ten minutes, always in the same order from
//! the seed it prints.

use std::io::Cursor;
use std::time::{Duration, Instant};

use crate::common::flame_cache;
use crate::import_common::Random;
use crate::import_common::vdb::{ACTIVE_MASK, BLOSC, Form, Plan, VdbFile, ZIP, write};
use pyrophone_flame::import::npy::Npy;
use pyrophone_flame::import::npz::{DenseFrame, Npz, write_frame};
use pyrophone_flame::import::vdb::Vdb;
use pyrophone_flame::import::{GridSource, Series};

/// Memory that any input may take, and that it may take for each of its bytes.
const BASE_BYTES: u64 = 64 << 20;
const BYTES_PER_BYTE: u64 = 32;

/// No call takes longer, even on a busy machine.
const LONGEST: Duration = Duration::from_secs(60);

fn end() -> Instant {
    let soak = std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1");
    Instant::now() + Duration::from_secs(if soak { 600 } else { 3 })
}

/// Numbers that formats trip over.
const ODD: [u64; 16] = [
    0,
    1,
    2,
    0x7F,
    0x80,
    0xFF,
    0x7FFF,
    0xFFFF,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    1 << 32,
    i64::MAX as u64,
    i64::MIN as u64,
    u64::MAX,
    0x7FF8_0000_0000_0000,
];

/// One to four edits of bytes and words, a cut, a piece moved, or bytes at random.
fn mutated(original: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = original.to_vec();
    // Headers are worth more than voxels.
    let place = |random: &mut Random, length: usize| {
        let end = random.pick(&[length, length.min(512), length.min(64)]);
        random.below(end.max(1))
    };
    for _ in 0..=random.below(4) {
        let length = bytes.len();
        match random.below(10) {
            0 => bytes.truncate(random.below(length + 1)),
            1 => {
                let (from, to) = (place(random, length), place(random, length));
                let count = random.below(64).min(length - from.max(to));
                bytes.copy_within(from..from + count, to);
            }
            2 => {
                let at = place(random, length);
                let count = random.below(32).min(length - at);
                bytes[at..at + count].iter_mut().for_each(|byte| *byte = random.next() as u8);
            }
            3 => {
                let at = place(random, length);
                let extra: Vec<u8> = (0..random.below(16)).map(|_| random.next() as u8).collect();
                bytes.splice(at.min(length)..at.min(length), extra);
            }
            4..=6 => {
                let width = random.pick(&[2usize, 4, 8]);
                let number = random.pick(&ODD).wrapping_add(random.pick(&[0, 0, 1, u64::MAX]));
                let at = place(random, length);
                if let Some(word) = bytes.get_mut(at..at + width) {
                    word.copy_from_slice(&number.to_le_bytes()[..width]);
                }
            }
            _ => {
                let at = place(random, length);
                if let Some(byte) = bytes.get_mut(at) {
                    *byte = if random.chance(0.5) { random.next() as u8 } else { *byte ^ 1 << random.below(8) };
                }
            }
        }
        if bytes.is_empty() {
            break;
        }
    }
    bytes
}

/// Reads all there is; says whether it was whole.
fn read_all(source: &mut dyn GridSource) -> bool {
    (0..source.grids().len()).fold(true, |whole, index| {
        let scalar = source.scalar(index).map(|grid| grid.is_finite());
        whole & (scalar.is_ok() || source.vectors(index).is_ok())
    })
}

/// Mutates files and reads them until the time is over.
fn hostile(name: &str, seed: u64, originals: &[Vec<u8>], read: impl Fn(&[u8]) -> bool) {
    assert!(!originals.is_empty());
    for (index, original) in originals.iter().enumerate() {
        assert!(read(original), "{name} {index} must be readable before it is damaged");
    }
    let (mut random, end) = (Random::new(seed), end());
    let (mut rounds, mut refused, mut most_bytes) = (0u64, 0u64, 0);
    while Instant::now() < end {
        let original = &originals[random.below(originals.len())];
        let bytes = match random.below(50) {
            0 => (0..random.below(4096)).map(|_| random.next() as u8).collect(),
            _ => mutated(original, &mut random),
        };
        let started = Instant::now();
        let mut whole = false;
        let seen = allocation_counter::measure(|| whole = read(&bytes));
        let allowed = BASE_BYTES + BYTES_PER_BYTE * bytes.len() as u64;
        assert!(seen.bytes_max <= allowed, "{name}, seed {seed}, round {rounds}: {} bytes", seen.bytes_max);
        assert!(started.elapsed() < LONGEST, "{name}, seed {seed}, round {rounds}: {:?}", started.elapsed());
        most_bytes = most_bytes.max(seen.bytes_max);
        refused += u64::from(!whole);
        rounds += 1;
    }
    println!("{name}, seed {seed}: {rounds} rounds, {refused} refused, at most {most_bytes} bytes");
    assert!(rounds > 20 && refused > rounds / 10, "{name}: {refused} of {rounds} refused");
}

fn read_vdb(bytes: &[u8]) -> bool {
    Vdb::open(bytes).is_ok_and(|mut vdb| read_all(&mut vdb))
}

#[test]
fn vdb() {
    let mut random = Random::new(100);
    let mut originals = vec![];
    for version in [220, 222, 224] {
        let codecs: &[u32] =
            if version < 222 { &[ZIP] } else { &[ACTIVE_MASK, ZIP | ACTIVE_MASK, BLOSC | ACTIVE_MASK] };
        for (index, compression) in codecs.iter().enumerate() {
            let form = Form { version, compression: *compression, half: index % 2 == 0, offsets: index != 1 };
            let plans = [
                Plan::new("flame", "float"),
                Plan::new("velocity", "vec3s"),
                Plan::new("mask", "bool"),
                Plan::instance("again", "float", "flame"),
            ];
            // What is read sooner is read more often.
            let files = (0..8).map(|_| write(form, &plans, &mut random));
            let tiles = |file: &VdbFile| file.written.iter().flatten().map(|tree| tree.tiles.len()).sum::<usize>();
            originals.push(files.min_by_key(tiles).unwrap().bytes);
        }
    }
    if let Some(folder) = flame_cache() {
        originals.push(std::fs::read(folder.join("fluid_data_0001.vdb")).unwrap());
    }
    hostile("vdb", 101, &originals, read_vdb);
}

fn frame_bytes() -> Vec<u8> {
    let mut random = Random::new(200);
    let flame: Vec<[f32; 1]> = (0..60).map(|_| [random.below(9) as f32]).collect();
    let velocity: Vec<[f32; 3]> = (0..60).map(|_| [random.below(9) as f32; 3]).collect();
    let frame = DenseFrame {
        shape: [3, 4, 5],
        flame: &flame,
        velocity: &velocity,
        voxel_size: 0.1,
        origin: [1.0; 3],
        time_s: None,
    };
    let mut out = Cursor::new(vec![]);
    write_frame(&mut out, &frame).unwrap();
    out.into_inner()
}

fn npy(shape: &str, order: &str, data: usize) -> Vec<u8> {
    let text = format!("{{'descr': '<f4', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(text.len() as u16).to_le_bytes()[..], text.as_bytes(), &vec![1; data]].concat()
}

/// An archive of one array.
fn archived(array: &[u8]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(vec![]));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    archive.start_file("flame.npy", options).unwrap();
    std::io::Write::write_all(&mut archive, array).unwrap();
    archive.finish().unwrap().into_inner()
}

fn read_npz(bytes: &[u8]) -> bool {
    Npz::open(Cursor::new(bytes)).is_ok_and(|mut npz| read_all(&mut npz))
}

#[test]
fn npz() {
    hostile("npz", 201, &[frame_bytes(), archived(&npy("(2, 2, 2)", "False", 32))], read_npz);
}

#[test]
fn arrays_behind_a_right_sum() {
    let arrays = [npy("(3, 4, 5)", "False", 240), npy("(3, 4, 5, 3)", "True", 720), npy("(9, 1, 0)", "False", 0)];
    hostile("arrays in archives", 251, &arrays, |bytes| read_npz(&archived(bytes)));
}

#[test]
fn npy_and_tables() {
    let folder = tempfile::tempdir().unwrap();
    let array = folder.path().join("series.npy");
    let table = folder.path().join("series.csv");
    let read = |bytes: &[u8]| {
        let is_array = bytes.first() == Some(&0x93);
        let path = if is_array { &array } else { &table };
        std::fs::write(path, bytes).unwrap();
        let series = Series::read(path).is_ok();
        let field = Npy::open(&[("flame".into(), array.clone())]).is_ok_and(|mut npy| read_all(&mut npy));
        series || (is_array && field)
    };
    let originals = [
        npy("(3, 4, 5)", "False", 240),
        npy("(3, 4, 5, 3)", "True", 720),
        npy("(16,)", "False", 64),
        b"frame,flux,area\n1,0.5,1\n2,-1e-3,1\n3,7,1\n".to_vec(),
        b"time_s,flux\n0,1\n0.5,2\n1,3\n".to_vec(),
    ];
    hostile("npy and tables", 301, &originals, read);
}
