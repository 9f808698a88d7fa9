//! The reference flame, against an independent program's flux and area.

use pyrophone_flame::front::Front;
use pyrophone_flame::import::{PlacementChoice, Selection, Sequence};
use rayon::prelude::*;

#[test]
fn flux_and_area_of_the_reference_flame() {
    let Some(folder) = crate::common::flame_cache() else { return };
    let table = std::fs::read_to_string(folder.join("flux_reference.csv")).unwrap();
    let rows: Vec<[f64; 3]> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|field| field.parse().unwrap()).collect::<Vec<f64>>().try_into().unwrap())
        .collect();
    assert!(rows.len() >= 100, "{} rows", rows.len());
    let sequence = Sequence::open(&folder).unwrap();
    // The independent program took the velocities as they stand in their voxels.
    let selection = Selection { placement: PlacementChoice::Collocated, ..Selection::default() };
    let front = Front::new(0.5, 3).unwrap();
    let numbers: Vec<f64> = sequence.numbers().map(|number| number as f64).collect();
    assert_eq!(numbers, rows.iter().map(|row| row[0]).collect::<Vec<_>>());
    let found: Vec<_> = (0..sequence.len())
        .into_par_iter()
        .map(|index| front.measure_with_curvature(&sequence.read(index, &selection).unwrap()).unwrap())
        .collect();
    let rms = |values: &mut dyn Iterator<Item = f64>| (values.map(|x| x * x).sum::<f64>() / rows.len() as f64).sqrt();
    let pairs = || found.iter().zip(&rows);
    let flux_error =
        rms(&mut pairs().map(|(found, row)| found.flux - row[1])) / rms(&mut rows.iter().map(|row| row[1]));
    assert!(flux_error <= 0.015, "{flux_error}");
    for (found, row) in pairs() {
        assert!((found.area / row[2] - 1.0).abs() <= 0.01, "frame {}: {found:?}", row[0]);
        assert!((1.5..7.0).contains(&found.mean_curvature.unwrap()), "frame {}: {found:?}", row[0]);
    }
    println!("flux {:.3} %, {} triangles", 100.0 * flux_error, found[0].triangles);
}
