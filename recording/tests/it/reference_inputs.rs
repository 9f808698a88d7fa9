//! Every sound file of the reference inputs, with the result that its list asks for.

use std::path::{Path, PathBuf};

use pyrophone_recording::{Note, decode, no_progress};

/// The folder of odd inputs; where there is none, says so (and fails under `CI=true`).
fn inputs() -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference");
    let folder = std::env::var_os("PYROPHONE_REFERENCE").map_or_else(default, PathBuf::from).join("inputs");
    if folder.is_dir() {
        return Some(folder);
    }
    let missing = format!("no reference data at {}: set PYROPHONE_REFERENCE", folder.display());
    assert!(std::env::var("CI").as_deref() != Ok("true"), "{missing}");
    crate::skip::skip(&missing);
    None
}

/// Expected result for a file.
enum Expected {
    /// A number of samples, without a note.
    Samples(std::ops::RangeInclusive<usize>),
    /// A number of samples, with a note.
    Noted(std::ops::RangeInclusive<usize>, fn(&Note) -> bool),
    /// A refusal that says all of this.
    Refused(&'static [&'static str]),
}

use Expected::{Noted, Refused, Samples};

const TABLE: &[(&str, Expected)] = &[
    ("aiff_then_marker_chunk.aif", Samples(9000..=9000)),
    ("aiff_ssnd_before_comm.aif", Samples(9000..=9000)),
    ("aiff_ssnd_offset_16.aif", Samples(9000..=9000)),
    ("concat_same.mp3", Samples(191_000..=195_000)),
    ("mp3_xing_frames_0.mp3", Noted(95_500..=98_000, |note| matches!(note, Note::CountDiffers { declared: 0, .. }))),
    ("mp3_id3_frame_too_long.mp3", Samples(95_500..=98_000)),
    ("mp3_id3_exthdr_bad.mp3", Samples(95_500..=98_000)),
    ("flac_rate_changes.flac", Refused(&["sample rate", "48000", "44100"])),
    ("flac_id3v1_at_end.flac", Samples(96_000..=96_000)),
    ("flac_cuesheet_cd_not_588.flac", Samples(96_000..=96_000)),
    ("wav_info_odd_unpadded_last.wav", Samples(9000..=9000)),
    ("wav_fmt20_pcm.wav", Samples(9000..=9000)),
    // One frame more than its siblings: its data chunk is 36004 bytes long.
    ("wav_24bit_in_4_bytes.wav", Samples(9000..=9001)),
    ("wav_unknown_length_ffffffff.wav", Noted(9000..=9000, |note| matches!(note, Note::UnknownLength { .. }))),
    ("loud.mp3", Samples(88_000..=90_500)),
    ("twin_quiet.wav", Samples(144_000..=144_000)),
    ("twin_dc.wav", Samples(144_000..=144_000)),
];

#[test]
fn every_odd_sound_has_the_right_result() {
    let Some(folder) = inputs() else { return };
    let mut count = 0;
    for (name, expected) in TABLE {
        let found = decode(&folder.join(name), &no_progress);
        count += 1;
        match (expected, found) {
            (Samples(samples), Ok(found)) => {
                assert!(samples.contains(&found.len_samples()), "{name}: {} samples", found.len_samples());
                assert_eq!(found.notes, [], "{name}");
            }
            (Noted(samples, is_note), Ok(found)) => {
                assert!(samples.contains(&found.len_samples()), "{name}: {} samples", found.len_samples());
                assert!(matches!(&found.notes[..], [note] if is_note(note)), "{name}: {:?}", found.notes);
            }
            (Refused(says), Err(error)) => {
                assert!(says.iter().all(|part| error.to_string().contains(part)), "{name}: {error}");
            }
            (_, Ok(found)) => panic!("{name}: {} samples, where it must be refused", found.len_samples()),
            (_, Err(error)) => panic!("{error}"),
        }
    }
    assert!(count > 0);
    let is_sound = |name: &str| [".wav", ".aif", ".mp3", ".flac"].iter().any(|end| name.ends_with(end));
    let names = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
    for name in names.filter(|name| is_sound(name)) {
        assert!(TABLE.iter().any(|(known, _)| *known == name), "{name} is not in the table");
    }
}

#[test]
fn overs_in_mp3_are_kept() {
    let Some(folder) = inputs() else { return };
    let loud = decode(&folder.join("loud.mp3"), &no_progress).unwrap();
    let peak = loud.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!((peak - 2.11).abs() < 0.01, "a peak of {peak}");
}

#[test]
fn twenty_four_bits_in_four_bytes_are_at_their_level() {
    let Some(folder) = inputs() else { return };
    let padded = decode(&folder.join("wav_24bit_in_4_bytes.wav"), &no_progress).unwrap();
    let peak = padded.channels[0].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!((0.5..1.0).contains(&peak), "a peak of {peak}");
}
