//! Odd but valid sound files: read whole, or refused for the true reason.

use crate::files::{
    FLAC_44100, FLAC_48000, FLOAT, INTEGER, aiff, aiff_chunk, aiff_common, aiff_sound, flac_frames, flac_header, id3v2,
    mp3_frames, mp3_info, ogg_flac, ogg_page, wav, wav_64, wav_f32, wav_format, wave64,
};
use pyrophone_recording::{Error, Note, Recording, decode_bytes, no_progress};

#[track_caller]
fn read(file: &[u8]) -> Recording {
    decode_bytes(file, "odd", &no_progress).unwrap_or_else(|error| panic!("{error}"))
}

/// The samples of a file of one channel that nothing is to be said of.
#[track_caller]
fn quietly(file: &[u8]) -> Vec<f32> {
    let mut recording = read(file);
    assert_eq!((recording.channels.len(), &recording.notes), (1, &vec![]));
    recording.channels.remove(0)
}

#[track_caller]
fn refusal(file: &[u8], says: &[&str]) -> Error {
    let read = decode_bytes(file, "odd", &no_progress).map(|recording| recording.len_samples());
    let error = read.expect_err("it was taken");
    for part in says {
        assert!(error.to_string().contains(part), "'{part}' is missing from: {error}");
    }
    error
}

const SAMPLES: [f32; 3] = [0.5, -0.25, 0.125];

fn sixteen_bits() -> Vec<u8> {
    SAMPLES.iter().flat_map(|sample| ((sample * 32768.0) as i16).to_le_bytes()).collect()
}

/// 16-bit WAV with other bytes between its header and its format.
fn wav_behind(bytes: &[u8]) -> Vec<u8> {
    let plain = wav(&wav_format(INTEGER, 1, 44_100, 16), &sixteen_bits());
    [&plain[..12], bytes, &plain[12..]].concat()
}

#[test]
fn wav_format_chunks_of_any_length_are_read() {
    for more in [0, 2, 4, 6, 100] {
        let format = [wav_format(INTEGER, 1, 44_100, 16), vec![0; more]].concat();
        assert_eq!(quietly(&wav(&format, &sixteen_bits())), SAMPLES, "{more} bytes more");
    }
}

#[test]
fn wav_metadata_of_any_kind_leaves_the_sound_whole() {
    for odd in [
        &b"LIST\x19\0\0\0INFOISFT\x0d\0\0\0Lavf58.76.100\0"[..],
        b"LIST\x19\0\0\0INFOISFT\x0d\0\0\0Lavf58.76.100",
        b"LIST\x10\0\0\0INFOISFT\xff\xff\xff\x7fabcd",
        b"LIST\xff\xff\0\0INFO",
        b"LIST\x02\0\0\0INFO\x01\x02",
        b"bext\xff\xff\xff\xff",
        b"id3 \x05\0\0\0ID3\x03\0\0",
    ] {
        assert_eq!(quietly(&wav_behind(odd)), SAMPLES, "{odd:?}");
    }
}

#[test]
fn a_length_that_is_left_open_lasts_to_the_end_and_is_said() {
    for (outer, size) in [(u32::MAX, u32::MAX), (0, 0), (0x7fff_ffff, 0x7fff_ff00), (u32::MAX, 0)] {
        let mut file = wav_f32(&SAMPLES, 48_000);
        file[4..8].copy_from_slice(&outer.to_le_bytes());
        file[40..44].copy_from_slice(&size.to_le_bytes());
        let recording = read(&file);
        assert_eq!(recording.channels, [SAMPLES], "{size:#x}");
        assert!(matches!(recording.notes[..], [Note::UnknownLength { .. }]), "{:?}", recording.notes);
    }
}

#[test]
fn bits_in_wider_samples_are_read_from_either_end() {
    let mut format = wav_format(INTEGER, 1, 44_100, 24);
    format[12] = 4;
    for scale in [8_388_608.0, 2_147_483_648.0f32] {
        let sound: Vec<u8> = SAMPLES.iter().flat_map(|sample| ((sample * scale) as i32).to_le_bytes()).collect();
        assert_eq!(quietly(&wav(&format, &sound)), SAMPLES, "full scale at {scale}");
    }
    let mut format = wav_format(INTEGER, 1, 44_100, 12);
    format[12] = 2;
    assert_eq!(quietly(&wav(&format, &sixteen_bits())), SAMPLES, "12 bits in the upper ones of 2 bytes");
}

#[test]
fn files_with_64_bit_sizes_are_read() {
    let sound: Vec<u8> = SAMPLES.iter().flat_map(|sample| sample.to_le_bytes()).collect();
    let format = wav_format(FLOAT, 1, 44_100, 32);
    for mark in [b"RF64", b"BW64"] {
        assert_eq!(quietly(&wav_64(mark, &format, &sound)), SAMPLES);
    }
    assert_eq!(quietly(&wave64(&format, &sound)), SAMPLES);
    let cut = wave64(&format, &sound);
    refusal(&cut[..cut.len() - 8], &["truncated", "8 of 12 bytes of sound"]);
    let mut longer = wav_64(b"RF64", &format, &sound);
    longer[28..36].copy_from_slice(&4000u64.to_le_bytes());
    refusal(&longer, &["truncated", "12 of 4000 bytes of sound"]);
}

#[test]
fn aiff_chunks_stand_in_any_order() {
    let sound: Vec<u8> = SAMPLES.iter().flat_map(|sample| ((sample * 32768.0) as i16).to_be_bytes()).collect();
    let common = || aiff_common(3, 16, b"");
    let marker = || aiff_chunk(b"MARK", b"\0\x01abcdefg");
    for chunks in [
        vec![common(), aiff_sound(0, &sound), marker()],
        vec![marker(), aiff_sound(0, &sound), common()],
        vec![common(), marker(), aiff_sound(16, &sound)],
        vec![common(), aiff_sound(512, &[&sound[..], &[0x55; 506]].concat())],
        vec![common(), b"ANNO\0\0\xff\xffcut short".to_vec(), aiff_sound(0, &sound)],
    ] {
        assert_eq!(quietly(&aiff(b"AIFF", &chunks)), SAMPLES);
    }
    let short = aiff(b"AIFF", &[aiff_common(4, 16, b""), aiff_sound(0, &sound)]);
    refusal(&short, &["truncated", "6 of 8 bytes of sound"]);
    let uncounted = read(&aiff(b"AIFF", &[aiff_common(0, 16, b""), aiff_sound(0, &sound)]));
    assert_eq!(uncounted.channels, [SAMPLES]);
    assert!(matches!(uncounted.notes[..], [Note::UnknownLength { .. }]));
}

#[test]
fn aiff_c_codings_have_their_own_size_whatever_depth_is_declared() {
    let sixteen =
        |bytes: fn(i16) -> [u8; 2]| SAMPLES.iter().flat_map(|s| bytes((s * 32768.0) as i16)).collect::<Vec<u8>>();
    let single: Vec<u8> = SAMPLES.iter().flat_map(|sample| sample.to_be_bytes()).collect();
    let double: Vec<u8> = SAMPLES.iter().flat_map(|sample| f64::from(*sample).to_be_bytes()).collect();
    let codings: [(&[u8; 4], &[u16], Vec<u8>); 7] = [
        (b"NONE", &[16], sixteen(i16::to_be_bytes)),
        (b"twos", &[16], sixteen(i16::to_be_bytes)),
        (b"sowt", &[16], sixteen(i16::to_le_bytes)),
        (b"fl32", &[0, 16, 32], single.clone()),
        (b"FL32", &[16, 32], single),
        (b"fl64", &[0, 16, 32, 64], double.clone()),
        (b"FL64", &[64], double),
    ];
    for (coding, depths, sound) in codings {
        for bits in depths {
            let file = aiff(b"AIFC", &[aiff_common(3, *bits, coding), aiff_sound(0, &sound)]);
            assert_eq!(quietly(&file), SAMPLES, "{} of {bits} bits", String::from_utf8_lossy(coding));
        }
    }
    for (coding, codes, expected) in [
        (b"ulaw", [0x80, 0xff, 0x00], [8031.0 / 8192.0, 0.0, -8031.0 / 8192.0]),
        (b"ULAW", [0x80, 0xff, 0x00], [8031.0 / 8192.0, 0.0, -8031.0 / 8192.0]),
        (b"alaw", [0xaa, 0xd5, 0x2a], [4032.0 / 4096.0, 1.0 / 4096.0, -4032.0 / 4096.0f32]),
    ] {
        for bits in [8, 16] {
            let file = aiff(b"AIFC", &[aiff_common(3, bits, coding), aiff_sound(0, &codes)]);
            assert_eq!(quietly(&file), expected, "{bits} bits");
        }
    }
    refusal(&aiff(b"AIFC", &[aiff_common(3, 16, b"ima4"), aiff_sound(0, &[0; 34])]), &["ADPCM", "convert"]);
}

/// Samples of silent MP3, and what is said of it.
#[track_caller]
fn mp3(parts: &[Vec<u8>]) -> (usize, Vec<Note>) {
    let recording = read(&parts.concat());
    let notes = recording.notes.iter().filter(|note| **note != Note::Silent).cloned().collect();
    (recording.len_samples(), notes)
}

#[test]
fn an_mp3_header_never_ends_the_sound() {
    let samples = 1152 * 20;
    assert_eq!(mp3(&[mp3_frames(20)]), (samples, vec![]));
    // 529 samples are the decoder's own.
    assert_eq!(mp3(&[mp3_info(20, 576, 1000), mp3_frames(20)]), (samples - 576 - 1000, vec![]));
    assert_eq!(mp3(&[mp3_info(21, 576, 1000), mp3_frames(20)]), (samples - 576 - 1000, vec![]));
    for declared in [0, 1, 19, 400] {
        let (found, notes) = mp3(&[mp3_info(declared, 0, 0), mp3_frames(20)]);
        assert_eq!(found, samples - 529);
        let differs = Note::CountDiffers { declared: declared.into(), found: 20, unit: "frames" };
        assert_eq!(notes, [differs]);
    }
}

#[test]
fn joined_mp3s_are_read_whole() {
    let one = || [mp3_info(20, 576, 1000), mp3_frames(20)].concat();
    let length = 1152 * 20 - 576 - 1000;
    assert_eq!(mp3(&[one(), one()]), (2 * length, vec![]));
    let tag = || id3v2(0, b"TIT2\0\0\0\x02\0\0\0x");
    assert_eq!(mp3(&[tag(), one(), tag(), one(), tag(), one()]), (3 * length, vec![]));
}

#[test]
fn mp3_tags_are_passed_over_by_their_size() {
    let mut tags = vec![
        id3v2(0, b"TIT2\0\0\x13\x88\0\0\0abc"),
        id3v2(0x40, b"\xff\xff\xff\xffTIT2\0\0\0\x02\0\0\0x"),
        id3v2(0, &[0xff, 0xfb, 0x94, 0xc4].repeat(200)),
        id3v2(0, b""),
        [id3v2(0, b"abc"), id3v2(0, b"def")].concat(),
    ];
    tags.push(b"ID3\x03\0\0\x7f\x7f\x7f\x7f".to_vec());
    for tag in tags {
        assert_eq!(mp3(&[tag.clone(), mp3_frames(20)]).0, 1152 * 20, "{tag:?}");
    }
    let id3v1 = || [&b"TAG"[..], &[b' '; 125]].concat();
    assert_eq!(mp3(&[mp3_frames(20), id3v1()]), (1152 * 20, vec![]));
}

#[test]
fn bytes_between_mp3_frames_are_said() {
    let (samples, notes) = mp3(&[mp3_frames(20), b"these are no frames".to_vec(), mp3_frames(20)]);
    assert_eq!((samples, notes), (1152 * 40, vec![Note::Skipped { bytes: 19 }]));
    let (samples, notes) = mp3(&[mp3_frames(20), mp3_frames(1)[..100].to_vec()]);
    assert_eq!((samples, notes), (1152 * 20, vec![Note::BreaksOff { what: "frame" }]));
}

#[test]
fn a_rate_that_changes_in_mid_stream_is_refused_for_that() {
    // 44.1 kHz in the header's rate bits, and frames as long as that makes them.
    let mut frame = vec![0xff, 0xfb, 0x90, 0xc4];
    frame.resize(417, 0);
    let file = [mp3_frames(20), frame.repeat(20)].concat();
    let error = refusal(&file, &["sample rate", "48000", "44100", "0.480 s", "split"]);
    assert!(matches!(error, Error::Changes { from: 48_000, to: 44_100, .. }));

    let block = |n: i16| vec![n; 4096];
    let (first, second) = (flac_frames(&block(7), 0, FLAC_44100), flac_frames(&block(8), 1, FLAC_48000));
    for declared in [0, 4096, 8192] {
        let file = [flac_header(declared, &[]), first.clone(), second.clone()].concat();
        refusal(&file, &["sample rate", "44100", "48000", "0.093 s"]);
    }
}

fn ramp(blocks: usize) -> (Vec<i16>, Vec<f32>) {
    let samples: Vec<i16> = (0..4096 * blocks).map(|n| (n * 37 % 20_000) as i16 - 10_000).collect();
    let expected = samples.iter().map(|sample| f32::from(*sample) / 32768.0).collect();
    (samples, expected)
}

#[test]
fn flac_metadata_of_any_kind_leaves_the_sound_whole() {
    let (samples, expected) = ramp(3);
    let frames = flac_frames(&samples, 0, FLAC_44100);
    let cue = [0u8; 480];
    for blocks in [
        &[][..],
        &[(5, 480, &cue[..])],
        &[(4, 4, b"\xff\xff\xff\xff")],
        &[(4, 2, b"longer than it says")],
        &[(6, 0xff_ffff, b"shorter than it says")],
        &[(3, 0, b""), (3, 0, b"")],
        &[(126, 3, b"abc"), (1, 0, b"")],
    ] {
        let file = [flac_header(samples.len() as u64, blocks), frames.clone()].concat();
        assert_eq!(quietly(&file), expected, "{blocks:?}");
    }
}

#[test]
fn flac_is_read_between_tags() {
    let (samples, expected) = ramp(3);
    let stream = crate::files::flac_16(&samples);
    let id3v1 = [&b"TAG"[..], &[0; 125]].concat();
    let ape = [&b"APETAGEX\xd0\x07\0\0\x20\0\0\0\0\0\0\0\0\0\0\0"[..], &[0; 8]].concat();
    let unknown = [flac_header(0, &[]), flac_frames(&samples, 0, FLAC_44100)].concat();
    for file in [
        [id3v2(0, b"whatever"), stream.clone()].concat(),
        [stream.clone(), id3v1.clone()].concat(),
        [stream.clone(), ape, id3v1.clone()].concat(),
        [stream, vec![0; 1000]].concat(),
        [unknown, id3v1].concat(),
    ] {
        assert_eq!(quietly(&file), expected);
    }
}

#[test]
fn flac_is_never_shorter_than_it_says_nor_longer_in_silence() {
    let (samples, expected) = ramp(3);
    let frames = flac_frames(&samples, 0, FLAC_44100);
    let with = |declared, frames: &[u8]| [&flac_header(declared, &[])[..], frames].concat();
    refusal(&with(4096 * 4, &frames), &["truncated", "12288 of 16384 samples"]);
    let longer = read(&with(4096, &frames));
    assert_eq!(longer.channels[0], expected);
    assert_eq!(longer.notes, [Note::CountDiffers { declared: 4096, found: 12_288, unit: "samples" }]);
    let cut = read(&with(0, &frames[..frames.len() - 500]));
    assert_eq!(cut.channels, [&expected[..8192]]);
    assert_eq!(cut.notes, [Note::BreaksOff { what: "frame" }]);
    let mut damaged = frames.clone();
    damaged[9_000] ^= 1;
    refusal(&with(4096 * 3, &damaged), &["damaged", "frame of sound at byte"]);
    let third = frames.len() / 3;
    let hole = [&frames[..third], b"lost frames", &frames[2 * third..]].concat();
    refusal(&with(0, &hole), &["damaged", "missing"]);
    let joined = [with(4096 * 3, &frames), with(4096 * 3, &frames)].concat();
    assert_eq!(quietly(&joined), [expected.clone(), expected].concat());
}

#[test]
fn ogg_loses_nothing_in_silence() {
    let (samples, expected) = ramp(3);
    let file = ogg_flac(&samples, 1, true);
    assert_eq!(quietly(&file), expected);
    assert_eq!(quietly(&[file.clone(), ogg_flac(&samples, 2, true)].concat()), [&expected[..], &expected].concat());
    let open = read(&ogg_flac(&samples, 1, false));
    assert_eq!((open.channels, open.notes), (vec![expected.clone()], vec![Note::BreaksOff { what: "page" }]));
    let cut = read(&file[..file.len() - 100]);
    assert_eq!((cut.channels, cut.notes), (vec![expected[..8192].to_vec()], vec![Note::BreaksOff { what: "page" }]));
    let page = file.windows(4).enumerate().filter(|(_, mark)| mark == b"OggS").map(|(at, _)| at).collect::<Vec<_>>();
    let hole = [&file[..page[3]], &file[page[4]..]].concat();
    refusal(&hole, &["damaged", "page 4 follows where page 3 is expected"]);
    let mut damaged = file.clone();
    damaged[page[3] + 300] ^= 1;
    refusal(&damaged, &["damaged", "checksum"]);
}

#[test]
fn codings_that_are_not_read_are_refused_in_plain_words() {
    let opus = ogg_page(2, 0, 1, 0, &[b"OpusHead\x01\x02\x38\x01\x80\xbb\0\0\0\0\0"]);
    refusal(&opus, &["Opus", "convert it to WAV"]);
    refusal(&ogg_page(2, 0, 1, 0, &[b"Speex   1.2"]), &["Speex"]);
    for (tag, name) in [(2, "ADPCM"), (0x11, "ADPCM"), (0x50, "MPEG layer 2"), (0x55, "MP3")] {
        refusal(&wav(&wav_format(tag, 1, 44_100, 4), &[0; 64]), &[name, "convert it to WAV"]);
    }
    refusal(&[&b"\x1aE\xdf\xa3"[..], &[0; 100]].concat(), &["WebM"]);
    refusal(&[0xff, 0xf1, 0x50, 0x80, 0, 0x1f, 0xfc], &["AAC"]);
}

#[test]
fn silence_and_channels_that_cancel_are_said() {
    assert_eq!(read(&wav_f32(&[0.0; 100], 44_100)).notes, [Note::Silent]);
    let of = |right: fn(f32) -> f32| {
        let pairs = (0..1000).map(|n| (n as f32 * 0.1).sin()).flat_map(|left| [left, right(left)]);
        let sound: Vec<u8> = pairs.flat_map(|sample| sample.to_le_bytes()).collect();
        read(&wav(&wav_format(FLOAT, 2, 44_100, 32), &sound)).notes
    };
    assert_eq!(of(|left| -left), [Note::ChannelsCancel]);
    assert_eq!(of(|left| 0.95 * -left), [Note::ChannelsCancel]);
    assert_eq!(of(|left| left), []);
    assert_eq!(of(|_| 0.0), []);
    assert_eq!(of(|left| -0.5 * left), []);
}
