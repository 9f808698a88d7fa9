//! The resampler against closed forms.

use std::f64::consts::TAU;

use pyrophone_recording::{Error, Recording, no_progress, resample};

fn recording(channels: Vec<Vec<f32>>, sample_rate_hz: u32) -> Recording {
    Recording { channels, sample_rate_hz, name: "test.wav".into(), content_hash: "abc".into(), notes: vec![] }
}

fn sine(frequency_hz: f64, rate_hz: u32, samples: usize) -> Vec<f32> {
    (0..samples).map(|n| (0.5 * (TAU * frequency_hz * n as f64 / f64::from(rate_hz) + 0.3).sin()) as f32).collect()
}

/// Largest deviation from the same sine drawn at the new rate, away from the ends, where the sinc
/// runs off the recording.
fn largest_error(frequency_hz: f64, from_hz: u32, to_hz: u32, samples: usize) -> f64 {
    let out = resample(&recording(vec![sine(frequency_hz, from_hz, samples)], from_hz), to_hz, &no_progress).unwrap();
    assert_eq!(out.len_samples(), (samples as f64 * f64::from(to_hz) / f64::from(from_hz)).round() as usize);
    let expected = sine(frequency_hz, to_hz, out.len_samples());
    let margin = 3000.min(out.len_samples() / 3);
    let inner = margin..out.len_samples() - margin;
    out.channels[0][inner.clone()]
        .iter()
        .zip(&expected[inner])
        .map(|(found, expected)| f64::from((found - expected).abs()))
        .fold(0.0, f64::max)
}

#[test]
fn sines_keep_amplitude_and_phase() {
    for (from_hz, to_hz) in [(48_000, 44_100), (44_100, 48_000), (44_100, 96_000), (96_000, 44_100), (44_100, 44_101)] {
        for frequency_hz in [50.0, 1000.0, 15_000.0] {
            let error = largest_error(frequency_hz, from_hz, to_hz, 60_001);
            // At half of full scale two roundings to 32-bit float are 6e-8. Rates without a common factor
            // take a sinc as long as a second, which the ends of the recording reach into.
            let allowed = if to_hz == 44_101 { 1e-4 } else { 6e-8 };
            assert!(error < allowed, "{frequency_hz} Hz, {from_hz} -> {to_hz} Hz: {error:e}");
        }
    }
}

#[test]
fn frequencies_above_the_new_nyquist_are_removed() {
    let out = resample(&recording(vec![sine(30_000.0, 96_000, 96_000)], 96_000), 44_100, &no_progress).unwrap();
    let peak = out.channels[0][5000..39_000].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
    assert!(peak < 1e-7, "an alias of peak {peak:e}");
}

#[test]
fn an_impulse_stays_at_its_time() {
    let mut samples = vec![0.0; 48_000];
    samples[24_000] = 1.0;
    let out = resample(&recording(vec![samples.clone(), samples], 48_000), 96_000, &no_progress).unwrap();
    for channel in &out.channels {
        let loudest = (0..channel.len()).max_by(|a, b| channel[*a].total_cmp(&channel[*b])).unwrap();
        assert_eq!(loudest, 48_000);
        for distance in 1..2000 {
            assert!((channel[48_000 - distance] - channel[48_000 + distance]).abs() < 1e-6);
        }
    }
}

#[test]
fn the_same_rate_changes_nothing() {
    let original = recording(vec![vec![-0.0, 1e-42, 3.5, f32::MIN_POSITIVE]], 44_100);
    let same = resample(&original, 44_100, &no_progress).unwrap();
    let bits = |recording: &Recording| recording.channels[0].iter().map(|s| s.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&same), bits(&original));
}

#[test]
fn short_ones_and_single_samples() {
    for samples in [1, 2, 3, 100, 1024] {
        for (from_hz, to_hz) in [(8_000, 192_000), (192_000, 8_000), (44_100, 48_000)] {
            let out = resample(&recording(vec![vec![0.5; samples]], from_hz), to_hz, &no_progress).unwrap();
            let expected = (samples as f64 * f64::from(to_hz) / f64::from(from_hz)).round().max(1.0) as usize;
            assert_eq!(out.len_samples(), expected, "{samples} samples, {from_hz} -> {to_hz}");
        }
    }
}

#[test]
fn refusals_and_cancelling() {
    let original = recording(vec![vec![0.5; 1000]], 44_100);
    assert!(matches!(resample(&original, 0, &no_progress), Err(Error::SampleRate { found_hz: 0, .. })));
    assert!(matches!(resample(&original, 48_000, &|_| false), Err(Error::Cancelled)));
    assert!(matches!(resample(&recording(vec![], 44_100), 48_000, &no_progress), Err(Error::NoChannels { .. })));
}
