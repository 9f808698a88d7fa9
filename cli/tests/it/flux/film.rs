//! The sound on the timeline of a film.

use super::folder;
use crate::common::{read, refuses, succeeds};

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
