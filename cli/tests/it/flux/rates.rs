//! Few frames per second: upsampling, and the limits without it.

use super::{bytes, folder, notes};
use crate::common::{read, refuses, succeeds};

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
    let said = notes(at, "flux --input flame --measure change --rate 24 --output change.wav");
    assert!(said.contains("--upsample noise"), "{said}");
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
