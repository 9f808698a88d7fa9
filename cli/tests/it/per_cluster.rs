//! `pyrophone flux --per-cluster`: a drive and its positions for each flame.

use std::fs::File;
use std::path::Path;

use crate::common::{pyrophone, read, refuses, succeeds};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use tempfile::TempDir;

/// Voxels along an edge, and their edge in m.
const SIZE: usize = 32;
const VOXEL: f64 = 0.1;
const FRAMES: i64 = 48;

/// Distance of the second flame's middle from the first's, in voxels: it comes near, joins and parts again.
fn distance(number: i64) -> f64 {
    10.0 + 8.0 * (std::f64::consts::TAU * number as f64 / FRAMES as f64).cos()
}

/// Two breathing balls of flame, and a third that burns for a while.
fn cache(folder: &Path) {
    std::fs::create_dir(folder.join("cache")).unwrap();
    for number in 1..=FRAMES {
        let breath = |rate: f64| 0.15 * (number as f64 * rate).sin();
        let mut balls =
            vec![([6.0, 6.0, 8.0], 4.0 + breath(0.9)), ([6.0 + distance(number), 6.0, 8.0], 3.5 + breath(1.7))];
        if (11..30).contains(&number) {
            balls.push(([24.0, 24.0, 22.0 + 0.1 * number as f64], 3.0 + breath(2.1)));
        }
        let at = |n: usize| [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64);
        let inside = |n: usize| {
            let away = |middle: &[f64; 3]| (0..3).map(|axis| (at(n)[axis] - middle[axis]).powi(2)).sum::<f64>().sqrt();
            balls.iter().map(|(middle, radius)| radius - away(middle)).fold(f64::MIN, f64::max)
        };
        let count = SIZE * SIZE * SIZE;
        let frame = DenseFrame {
            shape: [SIZE; 3],
            flame: &(0..count).map(|n| [(0.5 + 0.25 * inside(n)).clamp(0.0, 1.0) as f32]).collect::<Vec<_>>(),
            velocity: &(0..count).map(|n| at(n).map(|x| x as f32)).collect::<Vec<_>>(),
            voxel_size: VOXEL,
            origin: [0.0; 3],
            time_s: None,
        };
        write_frame(File::create(folder.join(format!("cache/fire_{number:03}.npz"))).unwrap(), &frame).unwrap();
    }
}

/// Rows of a table as texts.
fn rows(path: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(path).unwrap();
    text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

/// Asserts that the drives add up to the whole, sample by sample; returns their number.
fn drives_add_up(folder: &Path, whole: &str, clusters: &str) -> usize {
    let whole = read(&folder.join(whole));
    let mut sum = vec![0.0f64; whole.len_samples()];
    let entries = folder.join(clusters).read_dir().unwrap().map(|entry| entry.unwrap().path());
    let drives: Vec<_> = entries.filter(|path| path.extension().is_some_and(|extension| extension == "wav")).collect();
    for drive in &drives {
        let drive = read(drive);
        assert_eq!((drive.len_samples(), drive.sample_rate_hz), (whole.len_samples(), whole.sample_rate_hz));
        sum.iter_mut().zip(&drive.channels[0]).for_each(|(sum, x)| *sum += f64::from(*x));
    }
    let error = sum.iter().zip(&whole.channels[0]).map(|(sum, x)| (sum - f64::from(*x)).abs()).fold(0.0, f64::max);
    assert!(error < 1e-5, "{error} at a peak of 0.5");
    drives.len()
}

#[test]
fn drives_of_flames_add_up_to_the_whole_and_know_their_places() {
    let folder: TempDir = tempfile::tempdir().unwrap();
    let at = folder.path();
    cache(at);
    for (rate, name) in [(360, "fast"), (24, "slow")] {
        let flux = format!("flux --input cache --rate {rate} --refine 2 --per-cluster {name} --output {name}.wav");
        let output = pyrophone(at, &flux);
        let notes = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{notes}");
        assert!(
            notes.contains("4 flames: 1 ignited later, 1 split off others, 1 went out, 1 joined others"),
            "{notes}"
        );
        assert_eq!(drives_add_up(at, &format!("{name}.wav"), name), 4);
        let listed: Vec<Vec<String>> = rows(&at.join(name).join("clusters.csv"));
        let why: Vec<[&str; 4]> =
            listed.iter().map(|row| [&row[3], &row[4], &row[5], &row[6]].map(|x| x.as_str())).collect();
        assert_eq!(
            why,
            [
                ["start", "", "end", ""],
                ["start", "", "merged", "cluster_001"],
                ["ignited", "", "extinguished", ""],
                ["split", "cluster_001", "end", ""]
            ]
        );
        for row in rows(&at.join(name).join("cluster_003.csv")) {
            let numbers: Vec<f64> = row.iter().map(|x| x.parse().unwrap()).collect();
            let number = 1.0 + numbers[0] * f64::from(rate);
            let expected = [24.0, 24.0, 22.0 + 0.1 * number].map(|x| x * VOXEL);
            for (found, expected) in numbers[1..4].iter().zip(expected) {
                assert!((found - expected).abs() < 0.1 * VOXEL, "{numbers:?}: {expected:?}");
            }
        }
    }
    // The quietest share a drive; without --output there is a scale all the same.
    succeeds(at, "flux --input cache --rate 360 --refine 2 --per-cluster two --clusters 2 --scale-file shot.scale");
    succeeds(at, "flux --input cache --rate 360 --refine 2 --output two.wav --scale-file shot.scale");
    assert_eq!(drives_add_up(at, "two.wav", "two"), 3);
    assert!(at.join("two/cluster_rest.csv").is_file());
}

#[test]
fn a_listener_hears_every_flame_from_its_place() {
    let folder: TempDir = tempfile::tempdir().unwrap();
    let at = folder.path();
    cache(at);
    // Beyond the third flame, which burns alone in its corner; the others are together in the opposite one.
    let flux = "flux --input cache --rate 360 --refine 2 --per-cluster x --listener -40,0.6,0.8";
    succeeds(at, flux);
    let heard = read(&at.join("x/ambisonic.wav"));
    assert_eq!(heard.channels.len(), 4);
    // From so far away all flames are in front, and about 42 m away.
    let whole = |name: &str| read(&at.join("x").join(name)).channels[0].clone();
    let drives = ["cluster_001.wav", "cluster_002.wav", "cluster_003.wav", "cluster_004.wav"].map(whole);
    let loudest = drives.iter().flatten().fold(0.0f32, |most, x| most.max(x.abs()));
    for n in (0..heard.len_samples()).step_by(50) {
        let sum: f32 = drives.iter().map(|drive| drive[n]).sum::<f32>() / 41.5;
        assert!((heard.channels[0][n] - sum).abs() < 0.05 * loudest / 41.5, "sample {n}");
        assert!((heard.channels[3][n] - heard.channels[0][n]).abs() < 0.05 * loudest / 41.5, "front, sample {n}");
    }
    refuses(at, "flux --input cache --rate 360 --per-cluster y --listener 1,2", 2, &["three numbers"]);
    refuses(at, "flux --input cache --rate 360 --output y.wav --listener 1,2,3", 2, &["--per-cluster"]);
}

#[test]
fn per_cluster_with_conflicting_options_is_refused() {
    let folder: TempDir = tempfile::tempdir().unwrap();
    let at = folder.path();
    cache(at);
    let flux = "flux --input cache --rate 24 --per-cluster x";
    refuses(at, &format!("{flux} --measure change"), 1, &["--per-cluster", "--measure flux"]);
    refuses(at, &format!("{flux} --as envelope"), 1, &["--per-cluster", "--as"]);
    refuses(at, &format!("{flux} --clusters 0"), 1, &["--clusters", "0"]);
    refuses(at, "flux --input cache --per-cluster x", 1, &["--rate"]);
    refuses(at, &format!("{flux} --partial x.csv"), 2, &["--partial"]);
}
