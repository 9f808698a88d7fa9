//! OpenVDB files of every version, codec, flag and shape, written here and read back.

use crate::import_common::Random;
use crate::import_common::trees::{Written, components};
use crate::import_common::vdb::{ACTIVE_MASK, BLOSC, Form, Plan, VdbFile, ZIP, doubles, text, write};
use pyrophone_flame::grid::Grid;
use pyrophone_flame::import::vdb::Vdb;
use pyrophone_flame::import::{FormatFault, GridSource, PlacementChoice, Selection, Sequence};
use pyrophone_flame::velocity::Velocity;

fn assert_same<const N: usize>(found: &Grid<N>, written: &Written, what: &str) {
    assert_eq!(found.background().as_slice(), &written.background[..N], "{what}: background");
    let expected = written.leaves.iter().map(|(origin, values)| (origin.map(|i| i / 8), values));
    assert_eq!(found.blocks().count(), written.leaves.len(), "{what}: leaves");
    for ((key, block), (expected_key, values)) in found.blocks().zip(expected) {
        assert_eq!(key, expected_key, "{what}");
        for (slot, (found, expected)) in block.iter().zip(values).enumerate() {
            assert_eq!(found.as_slice(), &expected[..N], "{what}: leaf {key:?}, slot {slot}");
        }
    }
    assert_eq!(found.tiles().count(), written.tiles.len(), "{what}: tiles");
    for (origin, log2, value) in found.tiles() {
        assert_eq!(
            Some(value.as_slice()),
            written.tiles.get(&(log2, origin)).map(|value| &value[..N]),
            "{what}: {origin:?}"
        );
    }
}

fn read_and_compare(vdb: &mut Vdb, index: usize, kind: &str, written: &Written, what: &str) {
    if components(kind) == 3 {
        assert_same(&vdb.vectors(index).unwrap_or_else(|fault| panic!("{what}: {fault}")), written, what);
    } else {
        assert_same(&vdb.scalar(index).unwrap_or_else(|fault| panic!("{what}: {fault}")), written, what);
    }
}

/// Every version with every codec; halves and offsets in turn.
fn forms() -> impl Iterator<Item = Form> {
    (220..=225).flat_map(|version| {
        let codecs: &[u32] = if version < 222 {
            &[0, ZIP, 0, ZIP]
        } else {
            &[0, ZIP, ACTIVE_MASK, ZIP | ACTIVE_MASK, BLOSC, BLOSC | ACTIVE_MASK, ZIP | BLOSC | ACTIVE_MASK]
        };
        codecs.iter().enumerate().map(move |(index, compression)| Form {
            version,
            compression: *compression,
            half: (index + version as usize / 2).is_multiple_of(2),
            offsets: (index / 2 + version as usize).is_multiple_of(2),
        })
    })
}

#[test]
fn every_version_codec_and_type() {
    let mut random = Random::new(1);
    let (mut flags, mut leaves, mut tiles) = ([0; 7], 0, [0; 3]);
    for form in forms() {
        let mut kinds = vec!["float", "vec3s", "double", "vec3d", "int32", "bool"];
        if form.version == 225 {
            kinds.push("half");
        }
        let plans: Vec<Plan> = kinds.iter().map(|kind| Plan::new(kind, kind)).collect();
        let VdbFile { bytes, written } = write(form, &plans, &mut random);
        let mut vdb = Vdb::open(&bytes).unwrap_or_else(|fault| panic!("{form:?}: {fault}"));
        for (index, (kind, written)) in kinds.iter().zip(&written).enumerate() {
            let written = written.as_ref().unwrap();
            read_and_compare(&mut vdb, index, kind, written, &format!("{form:?}, {kind}"));
            flags.iter_mut().zip(written.flags).for_each(|(sum, count)| *sum += count);
            leaves += written.leaves.len();
            for (log2, _) in written.tiles.keys() {
                tiles[[3, 7, 12].iter().position(|known| known == log2).unwrap()] += 1;
            }
        }
    }
    // The trees must have had something to get wrong.
    assert!(flags.iter().all(|count| *count > 20), "{flags:?}");
    assert!(leaves > 1000 && tiles.iter().all(|count| *count > 100), "{leaves} {tiles:?}");
}

#[test]
fn values_by_index() {
    let mut random = Random::new(2);
    let form = Form { version: 224, compression: BLOSC | ACTIVE_MASK, half: true, offsets: true };
    let VdbFile { bytes, written } = write(form, &[Plan::new("flame", "float")], &mut random);
    let written = written[0].as_ref().unwrap();
    let grid = Vdb::open(&bytes).unwrap().scalar(0).unwrap();
    let mut places: Vec<[i32; 3]> = written.leaves.keys().copied().collect();
    places.extend(written.tiles.keys().map(|(_, origin)| *origin).take(500));
    assert!(places.len() > 3);
    for place in places {
        for _ in 0..20 {
            let index = place.map(|i| i + random.below(24) as i32 - 8);
            let leaf = written.leaves.get(&index.map(|i| i >> 3 << 3));
            let slot = index.iter().fold(0, |slot, i| slot << 3 | (*i & 7) as usize);
            let tile =
                || [3, 7, 12].iter().find_map(|log2| written.tiles.get(&(*log2, index.map(|i| i >> log2 << log2))));
            let expected = leaf.map(|leaf| &leaf[slot]).or_else(tile).unwrap_or(&written.background);
            assert_eq!(grid.value(index)[0], expected[0], "{index:?}");
        }
    }
}

#[test]
fn instances_share_a_tree_and_have_a_place_of_their_own() {
    let mut random = Random::new(3);
    for offsets in [true, false] {
        let form = Form { version: 223, compression: ZIP, half: false, offsets };
        let plans = [
            Plan::instance("b", "float", "a").placed("TranslationMap", &[1.0, 2.0, 3.0]),
            Plan::new("a", "float"),
            Plan::instance("of an instance", "float", "b"),
            Plan::instance("of another type", "vec3s", "a"),
            Plan::instance("of nothing", "float", "c"),
        ];
        let VdbFile { bytes, written } = write(form, &plans, &mut random);
        let mut vdb = Vdb::open(&bytes).unwrap();
        let (instance, own) = (vdb.scalar(0).unwrap(), vdb.scalar(1).unwrap());
        assert_same(&instance, written[1].as_ref().unwrap(), "instance");
        assert_same(&own, written[1].as_ref().unwrap(), "parent");
        assert_eq!(instance.transform().to_world([0.0; 3]), [1.0, 2.0, 3.0]);
        assert_eq!(own.transform().to_world([1.0; 3]), [0.5; 3]);
        for (index, fault) in [(2, vdb.scalar(2).err()), (3, vdb.vectors(3).err()), (4, vdb.scalar(4).err())] {
            assert!(matches!(fault, Some(FormatFault::Damaged(_))), "{index}: {fault:?}");
        }
    }
}

#[test]
fn maps_of_every_kind() {
    let mut random = Random::new(4);
    let rest = [0.0; 12];
    let scale = |edges: [f64; 3]| [&edges[..], &rest].concat();
    let moved = |edges: [f64; 3]| [&[10.0, 20.0, 30.0], &edges[..], &rest].concat();
    let turned = [0.0, 2.0, 0.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let cases = [
        (Plan::new("a", "float").placed("UniformScaleMap", &scale([0.1; 3])), Some([0.1, 0.2, 0.3])),
        (Plan::new("b", "float").placed("ScaleMap", &scale([1.0, -2.0, 3.0])), Some([1.0, -4.0, 9.0])),
        (Plan::new("c", "float").placed("UniformScaleTranslateMap", &moved([1.0; 3])), Some([11.0, 22.0, 33.0])),
        (Plan::new("d", "float").placed("ScaleTranslateMap", &moved([1.0, 2.0, 3.0])), Some([11.0, 24.0, 39.0])),
        (Plan::new("e", "float").placed("TranslationMap", &[1.0, 1.0, 1.0]), Some([2.0, 3.0, 4.0])),
        (Plan::new("f", "float").placed("AffineMap", &turned), Some([-3.0, 3.0, 13.0])),
        (Plan::new("g", "float").placed("ScaleMap", &scale([1.0, 0.0, 1.0])), None),
        (Plan::new("h", "float").placed("ScaleMap", &scale([f64::NAN; 3])), None),
        (Plan::new("i", "float").placed("ScaleMap", &scale([1e300; 3])), None),
        (Plan::new("j", "float").placed("AffineMap", &[1.0; 16]), None),
        (Plan::new("k", "float").placed("SpiralMap", &scale([1.0; 3])), None),
    ];
    let form = Form { version: 224, compression: BLOSC, half: false, offsets: true };
    let plans: Vec<Plan> = cases.iter().map(|(plan, _)| plan.clone()).collect();
    let VdbFile { bytes, .. } = write(form, &plans, &mut random);
    let mut vdb = Vdb::open(&bytes).unwrap();
    for (index, (plan, expected)) in cases.iter().enumerate() {
        let found = vdb.scalar(index).ok().map(|grid| grid.transform().to_world([1.0, 2.0, 3.0]));
        let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-12;
        let agree = match (found, expected) {
            (Some(found), Some(expected)) => found.iter().zip(expected).all(is_near),
            (found, expected) => found.is_none() && expected.is_none(),
        };
        assert!(agree, "{}: {found:?}, not {expected:?}", plan.unique_name);
    }
}

#[test]
fn a_frustum_is_passed_over_and_refused() {
    let mut random = Random::new(5);
    for version in [220, 221, 224] {
        let form = Form { version, compression: ZIP, half: false, offsets: false };
        let inner = |name: &str| {
            let corners = if version < 221 { vec![0; 24] } else { doubles(&[0.0; 6]) };
            [corners, doubles(&[1.0, 1.0]), text(name)].concat()
        };
        let mut camera = Plan::new("camera", "float");
        camera.map = ("NonlinearFrustumMap", [inner("TranslationMap"), doubles(&[0.0; 3])].concat());
        let VdbFile { bytes, written } = write(form, &[camera.clone(), Plan::new("box", "float")], &mut random);
        let mut vdb = Vdb::open(&bytes).unwrap();
        assert!(matches!(vdb.scalar(0), Err(FormatFault::Unsupported { .. })));
        assert_same(&vdb.scalar(1).unwrap(), written[1].as_ref().unwrap(), "behind a frustum");
        camera.map.1 = [inner("NonlinearFrustumMap"), inner("TranslationMap"), doubles(&[0.0; 3])].concat();
        let VdbFile { bytes, .. } = write(form, &[camera], &mut random);
        assert!(Vdb::open(&bytes).is_err(), "a frustum in a frustum");
    }
}

#[test]
fn grids_of_other_types_are_passed_over_by_their_offsets() {
    let mut random = Random::new(6);
    let points = |kind| Plan { tree: Some((vec![9; 50], vec![7; 50])), ..Plan::new("points", kind) };
    for offsets in [true, false] {
        let form = Form { version: 224, compression: BLOSC, half: false, offsets };
        let VdbFile { bytes, written } =
            write(form, &[points("ptdataidx32"), Plan::new("flame", "float")], &mut random);
        match Vdb::open(&bytes) {
            Ok(mut vdb) => {
                assert!(offsets && vdb.scalar(0).is_err());
                assert_same(&vdb.scalar(1).unwrap(), written[1].as_ref().unwrap(), "behind points");
                assert_eq!(vdb.grids()[0].kind, "ptdataidx32");
            }
            Err(fault) => assert!(!offsets && fault.to_string().contains("points"), "{fault}"),
        }
    }
}

#[test]
fn half_is_what_the_metadata_say() {
    let mut random = Random::new(7);
    let form = Form { version: 224, compression: BLOSC, half: false, offsets: true };
    let tree = |half| crate::import_common::trees::random_tree(Form { half, ..form }, "float", &mut Random::new(8));
    let (topology, leaves, written) = tree(true);
    // The type says full, the metadata half.
    let plan = Plan { tree: Some((topology, leaves)), ..Plan::new("flame", "float") };
    let VdbFile { bytes, .. } = write(form, &[plan.with("is_saved_as_half_float", "bool", &[1])], &mut random);
    assert_same(&Vdb::open(&bytes).unwrap().scalar(0).unwrap(), &written, "half by metadata");
}

fn in_folder(name: &str, bytes: &[u8]) -> (tempfile::TempDir, Sequence) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let sequence = Sequence::open(&folder.path().join(name)).unwrap();
    (folder, sequence)
}

#[test]
fn grid_classes_are_read_and_used() {
    let mut random = Random::new(9);
    let form = Form { version: 224, compression: BLOSC, half: false, offsets: true };
    let plans = [
        Plan::new("flame", "float").with("class", "string", b" Level Set"),
        Plan::new("velocity", "vec3s").with("class", "string", b"staggered").with("is_local_space", "bool", &[1]),
    ];
    let VdbFile { bytes, written } = write(form, &plans, &mut random);
    let (_folder, sequence) = in_folder("phi_0042.vdb", &bytes);
    let described = sequence.describe(0).unwrap();
    assert!(described.grids[0].is_level_set() && !described.grids[0].is_staggered());
    assert!(described.grids[1].is_staggered() && described.grids[1].in_voxels);
    assert_eq!(described.grids[1].voxel_edges, Some([0.5; 3]));
    let selected = described.select(&Selection::default()).unwrap();
    assert_eq!((selected.field, selected.velocity, selected.is_split()), (0, [1; 3], false));

    let read = |placement| sequence.read(0, &Selection { placement, ..Selection::default() }).unwrap();
    let frame = read(PlacementChoice::Collocated);
    assert_eq!(frame.number, 42);
    let field = written[0].as_ref().unwrap();
    assert_eq!(frame.field.background()[0], -field.background[0]);
    for (origin, values) in &field.leaves {
        let block = frame.field.block(origin.map(|i| i >> 3)).unwrap();
        assert!(block.iter().zip(values).all(|([found], expected)| *found == -expected[0]));
    }
    let Velocity::Vectors(found, _) = &frame.velocity else { panic!("{:?}", frame.velocity) };
    for (origin, values) in &written[1].as_ref().unwrap().leaves {
        let block = found.block(origin.map(|i| i >> 3)).unwrap();
        assert!(block.iter().zip(values).all(|(found, expected)| (0..3).all(|a| found[a] == 0.5 * expected[a])));
    }
    use pyrophone_flame::velocity::Placement;
    let is_staggered = |choice| matches!(read(choice).velocity, Velocity::Vectors(_, Placement::Staggered));
    assert!(is_staggered(PlacementChoice::Staggered) && is_staggered(PlacementChoice::FromFile));
    assert!(!is_staggered(PlacementChoice::Collocated));
}

#[test]
fn split_velocities() {
    let mut random = Random::new(10);
    let form = Form { version: 224, compression: BLOSC, half: false, offsets: true };
    let component = |name| Plan::new(name, "float").placed("TranslationMap", &[10.0, 20.0, 30.0]);
    let plans = [component("vel.x"), component("vel.y"), component("vel.z"), Plan::new("flame", "float")];
    let VdbFile { bytes, written } = write(form, &plans, &mut random);
    let (_folder, sequence) = in_folder("a.vdb", &bytes);
    let read = |placement| match sequence.read(0, &Selection { placement, ..Selection::default() }).unwrap().velocity {
        Velocity::Components(grids) => grids,
        other => panic!("{other:?}"),
    };
    let (centred, on_faces) = (read(PlacementChoice::FromFile), read(PlacementChoice::Staggered));
    for axis in 0..3 {
        assert_same(&centred[axis], written[axis].as_ref().unwrap(), "component");
        assert_eq!(centred[axis].transform().to_world([0.0; 3]), [10.0, 20.0, 30.0]);
        let mut lower = [10.0, 20.0, 30.0];
        lower[axis] -= 0.5;
        assert_eq!(on_faces[axis].transform().to_world([0.0; 3]), lower);
    }
}

#[test]
fn non_finite_grid_is_refused_only_when_read() {
    let leaf = |value: f32| {
        let mask = [0xFFu8; 64];
        let branch = |bytes: usize, slots: usize| {
            let mut child = vec![0u8; bytes];
            child[0] = 1;
            [child, vec![0; bytes], vec![6], vec![0; slots * 4]].concat()
        };
        let mut topology = [1i32.to_le_bytes(), 0f32.to_le_bytes(), 0u32.to_le_bytes(), 1u32.to_le_bytes()].concat();
        topology.extend([0; 12]);
        topology.extend([branch(4096, 32768), branch(512, 4096), mask.to_vec()].concat());
        let mut values = [1f32; 512];
        values[77] = value;
        let numbers: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        (topology, [mask.to_vec(), vec![6], numbers].concat())
    };
    let form = Form { version: 224, compression: 0, half: false, offsets: true };
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3.0] {
        let grid = |name| Plan { tree: Some(leaf(value)), ..Plan::new(name, "float") };
        let plans = [grid("density"), Plan::new("flame", "float"), Plan::new("velocity", "vec3s")];
        let VdbFile { bytes, .. } = write(form, &plans, &mut Random::new(11));
        let (_folder, sequence) = in_folder("a_0001.vdb", &bytes);
        assert!(sequence.read(0, &Selection::default()).is_ok());
        let density = Selection { field: "density".into(), ..Selection::default() };
        let message = sequence.read(0, &density).map(|_| ()).map_err(|error| error.to_string());
        match message {
            Ok(()) => assert_eq!(value, 3.0),
            Err(message) => assert!(
                message.contains("a_0001.vdb") && message.contains("density") && message.contains("not finite"),
                "{message}"
            ),
        }
    }
}

#[test]
fn a_tree_larger_than_its_file_allows_is_refused() {
    // Branches of 32768 tiles each, packed to almost nothing.
    let form = Form { version: 224, compression: ZIP, half: false, offsets: true };
    let ramp: Vec<u8> = (0..32768u32).flat_map(|i| (1.0 + (i % 2) as f32).to_le_bytes()).collect();
    let packed = {
        let mut encoder = flate2::write::ZlibEncoder::new(vec![], flate2::Compression::best());
        std::io::Write::write_all(&mut encoder, &ramp).unwrap();
        encoder.finish().unwrap()
    };
    let branches = 600u32;
    let mut topology = [1i32.to_le_bytes(), 0f32.to_le_bytes(), 0u32.to_le_bytes(), branches.to_le_bytes()].concat();
    for branch in 0..branches as i32 {
        topology.extend([0, 0, branch * 4096].into_iter().flat_map(i32::to_le_bytes));
        topology.extend([0; 8192]);
        topology.push(6);
        topology.extend((packed.len() as i64).to_le_bytes());
        topology.extend(&packed);
    }
    let plan = Plan { tree: Some((topology, vec![])), ..Plan::new("flame", "float") };
    let VdbFile { bytes, .. } = write(form, &[plan], &mut Random::new(12));
    let seen = allocation_counter::measure(|| {
        let mut vdb = Vdb::open(&bytes).unwrap();
        assert!(matches!(vdb.scalar(0), Err(FormatFault::TooLarge { .. })));
    });
    assert!(seen.bytes_max < (256 << 20) + 64 * bytes.len() as u64, "{} bytes", seen.bytes_max);
}

/// Places worth a look: the first and last voxel of every block and tile.
fn places<const N: usize>(grid: &Grid<N>) -> Vec<[i32; 3]> {
    let blocks = grid.blocks().map(|(key, _)| (key.map(|i| 8 * i), 3));
    let tiles = grid.tiles().map(|(origin, log2, _)| (origin, log2));
    blocks.chain(tiles).flat_map(|(origin, log2)| [origin, origin.map(|i| i + (1 << log2) - 1)]).collect()
}

#[test]
fn grids_of_one_name_are_one_field() {
    let form = Form { version: 224, compression: BLOSC, half: false, offsets: true };
    for seed in 0..20 {
        let mut random = Random::new(seed);
        let level_set = |name: &str| Plan::new(name, "float").with("class", "string", b"level set");
        let plans = [
            Plan::new("flame", "float"),
            Plan::new("flame\u{1e}1", "float"),
            Plan::new("vel", "vec3s"),
            Plan::new("vel\u{1e}1", "vec3s"),
            level_set("surface"),
            level_set("surface\u{1e}1"),
        ];
        let VdbFile { bytes, .. } = write(form, &plans, &mut random);
        let mut vdb = Vdb::open(&bytes).unwrap();
        let fields: Vec<Grid<1>> = [0, 1, 4, 5].map(|index| vdb.scalar(index).unwrap()).into();
        let (flow, other_flow) = (vdb.vectors(2).unwrap(), vdb.vectors(3).unwrap());
        let (_folder, sequence) = in_folder("a.vdb", &bytes);
        let frame = sequence.read(0, &Selection::default()).unwrap();
        let Velocity::Vectors(velocity, _) = &frame.velocity else { panic!("{:?}", frame.velocity) };
        for index in places(&fields[0]).into_iter().chain(places(&fields[1])) {
            assert_eq!(frame.field.value(index), [fields[0].value(index)[0] + fields[1].value(index)[0]], "{index:?}");
        }
        for index in places(&flow).into_iter().chain(places(&other_flow)) {
            let (a, b) = (flow.value(index), other_flow.value(index));
            assert_eq!(velocity.value(index), [a[0] + b[0], a[1] + b[1], a[2] + b[2]], "{index:?}");
        }
        let surface = Selection { field: "surface".into(), ..Selection::default() };
        let surface = sequence.read(0, &surface).unwrap().field;
        for index in places(&fields[2]).into_iter().chain(places(&fields[3])) {
            assert_eq!(surface.value(index), [-fields[2].value(index)[0].min(fields[3].value(index)[0])], "{index:?}");
        }
    }
}

#[test]
fn grids_of_one_name_that_lie_differently_are_refused() {
    let form = Form { version: 224, compression: 0, half: false, offsets: true };
    let moved = Plan::new("flame\u{1e}1", "float").placed("TranslationMap", &[1.0, 0.0, 0.0]);
    let plans = [Plan::new("flame", "float"), moved, Plan::new("vel", "vec3s")];
    let VdbFile { bytes, .. } = write(form, &plans, &mut Random::new(3));
    let (_folder, sequence) = in_folder("a.vdb", &bytes);
    let message = sequence.read(0, &Selection::default()).unwrap_err().to_string();
    assert!(
        message.contains("grids named flame whose voxels do not coincide") && message.contains("export them as one"),
        "{message}"
    );
}

/// The numbers of Blender's `config_0001.uni` that matter: cells of the box, of the whole domain, and where the box lies.
fn blender_config(cells: [i32; 3], base: [i32; 3], lowest: [i32; 3]) -> Vec<u8> {
    let mut bytes = vec![0u8; 188];
    for (at, numbers) in [(4, cells), (148, base), (160, lowest)] {
        let numbers: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        bytes[at..at + 12].copy_from_slice(&numbers);
    }
    let mut gzip = flate2::write::GzEncoder::new(vec![], flate2::Compression::fast());
    std::io::Write::write_all(&mut gzip, &bytes).unwrap();
    gzip.finish().unwrap()
}

/// Frames of Blender's adaptive domain: each says that its voxels are the domain's size over its own cells.
#[test]
fn boxes_of_an_adaptive_domain_have_one_voxel_size_and_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let [data, config] = ["data", "config"].map(|name| folder.path().join(name));
    std::fs::create_dir(&data).unwrap();
    let base = [20, 20, 40];
    let boxes = [([10, 12, 20], [5, 4, 0]), ([12, 12, 30], [4, 4, 0]), (base, [0; 3])];
    let mut random = Random::new(5);
    for (n, (cells, _)) in boxes.iter().enumerate() {
        let edge = 3.0 / f64::from(cells[2]);
        let cells: Vec<u8> = cells.iter().flat_map(|cells: &i32| cells.to_le_bytes()).collect();
        let map = [vec![edge; 6], vec![1.0 / edge; 3], vec![1.0 / (edge * edge); 3], vec![0.5 / edge; 3]].concat();
        let grid = |name, kind| {
            Plan::new(name, kind).with("file_base_resolution", "vec3i", &cells).placed("UniformScaleMap", &map)
        };
        // Noise has two voxels to a cell, and says so.
        let fine: Vec<u8> = boxes[n].0.iter().flat_map(|cells| (2 * cells).to_le_bytes()).collect();
        let noise = Plan::new("noise", "float").with("file_base_resolution", "vec3i", &fine);
        let noise = noise.placed("UniformScaleMap", &[vec![0.5 * edge; 6], vec![2.0 / edge; 9]].concat());
        let form = Form { version: 224, compression: ZIP, half: false, offsets: true };
        let file = write(form, &[grid("flame", "float"), grid("velocity", "vec3s"), noise], &mut random);
        std::fs::write(data.join(format!("fluid_data_{:04}.vdb", n + 1)), file.bytes).unwrap();
    }
    let edges = |sequence: &Sequence| -> Vec<f64> {
        (0..3).map(|index| sequence.describe(index).unwrap().grids[0].voxel_edges.unwrap()[0]).collect()
    };
    let sequence = Sequence::open(&data).unwrap();
    // Without the folder, as the files say.
    for (found, expected) in edges(&sequence).iter().zip([0.15, 0.1, 0.075]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    std::fs::create_dir(&config).unwrap();
    for (n, (cells, lowest)) in boxes.iter().enumerate() {
        std::fs::write(config.join(format!("config_{:04}.uni", n + 1)), blender_config(*cells, base, *lowest)).unwrap();
    }
    assert!(edges(&sequence).iter().all(|edge| (edge - 0.075).abs() < 1e-12), "{:?}", edges(&sequence));
    for (index, (_, lowest)) in boxes.iter().enumerate() {
        let frame = sequence.read(index, &Selection::default()).unwrap();
        for transform in [frame.field.transform(), frame.velocity.transform()] {
            let place = transform.to_world([0.0; 3]);
            for (found, lowest) in place.iter().zip(lowest) {
                assert!((found - 0.075 * f64::from(*lowest)).abs() < 1e-12, "{index}: {place:?}");
            }
        }
    }
    let noise = sequence.read_field(0, &Selection { field: "noise".into(), ..Selection::default() }).unwrap();
    assert!((noise.transform().voxel_edges()[0] - 0.0375).abs() < 1e-12);
    assert!((noise.transform().to_world([0.0; 3])[0] - 0.375).abs() < 1e-12);
    // What makes no sense, or was cut, changes nothing.
    let good = blender_config(boxes[0].0, base, boxes[0].1);
    let absurd = blender_config(boxes[0].0, base, [15, 0, 0]);
    let negative = blender_config([-10, 12, 20], base, [0; 3]);
    for bytes in [&good[..good.len() / 2], b"not gzip", &absurd, &negative] {
        std::fs::write(config.join("config_0001.uni"), bytes).unwrap();
        assert!((edges(&sequence)[0] - 0.15).abs() < 1e-12);
    }
}
