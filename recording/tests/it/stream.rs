//! WAV from a pipe: a length that its writer did not know.

use pyrophone_recording::{Broadcast, Error, decode_bytes, no_progress, settle_length, write_wav_f32_to};

fn wav(channels: &[Vec<f32>]) -> Vec<u8> {
    let mut bytes = vec![];
    write_wav_f32_to(&mut bytes, "-", channels, 48_000, Some(&Broadcast::default())).unwrap();
    bytes
}

fn with_length(mut file: Vec<u8>, length: u32) -> Vec<u8> {
    let at = file.windows(4).position(|id| id == b"data").unwrap() + 4;
    file[at..at + 4].copy_from_slice(&length.to_le_bytes());
    file
}

#[test]
fn wav_of_unknown_length_is_read_to_its_end() {
    let sound = vec![vec![0.25, -0.5, 0.75], vec![1.0, 0.0, -1.0]];
    for length in [0, u32::MAX, u32::MAX - 100, i32::MAX as u32, 0x7fff_f000, 24] {
        for surplus in [0, 3] {
            let mut bytes = with_length(wav(&sound), length);
            bytes.extend(vec![0; surplus]);
            settle_length(&mut bytes);
            let read = decode_bytes(&bytes, "standard input", &no_progress).unwrap();
            assert_eq!(read.channels, sound, "length {length:#x}, {surplus} bytes more");
        }
    }
}

#[test]
fn a_pipe_that_was_cut_off_is_still_found_out() {
    let whole = wav(&[vec![0.5; 100]]);
    let mut cut = whole[..whole.len() - 40].to_vec();
    settle_length(&mut cut);
    assert!(matches!(decode_bytes(&cut, "-", &no_progress), Err(Error::Truncated { .. })));
    for length in 0..whole.len() {
        let mut start = with_length(whole.clone(), u32::MAX)[..length].to_vec();
        settle_length(&mut start);
        let _ = decode_bytes(&start, "-", &no_progress);
    }
}
