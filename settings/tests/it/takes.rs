//! Takes: the same character, other events; and the same take is the same sound.

use std::sync::Arc;

use pyrophone_settings::Values;
use pyrophone_synthesis::chain::{Chain, Channels, Transport};
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::texture::PyramidConfig;

const RATE_HZ: f64 = 44_100.0;
const SAMPLES: usize = 6 * 44_100;
/// Longest stretch that two takes may share, 0.1 s, where anything is heard.
const LONGEST_SHARED: usize = 4410;

fn noise(seed: u32, corner_hz: f64, samples: usize) -> Vec<f64> {
    let white = White::new(seed, 0);
    let part = 1.0 - (-std::f64::consts::TAU * corner_hz / RATE_HZ).exp();
    let mut pole = 0.0;
    let sample = |n: usize| {
        pole += part * (white.sample_at(n as i64) - pole);
        pole
    };
    (0..samples).map(sample).collect()
}

/// A take of texture alone, which has no noise of its own, at an amount in percent.
fn take(dictionary: &Arc<RecordingDictionary>, number: u32, amount: f64) -> Vec<f32> {
    let mut values = Values::default();
    for (id, text) in [("crackle_level", "off"), ("low_end", "0"), ("ceiling", "off"), ("loudness", "off")] {
        values.set_text(id, text).unwrap();
    }
    values.set_text("take", &number.to_string()).unwrap();
    values.set_text("take_amount", &amount.to_string()).unwrap();
    let channels = Channels { input: 1, sidechain: 0, output: 1 };
    let mut chain = Chain::new(RATE_HZ, channels, &values.structure()).unwrap();
    chain.swap_dictionary(Some(dictionary.clone()));
    let swell = |n: usize| 0.02 * (1.3 + (n as f64 * 5e-5).sin());
    let drive = noise(2, 120.0, SAMPLES);
    let mut output: Vec<f32> = drive.iter().enumerate().map(|(n, x)| (20.0 * swell(n) * x) as f32).collect();
    for (block, samples) in output.chunks_mut(1024).enumerate() {
        let transport = Transport { playing: true, position: Some(1024 * block as i64) };
        chain.process(&mut [samples], &[], &values.controls(), transport);
    }
    output.split_off(44_100)
}

/// The longest stretch in samples in which two sounds differ by less than a thousandth of their level.
fn longest_shared(a: &[f32], b: &[f32]) -> usize {
    let level = (a.iter().map(|x| x * x).sum::<f32>() / a.len() as f32).sqrt();
    assert!(level > 1e-4, "nothing is heard");
    let same: Vec<bool> = a.iter().zip(b).map(|(a, b)| (a - b).abs() < 1e-3 * level).collect();
    same.split(|is_same| !is_same).map(<[bool]>::len).max().unwrap_or(0)
}

fn level_db(sound: &[f32]) -> f64 {
    10.0 * (sound.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / sound.len() as f64).log10()
}

#[test]
fn takes_have_other_events_and_the_same_loudness() {
    let recording: Vec<f64> =
        noise(5, 700.0, SAMPLES).iter().zip(noise(6, 9000.0, SAMPLES)).map(|(a, b)| 0.2 * a + 0.04 * b).collect();
    let shape = PyramidConfig::at_rate(&Values::default().structure(), RATE_HZ);
    let dictionary = Arc::new(RecordingDictionary::companded(&[recording], RATE_HZ, &shape, &|_| true).unwrap());
    let set = take(&dictionary, 0, 50.0);
    assert!(take(&dictionary, 0, 100.0) == set, "take 0 has no amount");
    let takes = [7, 8, 9].map(|number| take(&dictionary, number, 50.0));
    assert!(take(&dictionary, 7, 50.0) == takes[0], "a take is the same whenever it is played");
    for (a, b) in [(&set, &takes[0]), (&takes[0], &takes[1]), (&takes[1], &takes[2]), (&takes[0], &takes[2])] {
        let shared = longest_shared(a, b);
        println!("shared {shared} samples, levels {:.2} and {:.2} dB", level_db(a), level_db(b));
        assert!(shared < LONGEST_SHARED, "{shared} samples are the same");
        assert!((level_db(a) - level_db(b)).abs() < 1.5);
    }
    let none = [7, 8].map(|number| take(&dictionary, number, 0.0));
    assert!(none[0] == set && none[1] == set, "at 0 % texture is the recording's nearest");
}
