//! Options that are refused.

use super::folder;
use crate::common::{refuses, write};

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
