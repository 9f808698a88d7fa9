//! Parts of a simulation that are measured apart and merged.

use super::{bytes, flame, folder, frame, table};
use crate::common::{read, refuses, succeeds};
use pyrophone_flame::flux::FluxShard;

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
