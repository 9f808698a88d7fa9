//! FLAC out: what is written comes back from the decoder, bit for bit.

use proptest::prelude::*;
use pyrophone_recording::{
    Broadcast, Error, decode, no_progress, round_to_24_bit, samples_hash, write_flac_24, write_wav_f32,
};

/// Sound that an encoder finds easy (silence, a constant), usual (a decaying hum) and impossible (noise at full scale).
fn sound(samples: usize, channels: usize) -> Vec<Vec<f32>> {
    let mut state = 7u64;
    let mut noise = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    };
    let mut sample = |channel: usize, n: usize| match channel % 4 {
        0 => 0.5 * (n as f32 * 0.01).sin() * (-(n as f32) / 3000.0).exp() + 1e-3 * noise(),
        1 => noise(),
        2 => 0.0,
        _ => -1.0,
    };
    (0..channels).map(|channel| (0..samples).map(|n| sample(channel, n)).collect()).collect()
}

#[test]
fn flac_round_trip_is_bit_exact_at_24_bit() {
    let folder = tempfile::tempdir().unwrap();
    for (channels, samples, rate_hz) in
        [(1, 1, 44_100), (1, 4096, 8_000), (2, 20_000, 48_000), (6, 9_001, 96_000), (7, 100, 12_345), (8, 4097, 88_200)]
    {
        let path = folder.path().join(format!("{channels}.flac"));
        let mut sound = sound(samples, channels);
        round_to_24_bit(&mut sound);
        write_flac_24(&path, &sound, rate_hz, None).unwrap();
        let back = decode(&path, &no_progress).unwrap();
        assert_eq!(back.sample_rate_hz, rate_hz);
        assert!(back.channels == sound, "{channels} channels of {samples} samples");
        let wav = folder.path().join("same.wav");
        write_wav_f32(&wav, &sound, rate_hz).unwrap();
        let wav = decode(&wav, &no_progress).unwrap();
        assert_eq!(samples_hash(&wav.channels), samples_hash(&back.channels), "whatever the file");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_sound_within_full_scale_comes_back(
        frames in proptest::collection::vec(proptest::array::uniform2(-1.0f32..=1.0), 1..6000),
        rate_hz in 1_000u32..=96_000,
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.flac");
        let mut sound: Vec<Vec<f32>> = (0..2).map(|channel| frames.iter().map(|frame| frame[channel]).collect()).collect();
        prop_assert_eq!(round_to_24_bit(&mut sound), 0);
        write_flac_24(&path, &sound, rate_hz, None).unwrap();
        prop_assert!(decode(&path, &no_progress).unwrap().channels == sound);
    }
}

#[test]
fn rounding_is_to_the_nearest_and_what_is_too_loud_is_counted() {
    let step = 1.0 / 8_388_608.0;
    let mut sound = vec![vec![0.4 * step, 0.6 * step, -0.6 * step, 1.0, -1.0, 1.5, -7.0]];
    assert_eq!(round_to_24_bit(&mut sound), 2);
    assert_eq!(sound[0], [0.0, step, -step, 1.0 - step, -1.0, 1.0 - step, -1.0]);
}

#[test]
fn the_place_on_the_timeline_comes_back_from_the_comments() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.flac");
    let broadcast = Broadcast {
        description: "A flame".into(),
        date: None,
        time: Some("12:34:56".into()),
        time_reference_samples: u64::MAX,
        ixml: None,
    };
    write_flac_24(&path, &[vec![0.0; 10]], 48_000, Some(&broadcast)).unwrap();
    assert_eq!(Broadcast::of_file(&path), Some(broadcast));
    write_flac_24(&path, &[vec![0.0; 10]], 48_000, None).unwrap();
    assert_eq!(Broadcast::of_file(&path), None);
}

#[test]
fn channels_and_rates_beyond_flac_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.flac");
    for (channels, rate_hz) in [(9, 48_000), (1, 192_000)] {
        let error = write_flac_24(&path, &vec![vec![0.0; 10]; channels], rate_hz, None).unwrap_err();
        assert!(matches!(error, Error::NotForFlac { .. }), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}
