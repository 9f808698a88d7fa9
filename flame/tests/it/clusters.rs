//! The connected parts of a front, and their tracks.

use std::collections::BTreeMap;

use crate::common::{field, flow, frame};
use pyrophone_flame::Frame;
use pyrophone_flame::clusters::{Birth, Death, Track, Tracker, series};
use pyrophone_flame::front::Front;
use pyrophone_flame::grid::Transform;

/// Voxels along an edge, and their edges in m.
const SIZE: usize = 40;
const VOXEL: f64 = 0.05;

/// Balls of flame by middle and radius, in voxels; gas flows away from the origin, so that each ball has a flux of its own.
fn balls(balls: &[([f64; 3], f64)]) -> Frame {
    let transform = Transform::uniform(VOXEL, [0.0; 3]).unwrap();
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt();
    let inside = |at| balls.iter().map(|(middle, radius)| radius - distance(at, *middle)).fold(f64::MIN, f64::max);
    frame(
        field(SIZE, transform, |at| (0.5 + 0.2 * inside(at)).clamp(0.0, 1.0)),
        flow(SIZE, transform, |at| at.map(|x| VOXEL * x)),
    )
}

fn front() -> Front {
    Front::new(0.5, 2).unwrap()
}

fn tracks(frames: &[Vec<([f64; 3], f64)>]) -> Vec<Track> {
    let mut tracker = Tracker::default();
    for (step, flames) in frames.iter().enumerate() {
        tracker.add(step as i64, front().clusters(&balls(flames)).unwrap());
    }
    tracker.finish()
}

#[test]
fn parts_have_their_own_places_and_add_up_to_the_whole() {
    let two = [([10.0, 12.0, 10.0], 6.0), ([28.0, 26.0, 30.0], 4.0)];
    let frame = balls(&two);
    let (parts, whole) = (front().clusters(&frame).unwrap(), front().measure(&frame).unwrap());
    assert_eq!(parts.len(), 2);
    for (part, (middle, radius)) in parts.iter().zip(two) {
        for (found, expected) in part.centroid.iter().zip(middle) {
            assert!((found - VOXEL * expected).abs() < 0.01 * VOXEL, "{part:?}");
        }
        // The flow's divergence is 3 per second.
        let radius_m = VOXEL * radius;
        let (volume, area) =
            (4.0 / 3.0 * std::f64::consts::PI * radius_m.powi(3), 4.0 * std::f64::consts::PI * radius_m.powi(2));
        assert!((part.flux / (3.0 * volume) - 1.0).abs() < 0.1, "{} {volume}", part.flux);
        assert!((part.area / area - 1.0).abs() < 0.1, "{} {area}", part.area);
    }
    let sum: f64 = parts.iter().map(|part| part.flux).sum();
    assert!((sum / whole.flux - 1.0).abs() < 1e-12);
    let sum: f64 = parts.iter().map(|part| part.area).sum();
    assert!((sum / whole.area - 1.0).abs() < 1e-12);
    assert!(front().clusters(&balls(&[])).unwrap().is_empty());
}

#[test]
fn hollows_belong_to_the_flame_around_them() {
    let transform = Transform::uniform(VOXEL, [0.0; 3]).unwrap();
    let away = |at: [f64; 3]| at.iter().map(|x| (x - 19.5).powi(2)).sum::<f64>().sqrt();
    // A shell, and a flame of its own within it.
    let burns = |at: [f64; 3]| (3.0 - (away(at) - 13.0).abs()).max(5.0 - away(at));
    let shell = frame(
        field(SIZE, transform, |at| (0.5 + 0.2 * burns(at)).clamp(0.0, 1.0)),
        flow(SIZE, transform, |at| at.map(|x| VOXEL * x)),
    );
    let (parts, whole) = (front().clusters(&shell).unwrap(), front().measure(&shell).unwrap());
    assert_eq!(parts.len(), 2);
    let volume = |radius: f64| 4.0 / 3.0 * std::f64::consts::PI * (VOXEL * radius).powi(3);
    for (part, expected) in parts.iter().zip([volume(16.0) - volume(10.0), volume(5.0)]) {
        assert!((part.flux / (3.0 * expected) - 1.0).abs() < 0.05, "{} {expected}", part.flux);
    }
    assert!((parts.iter().map(|part| part.flux).sum::<f64>() / whole.flux - 1.0).abs() < 1e-12);
}

#[test]
fn flames_keep_their_tracks_while_they_move_cross_in_size_appear_and_end() {
    let mut frames: Vec<Vec<([f64; 3], f64)>> = vec![];
    for step in 0..8 {
        let x = f64::from(step);
        let mut flames = vec![([8.0 + x, 10.0, 10.0], 4.0 + 0.4 * x), ([30.0 - x, 28.0, 30.0], 6.0 - 0.4 * x)];
        // Faster than its own size: it overlaps nothing of itself.
        if (2..6).contains(&step) {
            flames.push(([10.0, 34.0, 4.0 + 7.0 * (x - 2.0)], 3.0));
        }
        frames.push(flames);
    }
    let found = tracks(&frames);
    let told: Vec<_> = found.iter().map(|track| (track.birth, track.death, track.points.len())).collect();
    assert_eq!(
        told,
        [(Birth::Start, Death::End, 8), (Birth::Start, Death::End, 8), (Birth::Ignited, Death::Extinguished, 4)]
    );
    // The second becomes the larger one; both stay what they were.
    let [first, second] = [&found[0], &found[1]];
    assert!(first.points[&0].area > second.points[&0].area && first.points[&7].area < second.points[&7].area);
    let y = |track: &Track| track.points.values().map(|point| point.centroid[1] / VOXEL).collect::<Vec<_>>();
    assert!(y(first).iter().all(|y| (y - 28.0).abs() < 0.1) && y(second).iter().all(|y| (y - 10.0).abs() < 0.1));
}

#[test]
fn flames_that_tear_and_join_say_so_and_hand_over_gradually() {
    let apart = |distance: f64| vec![([20.0 - distance, 20.0, 20.0], 6.0), ([20.0 + distance, 20.0, 20.0], 5.0)];
    let distances = [3.0, 4.0, 7.0, 9.0, 10.0, 10.0, 10.0, 10.0, 10.0, 10.0, 9.0, 7.0, 4.0, 3.0];
    let found = tracks(&distances.map(apart));
    let told: Vec<_> = found.iter().map(|track| (track.birth, track.death, track.points.len())).collect();
    assert_eq!(told, [(Birth::Start, Death::End, 14), (Birth::Split(0), Death::Merged(0), 10)]);
    let whole =
        |step: i64| found.iter().filter_map(|track| track.points.get(&step)).map(|point| point.flux).sum::<f64>();
    for handover in [0, 3] {
        let series = series(&found, handover);
        for step in 0..14 {
            let sum: f64 = series.iter().filter_map(|series| series.get(&step)).sum();
            assert!((sum / whole(step) - 1.0).abs() < 1e-12, "{step}");
        }
        // Largest jump of the torn-off part's flux, where there is none counting as 0, as a part of its largest.
        let at = |step: i64| series[1].get(&step).copied().unwrap_or(0.0);
        let largest = (0..14).map(at).fold(0.0, f64::max);
        let jump = (0..13).map(|step| (at(step + 1) - at(step)).abs()).fold(0.0, f64::max) / largest;
        assert_eq!(jump > 0.5, handover == 0, "{jump}");
    }
    assert!(found[1].variation() > 0.0);
    assert_eq!(series(&[], 3), Vec::<BTreeMap<i64, f64>>::new());
}
