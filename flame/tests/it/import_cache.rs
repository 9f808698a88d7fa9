//! The reference cache: 180 frames of a simulated flame.

use crate::common::flame_cache;
use pyrophone_flame::grid::Grid;
use pyrophone_flame::import::{Error, PlacementChoice, Selection, Sequence, Series, Timing};
use pyrophone_flame::velocity::{Placement, Velocity};

/// Box of the voxels other than zero (where all inactive ones are zero, and no active one is), their number, sums of
/// values and of squares.
#[derive(Debug)]
struct Sums<const N: usize> {
    low: [i32; 3],
    high: [i32; 3],
    count: usize,
    sum: [f64; N],
    squares: f64,
}

fn sums<const N: usize>(grid: &Grid<N>) -> Sums<N> {
    let mut sums = Sums { low: [i32::MAX; 3], high: [i32::MIN; 3], count: 0, sum: [0.0; N], squares: 0.0 };
    for (key, block) in grid.blocks() {
        for (slot, value) in block.iter().enumerate().filter(|(_, value)| value.iter().any(|x| *x != 0.0)) {
            let index = [slot >> 6, slot >> 3 & 7, slot & 7];
            for axis in 0..3 {
                let i = key[axis] * 8 + index[axis] as i32;
                sums.low[axis] = sums.low[axis].min(i);
                sums.high[axis] = sums.high[axis].max(i);
            }
            sums.count += 1;
            sums.sum.iter_mut().zip(value).for_each(|(sum, x)| *sum += f64::from(*x));
            sums.squares += value.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>();
        }
    }
    sums
}

fn check<const N: usize>(grid: &Grid<N>, high: [i32; 3], low: [i32; 3], count: usize, sum: [f64; N], squares: f64) {
    let found = sums(grid);
    assert_eq!((found.low, found.high, found.count), (low, high, count), "{found:?}");
    for (found, expected) in found.sum.iter().chain([&found.squares]).zip(sum.iter().chain([&squares])) {
        assert!((found - expected).abs() <= 1e-6 + 1e-12 * expected.abs(), "{found}, not {expected}");
    }
    assert_eq!(grid.background(), [0.0; N]);
    assert_eq!(grid.tiles().count(), 0);
    assert_eq!(grid.transform().voxel_edges(), [0.05000000074505806; 3]);
}

fn vectors(velocity: &Velocity) -> &Grid<3> {
    match velocity {
        Velocity::Vectors(grid, Placement::Collocated) => grid,
        other => panic!("{other:?}"),
    }
}

#[test]
fn check_sums_of_three_frames() {
    let Some(folder) = flame_cache() else { return };
    let cache = Sequence::open(&folder).unwrap();
    let read = |number: u64| {
        let index = cache.numbers().position(|found| found == number as i64).unwrap();
        let frame = cache.read(index, &Selection::default()).unwrap();
        assert_eq!(frame.number, number as i64);
        frame
    };
    let frame = read(1);
    check(&frame.field, [14, 14, 10], [5, 5, 1], 520, [464.564453125], 422.494072914);
    let sum = [-19.635036, -19.634565, 2973.445312];
    check(vectors(&frame.velocity), [14, 14, 10], [5, 5, 1], 520, sum, 18059.618041);
    assert_eq!(frame.field.value([6, 6, 5]), [0.61621094]);
    let frame = read(90);
    check(&frame.field, [18, 17, 19], [2, 2, 1], 2226, [1093.323964716], 885.681454096);
    let sum = [-7189.845232, -898.271848, 30628.856230];
    check(vectors(&frame.velocity), [18, 18, 21], [1, 1, 1], 3610, sum, 1093627.389273);
    let frame = read(180);
    check(&frame.field, [18, 18, 33], [1, 1, 1], 3910, [1334.332478881], 926.175965289);
    let sum = [-5294.866455, 98.485554, 79440.251606];
    check(vectors(&frame.velocity), [18, 18, 35], [1, 1, 1], 7412, sum, 3384599.722113);
}

#[test]
fn every_frame_is_read() {
    let Some(folder) = flame_cache() else { return };
    let cache = Sequence::open(&folder).unwrap();
    assert_eq!(cache.numbers().collect::<Vec<_>>(), (1..=180).collect::<Vec<_>>());
    assert_eq!((cache.len(), cache.missing().len(), cache.left_out()), (180, 0, 0));
    let mut burning = 0;
    for index in 0..cache.len() {
        let frame = cache.read(index, &Selection::default()).unwrap_or_else(|error| panic!("{error}"));
        let (field, velocity) = (sums(&frame.field), sums(vectors(&frame.velocity)));
        assert!((520..=3910).contains(&field.count) && (520..=7412).contains(&velocity.count), "{index}");
        assert!((0..3).all(|axis| velocity.low[axis] <= field.low[axis] && field.high[axis] <= velocity.high[axis]));
        burning += field.count;
    }
    assert!(burning > 180 * 520);
}

#[test]
fn grids_of_a_cached_frame_are_listed_and_read() {
    let Some(folder) = flame_cache() else { return };
    let cache = Sequence::open(&folder.join("fluid_data_0001.vdb")).unwrap();
    assert_eq!((cache.len(), cache.numbers().next()), (1, Some(1)));
    let description = cache.describe(0).unwrap();
    let names: Vec<_> = description.grids.iter().map(|grid| (grid.name.as_str(), grid.kind.as_str())).collect();
    let scalar = |name| (name, "float");
    let expected = [("velocity", "vec3s"), scalar("density"), scalar("shadow"), scalar("temperature"), scalar("flame")];
    assert_eq!(names, expected);
    assert!(description.grids[0].is_staggered() && !description.grids[4].is_level_set());
    let from_file = Selection { placement: PlacementChoice::FromFile, ..Selection::default() };
    let frame = cache.read(0, &from_file).unwrap();
    assert!(matches!(frame.velocity, Velocity::Vectors(_, Placement::Staggered)));
    let shadow = Selection { field: "SHADOW".into(), ..Selection::default() };
    let tiles: Vec<_> = cache.read(0, &shadow).unwrap().field.tiles().map(|(_, log2, value)| (log2, value)).collect();
    assert!(!tiles.is_empty() && tiles.iter().all(|tile| *tile == (3, [-1.0])), "{tiles:?}");
    let absent = Selection { field: "smoke".into(), ..Selection::default() };
    let message = cache.read(0, &absent).unwrap_err().to_string();
    assert!(message.contains("\"smoke\"") && message.contains("density (float)"), "{message}");
    assert!(matches!(cache.read(1, &absent), Err(Error::NoFrame { index: 1, found: 1, .. })));
}

#[test]
fn the_flux_beside_it() {
    let Some(folder) = flame_cache() else { return };
    let series = Series::read(&folder.join("flux_reference.csv")).unwrap();
    assert_eq!((series.timing, series.values.len(), series.rate_hz), (Timing::Frames(1), 180, None));
    assert_eq!(series.values[..2], [0.190082283, 0.70969322]);
}
