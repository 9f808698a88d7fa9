//! No bytes whatever bring the decoder down.

use crate::files::{AIFF_44100, INTEGER, aiff_16, caf_f32, flac_16, wav, wav_f32, wav_format, wav_format_extensible};
use proptest::prelude::*;
use pyrophone_recording::{decode_bytes, no_progress};

/// One whole file of each kind that can be made by hand.
fn whole(kind: usize) -> Vec<u8> {
    match kind {
        0 => wav_f32(&[0.25; 64], 44_100),
        1 => wav(&wav_format(INTEGER, 2, 48_000, 24), &[3; 96]),
        2 => wav(&wav_format_extensible(INTEGER, 2, 48_000, 16, 16), &[5; 96]),
        3 => aiff_16(2, &[100; 64], AIFF_44100.0, AIFF_44100.1),
        4 => caf_f32(&[0.5; 64], 48_000.0),
        _ => flac_16(&[77; 4096]),
    }
}

/// Either a refusal of one line or a recording within the limits.
fn survives(bytes: &[u8]) -> Result<(), TestCaseError> {
    match decode_bytes(bytes, "fire", &no_progress) {
        Ok(recording) => {
            prop_assert!((1..=8).contains(&recording.channels.len()));
            prop_assert!(recording.len_samples() > 0);
            prop_assert!(recording.channels.iter().all(|channel| channel.len() == recording.len_samples()));
            prop_assert!(recording.channels.iter().flatten().all(|sample| sample.is_finite()));
            prop_assert!((1_000..=768_000).contains(&recording.sample_rate_hz));
        }
        Err(error) => prop_assert!(!error.to_string().contains('\n'), "{}", error),
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn random_bytes(bytes in proptest::collection::vec(any::<u8>(), 0..4000)) {
        survives(&bytes)?;
    }

    /// A known beginning, then anything.
    #[test]
    fn random_bytes_behind_a_mark(
        mark in prop::sample::select(vec![
            &b"RIFF\xff\0\0\0WAVE"[..], b"RIFF\xff\0\0\0WAVEfmt \x10\0\0\0", b"FORM\0\0\0\xffAIFF", b"FORM\0\0\0\xffAIFC",
            b"caff\0\x01\0\0desc", b"fLaC\0\0\0\x22", b"OggS\0\x02", b"ID3\x04\0\0", b"\xff\xfb\x90\x64", b"\xff\xf1",
        ]),
        bytes in proptest::collection::vec(any::<u8>(), 0..3000),
    ) {
        survives(&[mark, &bytes[..]].concat())?;
    }

    /// Whole files with up to eight bytes of their header changed and their end cut off.
    #[test]
    fn mutated_files(
        kind in 0usize..6,
        changes in proptest::collection::vec((0usize..120, any::<u8>()), 1..8),
        keep in 0.3f64..=1.0,
    ) {
        let mut bytes = whole(kind);
        for (at, value) in changes {
            let at = at % bytes.len();
            bytes[at] = value;
        }
        bytes.truncate((bytes.len() as f64 * keep) as usize);
        survives(&bytes)?;
    }
}

#[test]
fn the_files_that_are_mutated_are_whole() {
    for kind in 0..6 {
        decode_bytes(&whole(kind), "fire", &no_progress).unwrap_or_else(|error| panic!("kind {kind}: {error}"));
    }
}
