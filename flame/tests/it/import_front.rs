//! Frames of which only the flow at the front is read, beside the same frames read whole.

use crate::common::flame_cache;
use crate::import_common::Random;
use crate::import_common::trees::small_tree;
use crate::import_common::vdb::{BLOSC, Form, Plan, VdbFile, ZIP, write};
use pyrophone_flame::grid::{Region, Transform};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use pyrophone_flame::import::vdb::Vdb;
use pyrophone_flame::import::{GridSource, PlacementChoice, Selection, Sequence};
use pyrophone_flame::velocity::Velocity;
use pyrophone_flame::{Error, Front};

/// Number of blocks in a velocity.
fn blocks(velocity: &Velocity) -> usize {
    match velocity {
        Velocity::Vectors(grid, _) => grid.blocks().count(),
        Velocity::Components(grids) => grids.iter().map(|grid| grid.blocks().count()).sum(),
    }
}

/// Asserts that a frame has a flux, the same in both ways of reading it; returns how many blocks of flow each has read.
fn assert_same(sequence: &Sequence, index: usize, selection: &Selection, front: &Front, what: &str) -> [usize; 2] {
    let whole = sequence.read(index, selection).unwrap();
    let part = sequence.read_front(index, selection, front).unwrap();
    assert_eq!(part.field, whole.field, "{what}");
    let measured = [&whole, &part].map(|frame| front.measure(frame).unwrap());
    assert!(measured[0].flux != 0.0, "{what}");
    assert_eq!(measured[1], measured[0], "{what}");
    [blocks(&whole.velocity), blocks(&part.velocity)]
}

#[test]
fn only_the_flow_at_the_front_is_needed() {
    // Flows on the field's own voxels, on coarser ones, and on turned ones that lie elsewhere.
    let maps: [(&'static str, Vec<f64>); 3] = [
        ("UniformScaleMap", [vec![0.5; 6], vec![2.0; 3], vec![4.0; 3], vec![1.0; 3]].concat()),
        ("UniformScaleMap", [vec![1.7; 6], vec![1.0 / 1.7; 3], vec![1.0 / 1.7f64.powi(2); 3], vec![0.85; 3]].concat()),
        ("AffineMap", vec![0.3, 0.4, 0., 0., -0.4, 0.3, 0., 0., 0., 0., 0.5, 0., 3., -2., 7., 1.]),
    ];
    let mut read = [0, 0];
    for seed in 0..30 {
        let mut random = Random::new(seed);
        let (map, numbers) = &maps[seed as usize % 3];
        let compression = [0, ZIP, BLOSC][seed as usize / 3 % 3];
        let form = Form { version: 224, compression, half: seed % 2 == 0, offsets: seed % 4 < 2 };
        let mut grid = |name: &str, kind, leaves| {
            let tree = Some(small_tree(form, kind, leaves, &mut random));
            Plan { tree, ..Plan::new(name, kind) }
        };
        let mut plans = vec![grid("flame", "float", 6)];
        match seed % 5 {
            0 => plans.extend(["vel.x", "vel.y", "vel.z"].map(|name| grid(name, "float", 300).placed(map, numbers))),
            _ => plans.extend(["vel", "vel\u{1e}1"].map(|name| grid(name, "vec3s", 300).placed(map, numbers))),
        }
        let VdbFile { bytes, .. } = write(form, &plans, &mut Random::new(seed));
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.1.vdb"), bytes).unwrap();
        let sequence = Sequence::open(folder.path()).unwrap();
        for (placement, iso) in [(PlacementChoice::Collocated, 1.0), (PlacementChoice::Staggered, 3.1)] {
            let selection = Selection { placement, velocity_scale: 2.5, ..Selection::default() };
            let front = Front::new(iso, 2).unwrap();
            let [whole, part] = assert_same(&sequence, 0, &selection, &front, &format!("seed {seed}, {placement:?}"));
            read = [read[0] + whole, read[1] + part];
        }
    }
    assert!(read[1] > 0 && read[1] < 2 * read[0] / 3, "{read:?}");
}

#[test]
fn arrays_are_read_at_the_front_alone() {
    let shape = [40, 16, 24];
    let index = |n: usize| [n / (16 * 24), n / 24 % 16, n % 24].map(|i| i as f32);
    let count = shape.iter().product();
    let flame: Vec<[f32; 1]> = (0..count).map(index).map(|[x, ..]| [if x < 5.0 { 1.0 } else { 0.0 }]).collect();
    let velocity: Vec<[f32; 3]> = (0..count).map(index).map(|[x, y, z]| [1.0 + x * x, y - z, 0.3 * z]).collect();
    let frame = DenseFrame {
        shape,
        voxel_size: 0.1,
        origin: [1.0, 2.0, 3.0],
        time_s: Some(0.5),
        flame: &flame,
        velocity: &velocity,
    };
    let folder = tempfile::tempdir().unwrap();
    write_frame(std::fs::File::create(folder.path().join("a.1.npz")).unwrap(), &frame).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    let found = assert_same(&sequence, 0, &Selection::default(), &Front::new(0.5, 3).unwrap(), "npz");
    // Of five blocks along x, the one with the front and the next.
    assert_eq!(found, [30, 12]);
}

#[test]
fn reference_cache_measures_the_same() {
    let Some(folder) = flame_cache() else { return };
    let sequence = Sequence::open(&folder).unwrap();
    for index in (0..sequence.len()).step_by(45) {
        let front = Front::new(0.5, 3).unwrap();
        assert_same(&sequence, index, &Selection::default(), &front, &format!("frame {index}"));
    }
}

#[test]
fn a_front_without_an_end_is_reported_when_it_is_measured() {
    // A background of 1 with a few leaves in it.
    let mut random = Random::new(2);
    let form = Form { version: 224, compression: 0, half: false, offsets: true };
    let mut grid = |name: &str, kind, background: f32| {
        let (mut topology, leaves) = small_tree(form, kind, 3, &mut random);
        topology[4..8].copy_from_slice(&background.to_le_bytes());
        Plan { tree: Some((topology, leaves)), ..Plan::new(name, kind) }
    };
    let plans = [grid("flame", "float", 1.0), grid("vel", "vec3s", 0.0)];
    let VdbFile { bytes, .. } = write(form, &plans, &mut Random::new(3));
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.1.vdb"), bytes).unwrap();
    let front = Front::new(0.5, 1).unwrap();
    let sequence = Sequence::open(folder.path()).unwrap();
    let frame = sequence.read_front(0, &Selection::default(), &front).unwrap();
    assert!(matches!(front.measure(&frame), Err(Error::Unbounded { .. })));
}

#[test]
fn leaves_outside_a_region_are_left_out_in_every_type() {
    let nowhere = Region::new([], Transform::identity());
    let form = Form { version: 224, compression: ZIP, half: false, offsets: true };
    for seed in 0..10 {
        let plans = ["bool", "float", "int32", "half"].map(|kind| Plan::new(kind, kind));
        let VdbFile { bytes, written } = write(form, &plans, &mut Random::new(seed));
        let mut vdb = Vdb::open(&bytes).unwrap();
        for (index, written) in written.iter().enumerate() {
            let whole = vdb.scalar(index).unwrap();
            let part = vdb.scalar_within(index, Some(&nowhere)).unwrap();
            assert_eq!(whole.blocks().count(), written.as_ref().unwrap().leaves.len());
            assert_eq!(part.blocks().count(), 0, "seed {seed}, grid {index}");
            assert!(part.tiles().eq(whole.tiles()));
        }
    }
}
