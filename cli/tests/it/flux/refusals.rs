//! Options that are refused.

use super::folder;
use crate::common::{pyrophone, refuses, succeeds, write};
use pyrophone_flame::import::npz::{DenseFrame, write_frame};

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

#[test]
fn frames_whose_flips_cannot_be_known_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::create_dir(at.join("wide")).unwrap();
    // A flame at one end of a long box; at the other, in the second frame, a speed that is no number.
    let shape = [64, 16, 16];
    let count = shape.iter().product();
    let flame: Vec<[f32; 1]> = (0..count).map(|n| [if n / 256 < 6 { 1.0 } else { 0.0 }]).collect();
    for number in 1..=3 {
        let mut velocity: Vec<[f32; 3]> = (0..count).map(|n| [(n / 256) as f32 * number as f32, 0.0, 0.0]).collect();
        if number == 2 {
            velocity[count - 1] = [f32::NAN; 3];
        }
        let (origin, time_s) = ([0.0; 3], Some(f64::from(number) / 24.0));
        let frame = DenseFrame { shape, flame: &flame, velocity: &velocity, voxel_size: 0.1, origin, time_s };
        let path = at.join(format!("wide/wide_000{number}.npz"));
        write_frame(std::fs::File::create(path).unwrap(), &frame).unwrap();
    }
    // The flux depends on the flow at the front alone; what burns between two frames depends on all of it.
    succeeds(at, "flux --input wide --upsample off --flux-csv x.csv");
    let output = pyrophone(at, "flux --input wide --upsample flips --flux-csv y.csv");
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && error.contains("wide_0002.npz"), "{error}");
}
