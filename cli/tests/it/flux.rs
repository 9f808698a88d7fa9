//! `pyrophone flux` and `flux-merge`: what is measured, kept, put together and refused.

use std::fs::File;
use std::path::Path;

use crate::common::{pyrophone, read, reference, refuses, succeeds, write};
use pyrophone_flame::flux::{Flux, FluxShard};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};
use pyrophone_flame::import::{Selection, Sequence};
use tempfile::TempDir;

/// Voxels along an edge.
const SIZE: usize = 16;

/// A ball of flame that breathes, in a flow away from its middle.
fn flame(path: &Path, number: i64, voxel_size: f64) {
    let radius = 5.0 + 0.7 * (number as f64 * 0.9).sin();
    let from_middle = |n: usize| -> [f64; 3] {
        [n / (SIZE * SIZE), n / SIZE % SIZE, n % SIZE].map(|i| i as f64 - 0.5 * (SIZE - 1) as f64)
    };
    let away = |n: usize| from_middle(n).iter().map(|x| x * x).sum::<f64>().sqrt();
    let count = SIZE * SIZE * SIZE;
    let frame = DenseFrame {
        shape: [SIZE; 3],
        flame: &(0..count).map(|n| [(0.5 + 0.25 * (radius - away(n))).clamp(0.0, 1.0) as f32]).collect::<Vec<_>>(),
        velocity: &(0..count).map(|n| from_middle(n).map(|x| x as f32)).collect::<Vec<_>>(),
        voxel_size,
        origin: [0.0; 3],
        time_s: Some(number as f64 / 360.0),
    };
    write_frame(File::create(path).unwrap(), &frame).unwrap();
}

/// A folder with `flame/flame_0003.npz` to `flame_0022.npz`.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("flame")).unwrap();
    for number in 3..=22 {
        flame(&frame(folder.path(), number), number, 0.1);
    }
    folder
}

fn frame(folder: &Path, number: i64) -> std::path::PathBuf {
    folder.join("flame").join(format!("flame_{number:04}.npz"))
}

fn bytes(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

fn table(folder: &Path, name: &str) -> Flux {
    Flux::read_csv(&std::fs::read_to_string(folder.join(name)).unwrap(), name).unwrap()
}

/// Standard error of a run that succeeds.
fn notes(folder: &Path, arguments: &str) -> String {
    let output = pyrophone(folder, arguments);
    let notes = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments}: {notes}");
    assert!(notes.lines().all(|line| line.starts_with("note: ")), "{notes}");
    notes
}

#[test]
fn shards_make_what_one_run_makes() {
    let folder = folder();
    let at = folder.path();
    let options = "--peak-db -12 --sample-rate 48000 --start-frame 1";
    succeeds(at, &format!("flux --input flame --output one.wav --flux-csv one.csv {options}"));
    let sound = read(&at.join("one.wav"));
    assert_eq!((sound.sample_rate_hz, sound.len_samples()), (48_000, 20 * 48_000 / 360 + 1));
    let peak = sound.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!((20.0 * peak.log10() + 12.0).abs() < 1e-3, "{peak}");
    // Two frames after the start of the timeline.
    let file = bytes(at, "one.wav");
    let bext = file.windows(4).position(|id| id == b"bext").unwrap() + 8;
    assert_eq!(file[bext + 338..bext + 346], 267u64.to_le_bytes());
    let flux = table(at, "one.csv");
    assert_eq!(flux.rows.iter().map(|row| row.frame).collect::<Vec<_>>(), (3..=22).collect::<Vec<_>>());
    // The flow is as fast as it is far from the middle, in voxels. The spline takes a little off so small a ball.
    for row in &flux.rows {
        let radius = 0.1 * (5.0 + 0.7 * (row.frame as f64 * 0.9).sin());
        assert!((row.area / (4.0 * std::f64::consts::PI * radius * radius) - 1.0).abs() < 0.1, "{row:?}");
        assert!((row.flux / (row.area * radius * 10.0) - 1.0).abs() < 0.1, "{row:?}");
    }

    for (name, frames) in [("b.csv", "9-9"), ("c.csv", "10-22"), ("a.csv", "3-8")] {
        succeeds(at, &format!("flux --input flame --frames {frames} --partial {name}"));
    }
    succeeds(
        at,
        &format!("flux-merge c.csv a.csv b.csv --output merged.wav --flux-csv merged.csv --rate 360 {options}"),
    );
    // The frames say when they take place, and so do parts of them.
    succeeds(at, &format!("flux-merge c.csv a.csv b.csv --output timed.wav {options}"));
    assert_eq!(bytes(at, "timed.wav"), file);
    assert_eq!(bytes(at, "merged.wav"), file);
    assert_eq!(bytes(at, "merged.csv"), bytes(at, "one.csv"));
    // Nothing is left of the work in progress.
    let left = std::fs::read_dir(at)
        .unwrap()
        .filter(|entry| entry.as_ref().unwrap().file_name().to_string_lossy().contains("progress"));
    assert_eq!(left.count(), 0);

    refuses(at, "flux-merge a.csv c.csv --output x.wav", 1, &["frame 9", "none of the files"]);
    refuses(at, "flux-merge a.csv b.csv c.csv a.csv --output x.wav", 1, &["frame 3", "a.csv", "overlap"]);
    succeeds(at, "flux --input flame --frames 9-9 --iso 0.6 --partial other.csv");
    refuses(at, "flux-merge a.csv other.csv c.csv --output x.wav", 1, &["a.csv", "other.csv", "iso 0.5", "iso 0.6"]);
    refuses(at, "flux-merge one.csv --output x.wav", 1, &["one.csv", "line 1", "not a part"]);
    refuses(at, "flux-merge a.csv none.csv --output x.wav", 1, &["none.csv", "no such file"]);
    refuses(at, "flux-merge a.csv --output x.wav --flux-csv a.csv", 1, &["a.csv", "overwrite"]);
    refuses(at, "flux-merge one.wav --output x.wav", 1, &["one.wav", "text"]);
    refuses(at, "flux-merge --output x.wav", 2, &["SHARD"]);
}

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
fn frame_lists_are_clamped_and_stepped() {
    let folder = folder();
    let at = folder.path();
    let frames = |list: &str| {
        succeeds(at, &format!("flux --input flame --frames {list} --partial part.csv"));
        let text = std::fs::read_to_string(at.join("part.csv")).unwrap();
        FluxShard::read(&text, "part").unwrap().steps.keys().copied().collect::<Vec<_>>()
    };
    assert_eq!(frames("1-4"), [3, 4], "a farm's first chunk may begin before the frames do");
    assert_eq!(frames("21-50"), [21, 22], "and its last one end behind them");
    assert_eq!(frames("3-9x3"), [3, 6, 9]);
    assert_eq!(frames("4,7-8"), [4, 7, 8]);
    assert_eq!(frames("30-60"), Vec::<i64>::new(), "such a part is empty");
    succeeds(at, "flux --input flame --frames 3-12 --partial a.csv");
    succeeds(at, "flux --input flame --frames 13-22 --partial b.csv");
    succeeds(at, "flux --input flame --flux-csv one.csv");
    succeeds(at, "flux-merge part.csv b.csv a.csv --flux-csv merged.csv");
    assert_eq!(bytes(at, "merged.csv"), bytes(at, "one.csv"));
    // Simulated again meanwhile: the parts do not belong together any more.
    flame(&frame(at, 20), 21, 0.11);
    let other = std::fs::read(frame(at, 20)).unwrap();
    std::fs::write(frame(at, 20), [other, vec![0]].concat()).unwrap();
    succeeds(at, "flux --input flame --frames 13-19 --partial b.csv");
    refuses(at, "flux-merge a.csv b.csv --output x.wav", 1, &["a.csv", "b.csv", "different caches"]);
    let text = std::fs::read_to_string(at.join("a.csv")).unwrap();
    std::fs::write(at.join("a.csv"), &text[..text.len() - 10]).unwrap();
    refuses(at, "flux-merge a.csv --output x.wav", 1, &["a.csv", "truncated or modified"]);
}

/// A shard in which no frame can be read writes an empty part, and does not stop the farm.
#[test]
fn shards_without_a_good_frame_write_empty_parts() {
    let folder = folder();
    let at = folder.path();
    for number in 3..=6 {
        std::fs::write(frame(at, number), b"no frame").unwrap();
    }
    refuses(at, "flux --input flame --frames 3-6 --partial a.csv", 1, &["flame_0003.npz"]);
    succeeds(at, "flux --input flame --frames 3-6 --partial a.csv --skip-bad");
    succeeds(at, "flux --input flame --frames 7-22 --partial b.csv --skip-bad");
    succeeds(at, "flux --input flame --flux-csv one.csv --skip-bad");
    succeeds(at, "flux-merge a.csv b.csv --flux-csv merged.csv");
    assert_eq!(bytes(at, "merged.csv"), bytes(at, "one.csv"));
}

/// What stands between the frames of a film: the same from shards and from one run, and always said to be made up.
#[test]
fn frames_of_film_are_upsampled() {
    let folder = folder();
    let at = folder.path();
    let said = notes(at, "flux --input flame --rate 24 --output auto.wav --flux-csv auto.csv");
    assert!(
        said.contains("24 frames per second are upsampled to 360 steps") && said.contains("plausible, not true"),
        "{said}"
    );
    assert!(!notes(at, "flux --input flame --output x.wav").contains("plausible"), "360 a second are enough");
    for method in ["flips", "noise", "cubic", "release"] {
        let options = format!("--rate 24000/1001 --upsample {method} --upsample-seed 7");
        let said = notes(at, &format!("flux --input flame --output one.wav --flux-csv one.csv {options}"));
        assert!(said.contains(method), "{said}");
        for (name, frames) in [("b.csv", "9"), ("c.csv", "10-22"), ("a.csv", "3-8")] {
            succeeds(at, &format!("flux --input flame --frames {frames} --partial {name} {options}"));
        }
        succeeds(at, "flux-merge c.csv a.csv b.csv --output merged.wav --flux-csv merged.csv");
        assert_eq!(bytes(at, "merged.wav"), bytes(at, "one.wav"), "{method}");
        assert_eq!(bytes(at, "merged.csv"), bytes(at, "one.csv"), "{method}");
        // The table tells its times, so that it needs no rate when it is read again.
        succeeds(at, "flux --input one.csv --output again.wav");
        assert_eq!(read(&at.join("again.wav")).len_samples(), read(&at.join("one.wav")).len_samples());
    }
    refuses(at, "flux --input flame --measure change --upsample flips --output x.wav", 1, &["--measure change"]);
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
fn a_series_goes_straight_to_pressure() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let flux: Vec<f64> = (0..720).map(|step| (std::f64::consts::TAU * 60.0 * f64::from(step) / 360.0).sin()).collect();
    let rows: String = flux.iter().enumerate().map(|(frame, flux)| format!("{frame},{flux:?},1\n")).collect();
    std::fs::write(at.join("flux.csv"), format!("frame,flux,area\n{rows}")).unwrap();
    succeeds(at, "flux --input flux.csv --output csv.wav --time-reference 12345678901 --rate 360");
    let sound = read(&at.join("csv.wav"));
    assert_eq!((sound.sample_rate_hz, sound.len_samples(), sound.channels.len()), (44_100, 88_200, 1));
    let file = bytes(at, "csv.wav");
    let bext = file.windows(4).position(|id| id == b"bext").unwrap() + 8;
    assert_eq!(file[bext + 338..bext + 346], 12_345_678_901u64.to_le_bytes());
    // A sound's samples are steps at its own rate.
    let dense: Vec<f32> = (0..4000).map(|n| (std::f32::consts::TAU * 60.0 * n as f32 / 2000.0).sin()).collect();
    write(at, "dense.wav", &[dense], 2000);
    succeeds(at, "flux --input dense.wav --output dense_out.wav");
    let dense = read(&at.join("dense_out.wav"));
    assert_eq!(dense.len_samples(), 88_200);
    // Both are cosines of 60 Hz at -6 dB.
    let far = (40_000..50_000).map(|n| (dense.channels[0][n] - sound.channels[0][n]).abs()).fold(0.0, f32::max);
    assert!(far < 0.1, "{far}");
    for option in ["--rate 100", "--iso 0.5", "--partial x.csv", "--frames 1-2", "--flux-csv y.csv", "--mesh z"] {
        let name = option.split(' ').next().unwrap();
        refuses(
            at,
            &format!("flux --input dense.wav --output x.wav {option}"),
            1,
            &["dense.wav", name, "leave it out"],
        );
    }
    refuses(at, "flux --input dense.wav --output dense.wav", 1, &["dense.wav", "overwrite"]);
    refuses(at, "flux --input flux.csv --output flux.csv", 1, &["flux.csv", ".csv files cannot be written"]);
    std::fs::write(at.join("bad.csv"), "frame,flux\n1,2\n2,x\n").unwrap();
    refuses(at, "flux --input bad.csv --output x.wav", 1, &["bad.csv", "line 3"]);
    std::fs::write(at.join("still.csv"), "1.5\n".repeat(100)).unwrap();
    succeeds(at, "flux --input still.csv --output still.wav --rate 360");
    assert!(read(&at.join("still.wav")).channels[0].iter().all(|sample| *sample == 0.0));
}

#[test]
fn low_frame_rate_notes_that_only_an_envelope_is_reliable() {
    let folder = folder();
    let at = folder.path();
    let said = notes(at, "flux --input flame --output p.wav --rate 24 --upsample off");
    assert!(said.contains("12 Hz only") && said.contains("--as envelope"), "{said}");
    let said = notes(at, "flux --input flame --output e.wav --rate 24 --as envelope --peak-db 0");
    assert!(!said.contains("12 Hz"), "{said}");
    let envelope = read(&at.join("e.wav"));
    assert!(envelope.channels[0].iter().all(|sample| (0.0..=1.0).contains(sample)));
    assert!(notes(at, "flux --input flame --output p.wav --rate 120 --upsample off").contains("60 Hz only"));
    assert!(notes(at, "flux --input flame --output p.wav --rate 360").contains("scaled by"));
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

#[test]
fn bad_options_are_refused() {
    let folder = folder();
    let at = folder.path();
    write(at, "good.wav", &[vec![0.1; 2000]], 8000);
    for (options, says) in [
        ("--output x.wav --rate 0", &["step rate", "0", "768000"][..]),
        ("--output x.wav --refine 0", &["refinement", "0", "16"]),
        ("--output x.wav --iso nan", &["iso", "NaN"]),
        ("--output x.wav --peak-db 3", &["peak", "3", "-100"]),
        ("--output x.wav --high-pass -5", &["high-pass", "-5", "1000"]),
        ("--output x.wav --sample-rate 1000", &["sample rate", "1000", "8000"]),
        ("--output x.wav --field smoke", &["smoke", "flame"]),
        ("--output x.wav --velocity wind", &["wind", "velocity"]),
        ("--output x.wav --start-frame 4", &["--start-frame is 4", "first frame is 3"]),
        ("--output x.wav --flux-csv x.wav", &["x.wav", "two outputs"]),
        ("--partial x.csv --flux-csv x.csv", &["x.csv", "two outputs"]),
        ("--flux-csv flame/flame_0004.npz", &["flame_0004.npz", "overwrite"]),
        ("--output flame/flame_0004.npz", &["flame_0004.npz", ".npz files cannot be written"]),
        ("--output no/folder/x.wav", &["no folder no/folder"]),
        ("--output flame", &["flame", "a folder"]),
        ("--frames 3-5 --flux-csv flame/flame_0009.npz", &["flame_0009.npz", "overwrite"]),
        ("", &["nothing to write", "--output"]),
    ] {
        refuses(at, &format!("flux --input flame {options}"), 1, says);
    }
    for (options, says) in [
        ("--frames 9-3", &["first frame", "last"][..]),
        ("--frames 1-8x0", &["1-8x2"]),
        ("--rate 24/x", &["'x'"]),
        ("--upsample twice", &["twice", "flips"]),
        ("--frames x", &["'x'"]),
        ("--time-reference 5 --start-frame 1", &["--time-reference", "--start-frame"]),
        ("--mesh-every 2", &["--mesh"]),
        ("--mesh m --mesh-every 0", &["--mesh-every"]),
        ("--placement here", &["here", "collocated"]),
    ] {
        refuses(at, &format!("flux --input flame --output x.wav {options}"), 2, says);
    }
    refuses(at, "flux --input none --output x.wav", 1, &["none", "no such file"]);
    refuses(at, "flux --input none.wav --output x.wav", 1, &["none.wav", "no such file"]);
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

/// Where the first sample stands, and what editing programs are told beside it.
#[test]
fn film_places_the_sound() {
    let folder = folder();
    let at = folder.path();
    let stamp = |options: &str| {
        succeeds(at, &format!("flux --input flame --sample-rate 48000 --output film.wav {options}"));
        pyrophone_recording::Broadcast::of_file(&at.join("film.wav")).unwrap()
    };
    let found =
        stamp("--film-rate 24 --film-frame 1001 --timeline-start 977 --timecode 01:00:00:00 --scene 12A --take 3");
    assert_eq!(found.time_reference_samples, 48_000 * 3601);
    let ixml = found.ixml.unwrap();
    for part in ["<SCENE>12A</SCENE>", "<TAKE>3</TAKE>", "<TIMECODE_RATE>24/1</TIMECODE_RATE>", "NDF", "172848000"] {
        assert!(ixml.contains(part), "{part} in {ixml}");
    }
    let pulled = stamp("--film-rate 23.976 --film-frame 25 --timeline-start 1");
    assert_eq!(pulled.time_reference_samples, 48_048);
    assert!(pulled.ixml.unwrap().contains("24000/1001") && pulled.date.is_none());
    // The film's frames are the simulation's, where both have one rate.
    assert_eq!(stamp("--rate 24 --film-rate 24 --timeline-start 1").time_reference_samples, 4000);
    assert!(stamp("--dated").date.is_some_and(|date| date.len() == 10));
    for (options, says) in [
        ("--film-rate 24", &["--film-frame"][..]),
        ("--film-rate 24 --film-frame 3 --timeline-start 9", &["before the timeline's start"]),
        ("--film-rate 24 --film-frame 3 --timecode 00:00:00:24", &["--timecode", "23"]),
    ] {
        refuses(at, &format!("flux --input flame --output x.wav {options}"), 1, says);
    }
    for (options, says) in [
        ("--film-rate 24.3", &["not a film or television rate"][..]),
        ("--film-frame 3", &["--film-rate"]),
        ("--film-rate 24 --start-frame 1", &["--start-frame"]),
        ("--film-rate 24 --timecode 1:2", &["timecode"]),
    ] {
        refuses(at, &format!("flux --input flame --output x.wav {options}"), 2, says);
    }
}

#[test]
fn a_film_bends_time() {
    let folder = folder();
    let at = folder.path();
    // Frames 3 to 22 in 19 frames of film, and then at half the speed.
    std::fs::write(at.join("curve.csv"), "film,simulation\n1001,3\n1011,13\n1029,22\n").unwrap();
    succeeds(
        at,
        "flux --input flame --rate 24 --film-rate 24 --retime curve.csv --timeline-start 1001 --output film.wav --flux-csv film.csv",
    );
    let sound = read(&at.join("film.wav"));
    let seconds = sound.len_samples() as f64 / f64::from(sound.sample_rate_hz);
    assert!((seconds - 28.0 / 24.0).abs() < 0.01, "{seconds}");
    refuses(at, "flux --input flame --film-rate 24 --retime none.csv --output x.wav", 1, &["none.csv"]);
}

/// Two flames of a shot keep their balance.
#[test]
fn flames_of_a_shot_share_their_scale() {
    let folder = folder();
    let at = folder.path();
    let flux = table_of(at, "flux --input flame");
    let scaled = |factor: f64| flux.iter().map(|flux| format!("{:?}\n", factor * flux)).collect::<String>();
    std::fs::write(at.join("loud.csv"), scaled(1.0)).unwrap();
    std::fs::write(at.join("soft.csv"), scaled(0.25)).unwrap();
    for name in ["loud", "soft"] {
        succeeds(at, &format!("flux --input {name}.csv --rate 360 --output {name}.wav --scale-file shot.scale"));
    }
    let [loud, soft] = ["loud.wav", "soft.wav"].map(|name| read(&at.join(name)).channels[0].clone());
    let peak = |samples: &[f32]| samples.iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!((peak(&soft) / peak(&loud) - 0.25).abs() < 1e-3, "{} {}", peak(&soft), peak(&loud));
    std::fs::write(at.join("bad.scale"), "loud").unwrap();
    refuses(at, "flux --input loud.csv --rate 360 --output x.wav --scale-file bad.scale", 1, &["bad.scale"]);
}

/// The flux that a command writes to a table.
fn table_of(at: &Path, command: &str) -> Vec<f64> {
    succeeds(at, &format!("{command} --flux-csv of.csv"));
    table(at, "of.csv").rows.iter().map(|row| row.flux).collect()
}
