//! What is written comes back; what is decoded is what was stored.

use crate::files::{AIFF_44100, FLOAT, INTEGER, aiff_16, caf_f32, wav, wav_f32, wav_format, wav_format_extensible};
use proptest::prelude::*;
use pyrophone_recording::{
    Error, MAX_EMBEDDED_BYTES, content_hash, decode, decode_bytes, embed, no_progress, read, unembed, write_file,
    write_wav_f32,
};

fn bits(samples: &[f32]) -> Vec<u32> {
    samples.iter().map(|sample| sample.to_bits()).collect()
}

fn mono(file: &[u8]) -> Vec<f32> {
    let mut recording = decode_bytes(file, "test", &no_progress).unwrap();
    assert_eq!(recording.channels.len(), 1);
    recording.channels.remove(0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any finite float, denormals and negative zero included, passes a WAV file bit for bit.
    #[test]
    fn float_wav_is_exact(
        channels in 1usize..=8,
        frames in proptest::collection::vec(
            proptest::array::uniform8(any::<f32>().prop_filter("finite", |sample| sample.is_finite())), 1..3000),
        rate_hz in 1_000u32..=768_000,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole.wav");
        let sound: Vec<Vec<f32>> =
            (0..channels).map(|channel| frames.iter().map(|frame| frame[channel]).collect()).collect();
        write_wav_f32(&path, &sound, rate_hz).unwrap();
        let back = decode(&path, &no_progress).unwrap();
        prop_assert_eq!(back.sample_rate_hz, rate_hz);
        prop_assert_eq!(back.channels.len(), channels);
        for (written, read) in sound.iter().zip(&back.channels) {
            prop_assert_eq!(bits(written), bits(read));
        }
        prop_assert_eq!(back.name, "whole.wav");
        prop_assert_eq!(back.content_hash, content_hash(&read(&path).unwrap()));
    }

    #[test]
    fn embedding_is_exact(bytes in proptest::collection::vec(any::<u8>(), 0..5000)) {
        prop_assert_eq!(unembed(&embed(&bytes).unwrap()).unwrap(), bytes);
    }

    #[test]
    fn other_text_does_not_unpack_to_a_panic(text in ".{0,200}") {
        let _ = unembed(&text);
    }
}

#[test]
fn integer_wav() {
    let stored = |sound: &[u8], bits| mono(&wav(&wav_format(INTEGER, 1, 48_000, bits), sound));
    assert_eq!(stored(&[0, 64, 128, 255], 8), [-1.0, -0.5, 0.0, 127.0 / 128.0]);
    let sound: Vec<u8> = [-32768i16, -1, 0, 1, 32767].iter().flat_map(|sample| sample.to_le_bytes()).collect();
    assert_eq!(stored(&sound, 16), [-32768.0, -1.0, 0.0, 1.0, 32767.0].map(|sample: f32| sample / 32768.0));
    let numbers = [-8_388_608i32, -1, 0, 1, 8_388_607];
    let sound: Vec<u8> = numbers.iter().flat_map(|sample| sample.to_le_bytes()[..3].to_vec()).collect();
    assert_eq!(stored(&sound, 24), numbers.map(|sample| sample as f32 / 8_388_608.0));
    let numbers = [i32::MIN, -65_536, 0, 1 << 20, 1 << 30];
    let sound: Vec<u8> = numbers.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    assert_eq!(stored(&sound, 32), numbers.map(|sample| (f64::from(sample) / 2_147_483_648.0) as f32));
}

#[test]
fn double_wav() {
    let numbers = [0.1f64, -0.75, 1.5, 1e-30];
    let sound: Vec<u8> = numbers.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    assert_eq!(mono(&wav(&wav_format(FLOAT, 1, 44_100, 64), &sound)), numbers.map(|sample| sample as f32));
}

#[test]
fn extensible_wav() {
    // Valid bits are the upper ones of their container.
    let numbers = [-0x4000_0000i32, 0x1234_5600, 0];
    let sound: Vec<u8> = numbers.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let file = wav(&wav_format_extensible(INTEGER, 1, 44_100, 32, 24), &sound);
    assert_eq!(mono(&file), numbers.map(|sample| sample as f32 / 2_147_483_648.0));
    let sound: Vec<u8> = [0.25f32, -3.0].iter().flat_map(|sample| sample.to_le_bytes()).collect();
    assert_eq!(mono(&wav(&wav_format_extensible(FLOAT, 1, 44_100, 32, 32), &sound)), [0.25, -3.0]);
}

#[test]
fn every_channel_count() {
    for channels in 1..=8u16 {
        let samples: Vec<f32> = (0..channels * 5).map(|n| f32::from(n) / 64.0).collect();
        let sound: Vec<u8> = samples.iter().flat_map(|sample| sample.to_le_bytes()).collect();
        for format in [wav_format(FLOAT, channels, 44_100, 32), wav_format_extensible(FLOAT, channels, 44_100, 32, 32)]
        {
            let recording = decode_bytes(&wav(&format, &sound), "test.wav", &no_progress).unwrap();
            for (channel, decoded) in recording.channels.iter().enumerate() {
                let expected: Vec<f32> = samples.iter().skip(channel).step_by(channels.into()).copied().collect();
                assert_eq!(*decoded, expected, "channel {channel} of {channels}");
            }
        }
    }
}

#[test]
fn chunks_around_the_sound() {
    let plain = wav_f32(&[0.5, -0.5, 0.125], 44_100);
    let mut file = plain[..12].to_vec();
    file.extend(b"JUNK\x03\0\0\0abc\0");
    file.extend(&plain[12..]);
    file.extend(b"LIST\xff\xff\0\0cut");
    assert_eq!(mono(&file), [0.5, -0.5, 0.125]);
}

#[test]
fn aiff_and_caf() {
    let recording =
        decode_bytes(&aiff_16(2, &[16384, -8192, 0, 1], AIFF_44100.0, AIFF_44100.1), "a.aiff", &no_progress);
    let recording = recording.unwrap();
    assert_eq!(recording.channels, [[0.5, 0.0], [-0.25, 1.0 / 32768.0]]);
    assert_eq!(recording.sample_rate_hz, 44_100);
    let recording = decode_bytes(&caf_f32(&[0.3, -2.0, 1e-40], 96_000.0), "a.caf", &no_progress).unwrap();
    assert_eq!(bits(&recording.channels[0]), bits(&[0.3, -2.0, 1e-40]));
    assert_eq!(recording.sample_rate_hz, 96_000);
}

#[test]
fn one_sample_is_enough() {
    assert_eq!(mono(&wav_f32(&[0.5], 44_100)), [0.5]);
}

#[test]
fn progress_rises_to_its_end() {
    let seen = std::cell::RefCell::new(vec![]);
    let watch = |done: f32| {
        seen.borrow_mut().push(done);
        true
    };
    decode_bytes(&wav_f32(&[0.5; 50_000], 44_100), "test.wav", &watch).unwrap();
    let seen = seen.into_inner();
    assert!(seen.len() > 3 && seen.is_sorted() && seen.last() == Some(&1.0), "{seen:?}");
}

#[test]
fn embedding_has_a_limit() {
    assert_eq!(embed(&vec![0; MAX_EMBEDDED_BYTES]).and_then(|text| unembed(&text)).unwrap().len(), MAX_EMBEDDED_BYTES);
    let error = embed(&vec![0; MAX_EMBEDDED_BYTES + 1]).unwrap_err();
    assert_eq!(error, Error::EmbedTooLarge { found_bytes: 10_000_001 });
    assert!(matches!(unembed("not base64!"), Err(Error::EmbedDamaged { .. })));
    assert!(matches!(unembed("AAAA"), Err(Error::EmbedDamaged { .. })));
    let whole = embed(&[7; 1000]).unwrap();
    let broken = &whole[..whole.len() / 8 * 4];
    assert!(matches!(unembed(broken), Err(Error::EmbedDamaged { .. })));
}

#[test]
fn failed_writing_leaves_what_was_there() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.wav");
    std::fs::write(&path, b"before").unwrap();
    let unequal = write_wav_f32(&path, &[vec![0.0; 3], vec![0.0; 2]], 44_100);
    assert!(matches!(unequal, Err(Error::UnequalChannels { channel: 1, found: 2, expected: 3, .. })));
    assert!(matches!(write_wav_f32(&path, &[], 44_100), Err(Error::NoChannels { .. })));
    let halfway = write_file(&path, |file| {
        std::io::Write::write_all(file, b"half")?;
        Err(std::io::Error::other("the disk is full"))
    });
    let message = halfway.unwrap_err().to_string();
    assert!(
        message.contains("out.wav") && message.contains("the disk is full") && message.contains("choose"),
        "{message}"
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"before");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "a temporary file was left behind");
    let nowhere = write_wav_f32(&folder.path().join("no/out.wav"), &[vec![0.0]], 44_100);
    assert!(matches!(nowhere, Err(Error::NotWritten { .. })), "{nowhere:?}");
    let onto_folder = write_wav_f32(folder.path(), &[vec![0.0]], 44_100);
    assert!(matches!(onto_folder, Err(Error::NotWritten { .. })), "{onto_folder:?}");
}

#[test]
fn more_than_two_channels_name_their_loudspeakers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("surround.wav");
    for (channels, mask) in
        [(3, 0x7), (4, 0x33), (5, 0x37), (6, 0x3f), (7, 0x637), (8, 0x63f), (9, 0x5637), (10, 0x563f)]
    {
        let sound: Vec<Vec<f32>> = (0..channels).map(|channel| vec![channel as f32 * 0.01; 7]).collect();
        write_wav_f32(&path, &sound, 48_000).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        assert_eq!(&bytes[20..22], &[0xfe, 0xff], "{channels}: the header is the extensible one");
        assert_eq!(u32::from_le_bytes(bytes[40..44].try_into().unwrap()), mask, "{channels} channels");
        assert_eq!(u32::count_ones(mask), channels, "a loudspeaker each");
        assert_eq!(decode(&path, &no_progress).unwrap().channels, sound);
    }
}
