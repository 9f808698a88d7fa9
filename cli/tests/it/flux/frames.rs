//! Frames, good and bad: what is measured, kept and written.

use super::{bytes, flame, folder, frame, notes, table};
use crate::common::{pyrophone, reference, refuses, succeeds};
use pyrophone_flame::flux::{Flux, FluxShard};
use pyrophone_flame::import::{Selection, Sequence};

#[test]
fn an_interrupted_run_goes_on() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, "flux --input flame --output whole.wav --flux-csv whole.csv");
    // A frame that cannot be read ends the work; those before it are kept.
    let good = bytes(at, "flame/flame_0022.npz");
    std::fs::write(frame(at, 22), &good[..good.len() / 2]).unwrap();
    let output = pyrophone(at, "flux --input flame --output out.wav --flux-csv out.csv");
    let error = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(
        error.lines().count() == 1 && error.contains("flame_0022.npz") && error.contains("out.wav.flux-progress"),
        "{error}"
    );
    assert!(!at.join("out.wav").exists() && !at.join("out.csv").exists());
    let kept = std::fs::read_to_string(at.join("out.wav.flux-progress")).unwrap();
    let rows = FluxShard::read_unfinished(&kept, "kept").unwrap().steps.len();
    assert!(rows > 0 && error.contains(&format!("the {rows} finished frames")), "{error}");

    // Numbers that are kept are not measured again: changed by hand, they come out.
    let changed: String = kept
        .lines()
        .map(|line| if line.starts_with("5,") { "5,7.5,1.0,1.0\n".into() } else { format!("{line}\n") })
        .collect();
    std::fs::write(at.join("out.wav.flux-progress"), changed + "6,1.0,").unwrap();
    let said = notes(at, "flux --input flame --output out.wav --flux-csv out.csv --skip-bad");
    assert!(
        said.contains(&format!("{rows} of 20 frames are reused")) && said.contains("1 frames interpolated: 22"),
        "{said}"
    );
    let (whole, out) = (table(at, "whole.csv"), table(at, "out.csv"));
    assert_eq!(out.rows[2].flux, 7.5);
    assert!(whole.rows[3..19].iter().zip(&out.rows[3..19]).all(|(a, b)| a.flux.to_bits() == b.flux.to_bits()));
    assert_eq!(out.rows[19].flux, out.rows[18].flux);
    assert!(!at.join("out.wav.flux-progress").exists());

    // Other settings or other files: what was kept is of no use.
    for options in ["--iso 0.4", ""] {
        std::fs::write(frame(at, 22), &good[..good.len() / 3]).unwrap();
        std::fs::write(at.join("out.wav.flux-progress"), &kept).unwrap();
        std::fs::write(frame(at, 22), &good).unwrap();
        let said = notes(at, &format!("flux --input flame --output out.wav --flux-csv out.csv {options}"));
        assert!(!said.contains("reused from an interrupted run"), "{said}");
    }
    assert_eq!(bytes(at, "out.wav"), bytes(at, "whole.wav"));
}

#[test]
fn bad_frames_are_refused_or_interpolated() {
    let folder = folder();
    let at = folder.path();
    std::fs::remove_file(frame(at, 9)).unwrap();
    std::fs::write(frame(at, 15), b"no frame").unwrap();
    refuses(at, "flux --input flame --output out.wav", 1, &["frame 9 is missing", "--skip-bad"]);
    let error = pyrophone(at, "flux --input flame --output out.wav --frames 10-22").stderr;
    assert!(String::from_utf8(error).unwrap().contains("flame_0015.npz"));
    let said = notes(at, "flux --input flame --output out.wav --flux-csv out.csv --skip-bad");
    assert!(said.contains("frame 15 is skipped") && said.contains("2 frames interpolated: 9, 15"), "{said}");
    let rows = table(at, "out.csv").rows;
    assert!((rows[6].flux - 0.5 * (rows[5].flux + rows[7].flux)).abs() < 1e-12);
    // The same from shards, although the gap lies at the end of one.
    succeeds(at, "flux --input flame --frames 3-9 --partial a.csv --skip-bad");
    succeeds(at, "flux --input flame --frames 10-22 --partial b.csv --skip-bad");
    succeeds(at, "flux-merge a.csv b.csv --output merged.wav --rate 360");
    assert_eq!(bytes(at, "merged.wav"), bytes(at, "out.wav"));
    refuses(at, "flux --input flame --output x.wav --frames 30-39", 1, &["--frames is 30-39", "3-22"]);
}

#[test]
fn voxels_may_change_from_frame_to_frame() {
    let folder = folder();
    let at = folder.path();
    flame(&frame(at, 9), 9, 0.2);
    succeeds(at, "flux --input flame --flux-csv out.csv");
    let rows = table(at, "out.csv").rows;
    // Twice as large a ball, eight times the area and speed in all.
    let mean = 0.5 * (rows[5].flux + rows[7].flux);
    assert!((4.0..16.0).contains(&(rows[6].flux / mean)), "{} beside {mean}", rows[6].flux);
}

#[test]
fn other_measures_need_no_front() {
    let folder = folder();
    let at = folder.path();
    for (measure, is_positive) in [("release", true), ("change", true)] {
        succeeds(at, &format!("flux --input flame --measure {measure} --flux-csv {measure}.csv --velocity none"));
        let rows = table(at, &format!("{measure}.csv")).rows;
        assert_eq!(rows.len(), 20);
        assert!(rows.iter().all(|row| row.flux > 0.0 && row.area == 0.0) == is_positive, "{measure}");
    }
    for row in table(at, "release.csv").rows {
        let frame = Sequence::open(&frame(at, row.frame)).unwrap().read(0, &Selection::default()).unwrap();
        let sum: f64 = frame.field.blocks().flat_map(|(_, block)| block.iter()).map(|[x]| f64::from(*x)).sum();
        assert!((row.flux / (1e-3 * sum) - 1.0).abs() < 1e-5, "{row:?}: {sum}");
    }
    refuses(at, "flux --input flame --measure divergence --output x.wav", 1, &["divergence", "flame"]);
}

#[test]
fn fronts_and_reports_are_written() {
    let folder = folder();
    let at = folder.path();
    succeeds(at, "flux --input flame --output p.wav --mesh fronts --mesh-every 5 --report told");
    let mut fronts: Vec<String> =
        at.join("fronts").read_dir().unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    fronts.sort();
    assert_eq!(fronts, ["front_0003.ply", "front_0008.ply", "front_0013.ply", "front_0018.ply"]);
    assert!(bytes(at, "fronts/front_0003.ply").starts_with(b"ply\n"));
    succeeds(at, "flux --input flame --output p.wav --mesh texts --mesh-every 10 --mesh-kind obj");
    let text = String::from_utf8(bytes(at, "texts/front_0013.obj")).unwrap();
    assert!(text.lines().any(|line| line.starts_with("v ")) && text.lines().any(|line| line.starts_with("f ")));
    let page = std::fs::read_to_string(at.join("told/index.html")).unwrap();
    for part in
        ["Flame front", "frame 22", "Velocity flux", "Area", "Spectrum", "iso 0.5", "Crest factor", "voxel 0.1 x"]
    {
        assert!(page.contains(part), "{part}");
    }
    assert_eq!(page.matches("<figure>").count(), 12);
    // A report alone is enough.
    succeeds(at, "flux --input flame --frames 3-4 --report alone");
    assert!(at.join("alone/index.html").is_file());
}

/// The reference flame through the program: the staggered grid is pointed out, and sampling it where it stands is not
/// what the reference has.
#[test]
fn the_reference_flame() {
    let Some(reference) = reference() else { return };
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let input = reference.join("flame_cache");
    let run = |name: &str, options: &str| {
        notes(at, &format!("flux --input {} --frames 1-6 --flux-csv {name} {options}", input.display()))
    };
    let said = run("a.csv", "");
    assert!(said.contains("velocity is staggered") && said.contains("--placement file"), "{said}");
    assert!(said.contains("cells per unit of Blender's time") && said.contains("0.125"), "{said}");
    assert!(!run("b.csv", "--placement file").contains("staggered"));
    let expected = std::fs::read_to_string(input.join("flux_reference.csv")).unwrap();
    let expected = Flux::read_csv(&expected, "reference").unwrap().rows;
    let (plain, staggered) = (table(at, "a.csv").rows, table(at, "b.csv").rows);
    for (row, expected) in plain.iter().zip(&expected) {
        // The reference takes Blender's numbers as they are.
        assert!(
            (row.flux / (0.125 * expected.flux) - 1.0).abs() < 0.02 && (row.area / expected.area - 1.0).abs() < 0.01
        );
    }
    assert_eq!(plain.len(), 6);
    run("c.csv", "--velocity-scale 1");
    assert!((table(at, "c.csv").rows[2].flux / expected[2].flux - 1.0).abs() < 0.02);
    // Smoke tells the rate: 360 a second is right, 24 is not.
    let check = |rate: &str| {
        notes(
            at,
            &format!("flux --input {} --frames 80-120 --upsample off --flux-csv d.csv --rate {rate}", input.display()),
        )
    };
    assert!(!check("360").contains("must be wrong"));
    let said = check("24");
    assert!(said.contains("must be wrong") && said.contains("--velocity-scale"), "{said}");
    assert!((staggered[0].flux / 0.125 + 0.497).abs() < 0.02, "{:?}", staggered[0]);
}
