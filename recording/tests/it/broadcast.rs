//! Broadcast Wave files: the chunk's fields where the standard has them, and sound that comes back.

use std::io::Cursor;

use proptest::prelude::*;
use pyrophone_recording::{Broadcast, Error, decode, no_progress, write_broadcast_wav_f32, write_wav_f32};

/// Body of a chunk of a RIFF file, its chunks walked from the first.
fn chunk<'a>(file: &'a [u8], id: &[u8; 4]) -> &'a [u8] {
    assert_eq!((&file[..4], &file[8..12]), (&b"RIFF"[..], &b"WAVE"[..]));
    assert_eq!(u32::from_le_bytes(file[4..8].try_into().unwrap()) as usize, file.len() - 8);
    let mut at = 12;
    loop {
        let size = u32::from_le_bytes(file[at + 4..at + 8].try_into().unwrap()) as usize;
        let body = &file[at + 8..at + 8 + size];
        if &file[at..at + 4] == id {
            return body;
        }
        assert_eq!(size % 2, 0);
        at += 8 + size;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn sound_and_place_come_back(
        channels in 1usize..=8,
        frames in proptest::collection::vec(
            proptest::array::uniform8(any::<f32>().prop_filter("finite", |sample| sample.is_finite())), 1..500),
        rate_hz in 1_000u32..=768_000,
        time_reference_samples in any::<u64>(),
        description in ".{0,300}",
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("whole.wav");
        let sound: Vec<Vec<f32>> =
            (0..channels).map(|channel| frames.iter().map(|frame| frame[channel]).collect()).collect();
        let broadcast = Broadcast { description: description.clone(), time_reference_samples, ..Broadcast::default() };
        write_broadcast_wav_f32(&path, &sound, rate_hz, &broadcast).unwrap();
        let back = decode(&path, &no_progress).unwrap();
        prop_assert_eq!(back.sample_rate_hz, rate_hz);
        let bits = |sound: &[Vec<f32>]| -> Vec<Vec<u32>> {
            sound.iter().map(|samples| samples.iter().map(|sample| sample.to_bits()).collect()).collect()
        };
        prop_assert_eq!(bits(&back.channels), bits(&sound));
        let file = std::fs::read(&path).unwrap();
        let bext = chunk(&file, b"bext");
        prop_assert_eq!(bext.len(), 602);
        let low = u32::from_le_bytes(bext[338..342].try_into().unwrap());
        let high = u32::from_le_bytes(bext[342..346].try_into().unwrap());
        prop_assert_eq!(u64::from(low) | u64::from(high) << 32, time_reference_samples);
        let ascii: Vec<u8> = description.bytes().filter(|byte| (0x20..0x7f).contains(byte)).take(256).collect();
        prop_assert!(bext.starts_with(&ascii) && bext[ascii.len()..256].iter().all(|byte| *byte == 0));
        let told = Broadcast::of_file(&path).unwrap();
        prop_assert_eq!(told.time_reference_samples, time_reference_samples);
        prop_assert_eq!(told.description.as_bytes(), ascii.trim_ascii());
    }
}

#[test]
fn fields_stand_where_the_standard_has_them() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let broadcast = Broadcast {
        description: "A flame".into(),
        date: Some("2011-07-25".into()),
        time: Some("12:34:56".into()),
        time_reference_samples: 5,
        ixml: None,
    };
    write_broadcast_wav_f32(&path, &[vec![0.25, -0.5], vec![1.0, 2.0]], 48_000, &broadcast).unwrap();
    let file = std::fs::read(&path).unwrap();
    let bext = chunk(&file, b"bext");
    assert_eq!((&bext[256..266], &bext[320..338]), (&b"Pyrophone\0"[..], &b"2011-07-2512:34:56"[..]));
    assert_eq!(bext[346..348], 1u16.to_le_bytes());
    assert!(bext[348..].iter().all(|byte| *byte == 0));
    assert_eq!(chunk(&file, b"fact"), 2u32.to_le_bytes());
    assert_eq!(chunk(&file, b"fmt ")[..2], 3u16.to_le_bytes());
    let data: Vec<u8> = [0.25f32, 1.0, -0.5, 2.0].iter().flat_map(|sample| sample.to_le_bytes()).collect();
    assert_eq!(chunk(&file, b"data"), data);
    // The same file whenever it is made.
    let again = folder.path().join("b.wav");
    write_broadcast_wav_f32(&again, &[vec![0.25, -0.5], vec![1.0, 2.0]], 48_000, &broadcast).unwrap();
    assert_eq!(std::fs::read(&again).unwrap(), file);
}

#[test]
fn missing_and_unequal_channels_are_not_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let write = |channels: &[Vec<f32>]| write_broadcast_wav_f32(&path, channels, 48_000, &Broadcast::default());
    assert!(matches!(write(&[]), Err(Error::NoChannels { .. })));
    assert!(matches!(write(&[vec![0.0], vec![]]), Err(Error::UnequalChannels { .. })));
    assert!(!path.exists());
}

#[test]
fn broadcast_is_read_back_whole_and_from_behind_the_sound() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    let broadcast = Broadcast {
        description: "A flame".into(),
        date: Some("2011-07-25".into()),
        time: Some("12:34:56".into()),
        time_reference_samples: 1 << 40,
        ixml: None,
    };
    write_broadcast_wav_f32(&path, &[vec![0.25; 3]], 48_000, &broadcast).unwrap();
    assert_eq!(Broadcast::of_file(&path), Some(broadcast.clone()));
    let file = std::fs::read(&path).unwrap();
    let bext_at = file.windows(4).position(|id| id == b"bext").unwrap();
    let (bext, data) = (&file[bext_at..bext_at + 610], &file[bext_at + 610..]);
    let behind = [&file[..bext_at], data, bext].concat();
    assert_eq!(Broadcast::read(&mut Cursor::new(&behind)), Some(broadcast.clone()));
    // A 64-bit file says in its first chunk how long the sound is.
    let mut long = [&b"RF64\xff\xff\xff\xffWAVEds64"[..], &16u32.to_le_bytes(), &0u64.to_le_bytes()].concat();
    long.extend(12u64.to_le_bytes());
    long.extend([b"data", &[0xff; 4][..], &[0; 12], bext].concat());
    assert_eq!(Broadcast::read(&mut Cursor::new(&long)), Some(broadcast));
}

#[test]
fn files_without_a_place_tell_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    write_wav_f32(&path, &[vec![0.25; 3]], 48_000).unwrap();
    assert_eq!(Broadcast::of_file(&path), None);
    assert_eq!(Broadcast::of_file(&folder.path().join("none.wav")), None);
    write_broadcast_wav_f32(&path, &[vec![0.25; 3]], 48_000, &Broadcast::default()).unwrap();
    let file = std::fs::read(&path).unwrap();
    let bext_at = file.windows(4).position(|id| id == b"bext").unwrap();
    for length in 0..bext_at + 8 + 346 {
        assert_eq!(Broadcast::read(&mut Cursor::new(&file[..length])), None, "cut off after {length} bytes");
    }
    // A chunk of the size 0, over and over, comes to an end.
    let endless = [&b"RIFF\0\0\0\0WAVE"[..], &[0; 1 << 20]].concat();
    assert_eq!(Broadcast::read(&mut Cursor::new(&endless)), None);
}

#[test]
fn more_than_two_channels_keep_their_loudspeakers() {
    let folder = tempfile::tempdir().unwrap();
    let [plain, broadcast] = ["a.wav", "b.wav"].map(|name| folder.path().join(name));
    for channels in 3..=10 {
        let sound = vec![vec![0.25; 3]; channels];
        write_wav_f32(&plain, &sound, 48_000).unwrap();
        write_broadcast_wav_f32(&broadcast, &sound, 48_000, &Broadcast::default()).unwrap();
        let [plain, broadcast] = [&plain, &broadcast].map(|path| std::fs::read(path).unwrap());
        assert_eq!(chunk(&broadcast, b"fmt "), chunk(&plain, b"fmt "), "{channels} channels");
    }
}

#[test]
fn ixml_is_read_back_beside_the_time_stamp() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.wav");
    for text in ["<BWFXML/>", "<BWFXML></BWFXML>"] {
        let broadcast = Broadcast { time_reference_samples: 7, ixml: Some(text.into()), ..Broadcast::default() };
        write_broadcast_wav_f32(&path, &[vec![0.5; 9]], 48_000, &broadcast).unwrap();
        let read = Broadcast::of_file(&path).unwrap();
        assert_eq!((read.time_reference_samples, read.ixml.as_deref().map(str::trim_end)), (7, Some(text)));
        let file = std::fs::read(&path).unwrap();
        assert_eq!(file.len(), 8 + u32::from_le_bytes(file[4..8].try_into().unwrap()) as usize);
        let sound = pyrophone_recording::decode(&path, &pyrophone_recording::no_progress).unwrap();
        assert_eq!(sound.channels, [vec![0.5; 9]]);
    }
}
