//! Recordings that must be refused, with a message that names the file, what was found, and what to
//! do.

use std::path::Path;

use crate::files::{AIFF_44100, FLOAT, INTEGER, aiff_16, caf_f32, wav, wav_f32, wav_format, wav_format_extensible};
use pyrophone_recording::{Error, decode, decode_bytes, no_progress};

/// Asserts the kind of the refusal and what its one line says.
#[track_caller]
fn refused(result: Result<pyrophone_recording::Recording, Error>, is: fn(&Error) -> bool, says: &[&str]) {
    let error = result.expect_err("a bad recording was taken");
    assert!(is(&error), "wrong kind of refusal: {error:?}");
    let message = error.to_string();
    assert!(!message.contains('\n'), "more than one line: {message}");
    for part in says {
        assert!(message.contains(part), "'{part}' is missing from: {message}");
    }
    assert!(message.contains(';'), "no remedy in: {message}");
}

fn decoded(bytes: &[u8]) -> Result<pyrophone_recording::Recording, Error> {
    decode_bytes(bytes, "fire.wav", &no_progress)
}

macro_rules! kind {
    ($pattern:pat) => {
        |error: &Error| matches!(error, $pattern)
    };
}

#[test]
fn missing_file_is_refused() {
    let path = Path::new("no/such/folder/fire.wav");
    refused(decode(path, &no_progress), kind!(Error::Missing { .. }), &["no/such/folder/fire.wav", "no such file"]);
}

#[test]
fn a_folder() {
    let folder = tempfile::tempdir().unwrap();
    refused(decode(folder.path(), &no_progress), kind!(Error::Folder { .. }), &["folder", "choose a file"]);
}

#[cfg(unix)]
#[test]
fn no_permission() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fire.wav");
    std::fs::write(&path, wav_f32(&[0.0; 8], 44_100)).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    // The superuser reads everything.
    if std::fs::File::open(&path).is_ok() {
        eprintln!("skipped: running as a user whom permissions do not bind");
        return;
    }
    refused(decode(&path, &no_progress), kind!(Error::NoPermission { .. }), &["fire.wav", "permission"]);
}

#[test]
fn empty_file_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("fire.wav");
    std::fs::write(&path, b"").unwrap();
    refused(decode(&path, &no_progress), kind!(Error::Empty { .. }), &["fire.wav", "0 bytes", "again"]);
    refused(decoded(b""), kind!(Error::Empty { .. }), &["fire.wav", "0 bytes"]);
}

#[test]
fn truncated_wav() {
    let mut file = wav_f32(&[0.25; 1000], 44_100);
    file.truncate(file.len() - 1500);
    let exactly = kind!(Error::Truncated { found: 2500, declared: 4000, .. });
    refused(decoded(&file), exactly, &["fire.wav", "2500 of 4000 bytes", "again"]);
}

#[test]
fn wav_that_ends_in_its_header() {
    let file = wav_f32(&[0.25; 10], 44_100);
    for len in 12..44 {
        let error = decoded(&file[..len]).expect_err("a header without sound was taken");
        assert!(matches!(error, Error::Damaged { .. } | Error::Truncated { .. }), "at {len} bytes: {error:?}");
    }
}

#[test]
fn truncated_aiff() {
    let mut file = aiff_16(1, &[1000; 500], AIFF_44100.0, AIFF_44100.1);
    file.truncate(file.len() - 100);
    refused(decoded(&file), kind!(Error::Truncated { found: 908, declared: 1008, .. }), &["908 of 1008"]);
}

#[test]
fn truncated_caf() {
    let mut file = caf_f32(&[0.5; 500], 44_100.0);
    file.truncate(file.len() - 100);
    refused(decoded(&file), kind!(Error::Truncated { .. }), &["1904 of 2004"]);
}

#[test]
fn text_file_is_refused_as_no_audio() {
    let lines = "time,beta\n0.0,1.5\n".repeat(40);
    refused(decoded(lines.as_bytes()), kind!(Error::NotAudio { .. }), &["fire.wav", "text", "FLAC"]);
}

#[test]
fn picture_is_refused_as_no_audio() {
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    file.extend([0; 300]);
    refused(decoded(&file), kind!(Error::NotAudio { .. }), &["PNG picture", "use WAV"]);
}

#[test]
fn file_of_zeros_is_refused_as_no_audio() {
    refused(decoded(&[0; 4000]), kind!(Error::NotAudio { .. }), &["4000 bytes", "use WAV"]);
}

#[test]
fn unsupported_codings() {
    let adpcm = wav(&wav_format(2, 1, 44_100, 4), &[0; 64]);
    refused(decoded(&adpcm), kind!(Error::Unsupported { .. }), &["ADPCM", "convert it to WAV"]);
    let mp3_in_wav = wav(&wav_format(0x55, 1, 44_100, 16), &[0; 64]);
    refused(decoded(&mp3_in_wav), kind!(Error::Unsupported { .. }), &["0x0055"]);
    let odd_bits = wav(&wav_format(INTEGER, 1, 44_100, 12), &[0; 64]);
    refused(decoded(&odd_bits), kind!(Error::Unsupported { .. }), &["12 bits"]);
    let odd_extensible = wav(&wav_format_extensible(INTEGER, 1, 44_100, 40, 40), &[0; 65]);
    refused(decoded(&odd_extensible), kind!(Error::Unsupported { .. }), &["40 bits"]);
    let mut other_end = wav_f32(&[0.0; 8], 44_100);
    other_end[..4].copy_from_slice(b"RIFX");
    refused(decoded(&other_end), kind!(Error::Unsupported { .. }), &["RIFX"]);
    let mut film = b"\0\0\0\x20ftypisom".to_vec();
    film.extend([0; 200]);
    refused(decoded(&film), kind!(Error::Unsupported { .. }), &["MP4"]);
}

#[test]
fn not_a_number() {
    let mut samples = [0.5f32; 100];
    samples[37] = f32::NAN;
    let exactly = kind!(Error::NotFinite { channel: 0, index: 37, .. });
    refused(decoded(&wav_f32(&samples, 44_100)), exactly, &["fire.wav", "sample 37", "NaN", "repair"]);
}

#[test]
fn infinite_in_the_second_channel() {
    let sound: Vec<u8> =
        [0.0, 0.0, 0.0, f32::NEG_INFINITY, f32::NAN, 0.0].iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let file = wav(&wav_format(FLOAT, 2, 48_000, 32), &sound);
    refused(decoded(&file), kind!(Error::NotFinite { channel: 1, index: 1, .. }), &["sample 1 of channel 1", "-inf"]);
}

#[test]
fn none_and_too_many_channels_are_refused() {
    let none = wav(&wav_format(INTEGER, 0, 44_100, 16), &[0; 64]);
    refused(decoded(&none), kind!(Error::NoChannels { .. }), &["0 channels", "1 to 10"]);
    let many = wav(&wav_format(INTEGER, 11, 44_100, 16), &[0; 22 * 8]);
    refused(
        decoded(&many),
        kind!(Error::TooManyChannels { found: 11, .. }),
        &["11 channels", "at most 10", "mix it down"],
    );
    let absurd = wav(&wav_format(INTEGER, 65535, 44_100, 8), &[0; 65535]);
    refused(decoded(&absurd), kind!(Error::TooManyChannels { found: 65535, .. }), &["65535 channels"]);
    let aiff = aiff_16(0, &[0; 16], AIFF_44100.0, AIFF_44100.1);
    refused(decoded(&aiff), kind!(Error::NoChannels { .. }), &["0 channels"]);
}

#[test]
fn sample_rates() {
    for rate_hz in [0, 1, 999, 768_001, u32::MAX] {
        let error = decoded(&wav_f32(&[0.0; 8], rate_hz));
        refused(error, kind!(Error::SampleRate { .. }), &[&format!("{rate_hz} Hz"), "1000", "768000", "48000 Hz"]);
    }
    refused(decoded(&aiff_16(1, &[0; 16], 0, 0)), kind!(Error::SampleRate { found_hz: 0, .. }), &["0 Hz"]);
    refused(decoded(&caf_f32(&[0.0; 8], f64::NAN)), kind!(Error::SampleRate { .. }), &["0 Hz"]);
}

#[test]
fn no_samples() {
    refused(decoded(&wav_f32(&[], 44_100)), kind!(Error::NoSamples { .. }), &["0 samples", "at least 1"]);
    let aiff = aiff_16(1, &[], AIFF_44100.0, AIFF_44100.1);
    refused(decoded(&aiff), kind!(Error::NoSamples { .. }), &["0 samples"]);
    refused(decoded(&caf_f32(&[], 44_100.0)), kind!(Error::NoSamples { .. }), &["0 samples"]);
}

#[test]
fn less_than_one_frame() {
    let file = wav(&wav_format(FLOAT, 2, 44_100, 32), &[0; 6]);
    refused(decoded(&file), kind!(Error::NoSamples { .. }), &["0 samples"]);
}

#[test]
fn frames_of_the_wrong_size() {
    let mut format = wav_format(FLOAT, 2, 44_100, 32);
    format[12] = 0;
    refused(decoded(&wav(&format, &[0; 64])), kind!(Error::Damaged { .. }), &["0 bytes where 8", "again"]);
}

#[test]
fn sound_before_format() {
    let mut file = b"RIFF\x10\0\0\0WAVEdata\x04\0\0\0".to_vec();
    file.extend([0; 4]);
    refused(decoded(&file), kind!(Error::Damaged { .. }), &["before its format"]);
}

#[test]
fn too_long() {
    // One hour and one second at the lowest rate, one byte per sample.
    let file = wav(&wav_format(INTEGER, 1, 1000, 8), &vec![128; 3_601_000]);
    refused(decoded(&file), kind!(Error::TooLong { .. }), &["3601 s", "3600 s", "shorter"]);
}

#[test]
fn flac_with_its_end_missing() {
    let (file, _) = files_flac();
    refused(
        decoded(&file[..file.len() / 2]),
        |error| matches!(error, Error::Truncated { .. } | Error::Damaged { .. }),
        &["fire.wav"],
    );
}

/// A FLAC file of two verbatim frames (16 bits, mono, 4096 samples each) and its samples.
fn files_flac() -> (Vec<u8>, Vec<i16>) {
    let samples: Vec<i16> = (0..8192).map(|n| ((n * 37) % 20_000) as i16 - 10_000).collect();
    (crate::files::flac_16(&samples), samples)
}

#[test]
fn flac_whole() {
    let (file, samples) = files_flac();
    let recording = decoded(&file).unwrap();
    let expected: Vec<f32> = samples.iter().map(|sample| f32::from(*sample) / 32768.0).collect();
    assert_eq!(recording.channels, [expected]);
    assert_eq!(recording.sample_rate_hz, 44_100);
}

#[test]
fn cancelled_decoding_is_an_error() {
    let file = wav_f32(&[0.5; 100_000], 44_100);
    assert_eq!(decode_bytes(&file, "fire.wav", &|_| false), Err(Error::Cancelled));
}

#[test]
fn names_stay_on_one_line() {
    let error = decode_bytes(b"", "fire\nstorm\u{7}.wav", &no_progress).unwrap_err();
    assert!(!error.to_string().contains(['\n', '\u{7}']));
}
