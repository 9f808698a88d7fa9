//! NumPy arrays in folders and archives, written here byte by byte and read back.

use std::io::{Cursor, Write};
use std::path::Path;

use crate::import_common::Random;
use half::f16;
use proptest::prelude::*;
use pyrophone_flame::grid::Grid;
use pyrophone_flame::import::npz::{DenseFrame, Npz, write_frame};
use pyrophone_flame::import::{Error, FormatFault, GridSource, Selection, Sequence, Series, Timing};
use pyrophone_flame::velocity::Velocity;

/// A `.npy` of version `major`.
fn npy(major: u8, descr: &str, fortran_order: bool, shape: &[usize], data: &[u8]) -> Vec<u8> {
    let order = if fortran_order { "True" } else { "False" };
    let lengths: String = shape.iter().map(|length| format!("{length},")).collect();
    let text = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({lengths}), }}\n");
    let mut bytes = [b"\x93NUMPY", &[major, 0][..]].concat();
    if major == 1 {
        bytes.extend((text.len() as u16).to_le_bytes());
    } else {
        bytes.extend((text.len() as u32).to_le_bytes());
    }
    [bytes, text.into_bytes(), data.to_vec()].concat()
}

fn encoded(descr: &str, value: f32) -> Vec<u8> {
    let mut bytes = match &descr[1..] {
        "f2" => f16::from_f32(value).to_le_bytes().to_vec(),
        "f4" => value.to_le_bytes().to_vec(),
        "f8" => f64::from(value).to_le_bytes().to_vec(),
        "i1" => (value as i8).to_le_bytes().to_vec(),
        "u1" => (value as u8).to_le_bytes().to_vec(),
        "i2" => (value as i16).to_le_bytes().to_vec(),
        "u2" => (value as u16).to_le_bytes().to_vec(),
        "i4" => (value as i32).to_le_bytes().to_vec(),
        "u4" => (value as u32).to_le_bytes().to_vec(),
        "i8" => (value as i64).to_le_bytes().to_vec(),
        "u8" => (value as u64).to_le_bytes().to_vec(),
        other => panic!("{other}"),
    };
    if descr.starts_with('>') {
        bytes.reverse();
    }
    bytes
}

/// The value of a test field at an index: small, whole, never negative, often zero.
fn pattern(index: [usize; 3], component: usize) -> f32 {
    let number = index[0] * 7 + index[1] * 3 + index[2] * 5 + component * 11;
    if number.is_multiple_of(3) { 0.0 } else { (number % 100) as f32 }
}

/// The test field in an order of axes (3: component), the last one fastest.
fn data(descr: &str, shape: [usize; 3], axes: &[usize]) -> Vec<u8> {
    let length = |axis: usize| if axis == 3 { 3 } else { shape[axis] };
    let count: usize = axes.iter().map(|axis| length(*axis)).product();
    let mut bytes = vec![];
    for number in 0..count {
        let (mut rest, mut at) = (number, [0; 4]);
        for axis in axes.iter().rev() {
            at[*axis] = rest % length(*axis);
            rest /= length(*axis);
        }
        bytes.extend(encoded(descr, pattern([at[0], at[1], at[2]], at[3])));
    }
    bytes
}

fn assert_pattern<const N: usize>(grid: &Grid<N>, shape: [usize; 3], what: &str) {
    for x in 0..shape[0] + 2 {
        for y in 0..shape[1] + 2 {
            for z in 0..shape[2] + 2 {
                let inside = x < shape[0] && y < shape[1] && z < shape[2];
                let expected = std::array::from_fn(|of| if inside { pattern([x, y, z], of) } else { 0.0 });
                assert_eq!(grid.value([x, y, z].map(|i| i as i32)), expected, "{what} at {x}, {y}, {z}");
            }
        }
    }
    assert_eq!(grid.value([-1, 0, 0]), [0.0; N]);
}

/// A zip of stored members as numpy.savez writes it: sizes in the local header are 0xFFFFFFFF and follow in a zip64
/// field, those in the directory are plain.
fn savez(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let (mut bytes, mut directory) = (vec![], vec![]);
    for (name, data) in members {
        let start = bytes.len() as u32;
        let (crc, size) = (crc32(data), data.len() as u32);
        let common = [&0u16.to_le_bytes()[..], &[0, 0], &[0, 0, 0x21, 0], &crc.to_le_bytes()].concat();
        bytes.extend([b"PK\x03\x04", &45u16.to_le_bytes()[..], &common, &[0xFF; 8]].concat());
        bytes.extend([(name.len() as u16).to_le_bytes(), 20u16.to_le_bytes()].concat());
        bytes.extend(name.bytes());
        bytes.extend([1u16.to_le_bytes(), 16u16.to_le_bytes()].concat());
        bytes.extend([u64::from(size).to_le_bytes(), u64::from(size).to_le_bytes()].concat());
        bytes.extend(data);
        directory.extend([b"PK\x01\x02", &[45, 3, 45, 0][..], &common].concat());
        directory.extend([size.to_le_bytes(), size.to_le_bytes()].concat());
        directory.extend((name.len() as u16).to_le_bytes());
        directory.extend([0; 8]);
        directory.extend([0x180u32.to_le_bytes(), start.to_le_bytes()].concat());
        directory.extend(name.bytes());
    }
    let start = bytes.len() as u32;
    bytes.extend(&directory);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend([(members.len() as u16).to_le_bytes(), (members.len() as u16).to_le_bytes()].concat());
    bytes.extend([(directory.len() as u32).to_le_bytes(), start.to_le_bytes()].concat());
    bytes.extend([0, 0]);
    bytes
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

fn deflated(members: &[(&str, Vec<u8>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(vec![]));
    for (name, data) in members {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(data).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

fn open(bytes: &[u8]) -> Result<Npz<Cursor<&[u8]>>, FormatFault> {
    Npz::open(Cursor::new(bytes))
}

#[test]
fn every_type_order_and_layout() {
    let shape = [9, 2, 17];
    let [x, y, z] = shape;
    for descr in ["f2", "f4", "f8", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8"] {
        for descr in [format!("<{descr}"), format!(">{descr}")] {
            for (fortran_order, major) in [(false, 1), (true, 2), (false, 3)] {
                // In Fortran's order the first axis is fastest.
                let array = |axes: &[usize], shape: &[usize]| {
                    let mut stored = axes.to_vec();
                    if fortran_order {
                        stored.reverse();
                    }
                    npy(major, &descr, fortran_order, shape, &data(&descr, [x, y, z], &stored))
                };
                let bytes = savez(&[
                    ("flame.npy", array(&[0, 1, 2], &[x, y, z])),
                    ("velocity.npy", array(&[0, 1, 2, 3], &[x, y, z, 3])),
                    ("wind.npy", array(&[3, 0, 1, 2], &[3, x, y, z])),
                ]);
                let what = format!("{descr}, version {major}");
                let mut npz = open(&bytes).unwrap();
                assert_pattern(&npz.scalar(0).unwrap(), shape, &what);
                assert_pattern(&npz.vectors(1).unwrap(), shape, &what);
                assert_pattern(&npz.vectors(2).unwrap(), shape, &what);
                assert!(npz.scalar(1).is_err() && npz.vectors(0).is_err() && npz.scalar(3).is_err());
            }
        }
    }
}

#[test]
fn archives_stored_and_packed() {
    let flame = npy(1, "<f4", false, &[2, 3, 4], &data("<f4", [2, 3, 4], &[0, 1, 2]));
    let numbers = |numbers: &[f64]| numbers.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    let members = [
        ("flame.npy", flame),
        ("voxel_size.npy", npy(1, "<f8", false, &[], &numbers(&[0.25]))),
        ("origin.npy", npy(1, "<f8", false, &[3], &numbers(&[1.0, 2.0, 3.0]))),
        ("readme.txt", b"not an array".to_vec()),
        ("pickled.npy", npy(1, "|O", false, &[1], b"xxxx")),
    ];
    for bytes in [savez(&members), deflated(&members)] {
        let mut npz = open(&bytes).unwrap();
        let names: Vec<_> = npz.grids().iter().map(|grid| grid.name.clone()).collect();
        assert_eq!(names, ["flame", "pickled"]);
        assert_eq!(npz.grids()[0].kind, "<f4 (2, 3, 4)");
        let grid = npz.scalar(0).unwrap();
        assert_pattern(&grid, [2, 3, 4], "flame");
        assert_eq!(grid.transform().to_world([0.0, 0.0, 4.0]), [1.0, 2.0, 4.0]);
        assert!(matches!(npz.scalar(1), Err(FormatFault::Unsupported { .. })));
    }
}

#[test]
fn archives_that_contradict_themselves() {
    let flame = npy(1, "<f4", false, &[2, 3, 4], &data("<f4", [2, 3, 4], &[0, 1, 2]));
    let number = |value: f64| npy(1, "<f8", false, &[], &value.to_le_bytes());
    let refused = |bytes: &[u8], what: &str| {
        let fault = open(bytes).and_then(|mut npz| npz.scalar(0));
        assert!(fault.is_err(), "{what}");
    };
    let good = savez(&[("flame.npy", flame.clone())]);
    assert!(open(&good).unwrap().scalar(0).is_ok());
    // The data's sum: one bit of the last value.
    let mut flipped = good.clone();
    let last = 30 + 9 + 20 + flame.len() - 1;
    flipped[last] ^= 1;
    refused(&flipped, "wrong sum");
    refused(&savez(&[("flame.npy", flame[..flame.len() - 1].to_vec())]), "too short");
    refused(&savez(&[("flame.npy", [flame.clone(), vec![0]].concat())]), "too long");
    refused(&savez(&[("flame.npy", flame.clone()), ("flame.npy", flame.clone())]), "one name twice");
    refused(&savez(&[("a/flame.npy", flame.clone()), ("b/flame.npy", flame.clone())]), "one base name twice");
    for value in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-300, 1e300] {
        refused(&savez(&[("flame.npy", flame.clone()), ("voxel_size.npy", number(value))]), "voxel size");
    }
    refused(&savez(&[("flame.npy", flame.clone()), ("origin.npy", number(1.0))]), "origin of one number");
    // Two entries of the directory for the same bytes.
    let two = savez(&[("flame.npy", flame.clone()), ("other.npy", flame)]);
    let mut overlapping = two.clone();
    let entry = two.windows(4).rposition(|four| four == b"PK\x01\x02").unwrap();
    overlapping[entry + 42..entry + 46].fill(0);
    refused(&overlapping, "overlap");
}

#[test]
fn archive_bomb_of_zeros_uses_no_memory() {
    // 134 million voxels in half a megabyte.
    let shape = [512, 512, 512];
    let header = npy(1, "|u1", false, &shape, &[]);
    let mut archive = zip::ZipWriter::new(Cursor::new(vec![]));
    archive.start_file("flame.npy", zip::write::SimpleFileOptions::default()).unwrap();
    archive.write_all(&header).unwrap();
    let zeros = vec![0; 1 << 20];
    (0..128).for_each(|_| archive.write_all(&zeros).unwrap());
    let bytes = archive.finish().unwrap().into_inner();
    assert!(bytes.len() < 1 << 20);
    let seen = allocation_counter::measure(|| {
        let grid = open(&bytes).unwrap().scalar(0).unwrap();
        assert_eq!(grid.blocks().count(), 0);
    });
    assert!(seen.bytes_max < 16 << 20, "{} bytes", seen.bytes_max);
}

#[test]
fn thin_arrays_do_not_unfold_beyond_their_budget() {
    // Each value is alone in its block.
    let refused = |shape: &[usize]| {
        let data = vec![1; shape.iter().product()];
        let bytes = deflated(&[("flame.npy", npy(1, "|u1", false, shape, &data))]);
        let seen = allocation_counter::measure(|| {
            let read = open(&bytes).unwrap().scalar(0);
            assert!(matches!(read, Err(FormatFault::TooLarge { .. })), "{shape:?}");
        });
        assert!(seen.bytes_max < (256 << 20) + 80 * bytes.len() as u64, "{} bytes", seen.bytes_max);
    };
    refused(&[1, 1, (1 << 20) + 1]);
    refused(&[4000, 1, 4000]);
}

fn write(frame: &DenseFrame) -> Vec<u8> {
    let mut out = Cursor::new(vec![]);
    write_frame(&mut out, frame).unwrap();
    out.into_inner()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_written_is_read(shape in [1usize..20, 1usize..20, 1usize..20], seed: u64, sparse: bool) {
        let mut random = Random::new(seed);
        let mut value = || match random.below(8) {
            0 => -0.0,
            1 => f32::MIN_POSITIVE / 8.0,
            2 => f32::MAX,
            _ if sparse => 0.0,
            _ => f32::from_bits(random.next() as u32 & 0xBF7F_FFFF),
        };
        let voxels = shape.iter().product();
        let flame: Vec<[f32; 1]> = (0..voxels).map(|_| [value()]).collect();
        let velocity: Vec<[f32; 3]> = (0..voxels).map(|_| [value(), value(), value()]).collect();
        let (voxel_size, origin) = (0.1, [-1.0, 1.0 / 3.0, 1e6]);
        let frame = DenseFrame { shape, flame: &flame, velocity: &velocity, voxel_size, origin, time_s: Some(0.125) };
        let bytes = write(&frame);
        prop_assert_eq!(&bytes, &write(&frame));

        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("frame_7.npz"), &bytes).unwrap();
        let found = Sequence::open(folder.path()).unwrap().read(0, &Selection::default()).unwrap();
        prop_assert_eq!(found.number, 7);
        prop_assert_eq!(found.field.transform().to_world([1.0, 0.0, 0.0]), [0.1 + -1.0, 1.0 / 3.0, 1e6]);
        let Velocity::Vectors(vectors, _) = found.velocity else { panic!() };
        for (number, (flame, velocity)) in flame.iter().zip(&velocity).enumerate() {
            let [_, y, z] = shape;
            let index = [number / z / y, number / z % y, number % z].map(|i| i as i32);
            prop_assert_eq!(found.field.value(index).map(f32::to_bits), flame.map(f32::to_bits));
            prop_assert_eq!(vectors.value(index).map(f32::to_bits), velocity.map(f32::to_bits));
        }
    }
}

#[test]
fn a_frame_is_written_for_numpy() {
    let frame = DenseFrame {
        shape: [1, 1, 2],
        flame: &[[1.0], [0.5]],
        velocity: &[[0.0; 3]; 2],
        voxel_size: 0.5,
        origin: [0.0; 3],
        time_s: Some(2.0),
    };
    let bytes = write(&frame);
    let mut archive = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    let mut members = vec![];
    for index in 0..archive.len() {
        let mut member = archive.by_index(index).unwrap();
        assert_eq!(member.last_modified(), Some(zip::DateTime::default()));
        let name = member.name().unwrap().into_owned();
        let mut data = vec![];
        std::io::Read::read_to_end(&mut member, &mut data).unwrap();
        members.push((name, data));
    }
    let names: Vec<_> = members.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["flame.npy", "velocity.npy", "voxel_size.npy", "origin.npy", "time_s.npy"]);
    let text = b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 1, 2), }";
    assert_eq!(members[0].1[10..10 + text.len()], text[..]);
    assert_eq!(members[0].1[128..], [1f32.to_le_bytes(), 0.5f32.to_le_bytes()].concat());
    assert_eq!(members[4].1[128..], 2f64.to_le_bytes());
    for wrong in [DenseFrame { flame: &[[1.0]], ..frame }, DenseFrame { shape: [usize::MAX, 2, 1], ..frame }] {
        assert!(matches!(write_frame(Cursor::new(vec![]), &wrong), Err(FormatFault::Grid(_))));
    }
}

fn put(folder: &Path, name: &str, bytes: &[u8]) {
    std::fs::write(folder.join(name), bytes).unwrap();
}

#[test]
fn folders_of_single_arrays() {
    let folder = tempfile::tempdir().unwrap();
    let shape = [3, 4, 5];
    let flame = npy(1, "<f4", false, &shape, &data("<f4", shape, &[0, 1, 2]));
    let velocity = npy(1, "<f4", false, &[3, 4, 5, 3], &data("<f4", shape, &[0, 1, 2, 3]));
    for number in [8, 9, 11] {
        put(folder.path(), &format!("flame_{number:04}.npy"), &flame);
        put(folder.path(), &format!("velocity.{number}.npy"), &velocity);
    }
    std::fs::remove_file(folder.path().join("velocity.11.npy")).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    assert_eq!((sequence.numbers().collect::<Vec<_>>(), sequence.missing()), (vec![8, 9, 11], vec![10]));
    let frame = sequence.read(1, &Selection::default()).unwrap();
    assert_eq!(frame.number, 9);
    assert_pattern(&frame.field, shape, "flame");
    assert_eq!(frame.field.transform().to_world([1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
    let message = sequence.read(2, &Selection::default()).unwrap_err().to_string();
    assert!(message.contains("\"velocity\"") && message.contains("flame (<f4 (3, 4, 5))"), "{message}");
    put(folder.path(), "velocity.8.npy", &velocity[..velocity.len() - 1]);
    let message = sequence.read(0, &Selection::default()).unwrap_err().to_string();
    assert!(message.contains("velocity"), "{message}");
}

#[test]
fn numbers_far_apart() {
    let folder = tempfile::tempdir().unwrap();
    put(folder.path(), "a_1.npz", b"");
    put(folder.path(), "a_1000002.npz", b"");
    let sequence = Sequence::open(folder.path()).unwrap();
    assert_eq!(sequence.missing().len(), 1_000_000);
    put(folder.path(), &format!("a_{}.npz", i64::MAX), b"");
    let found = Sequence::open(folder.path());
    assert!(matches!(found, Err(Error::Gap { first: 1, last: i64::MAX, .. })), "{found:?}");
}

#[test]
fn series_of_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let numbers = |values: &[f64]| values.iter().flat_map(|x| x.to_be_bytes()).collect::<Vec<u8>>();
    put(folder.path(), "flux.npy", &npy(1, ">f8", false, &[3], &numbers(&[1.0, -2.0, 0.5])));
    let series = Series::read(&folder.path().join("flux.npy")).unwrap();
    assert_eq!(series, Series { timing: Timing::Frames(0), values: vec![1.0, -2.0, 0.5], rate_hz: None });
    for (name, bytes) in [
        ("nan.npy", npy(1, ">f8", false, &[2], &numbers(&[1.0, f64::NAN]))),
        ("empty.npy", npy(1, ">f8", false, &[0], &[])),
        ("table.npy", npy(1, ">f8", false, &[2, 1], &numbers(&[1.0, 1.0]))),
        ("short.npy", npy(1, ">f8", false, &[3], &numbers(&[1.0, 1.0]))),
    ] {
        put(folder.path(), name, &bytes);
        let message = Series::read(&folder.path().join(name)).unwrap_err().to_string();
        assert!(message.contains(name), "{message}");
    }
    put(folder.path(), "flux.csv", b"time_s,flux\n0,1\n0.5,2\n");
    let series = Series::read(&folder.path().join("flux.csv")).unwrap();
    assert_eq!((series.timing, series.rate_hz), (Timing::Times(vec![0.0, 0.5]), Some(2.0)));
    assert!(matches!(Series::read(folder.path()), Err(Error::Unreadable { .. })));
    assert!(matches!(Series::read(&folder.path().join("none.csv")), Err(Error::Missing { .. })));
}
