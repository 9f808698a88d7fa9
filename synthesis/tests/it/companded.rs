//! Companded matching: level, spectrum, loudness, automation, silence, and what stands in without a recording.

use std::sync::Arc;

use crate::effect::{Event, channels, play};
use pyrophone_synthesis::chain::{Chain, Channels, learn};
use pyrophone_synthesis::companding::bands::{Power, distance_db};
use pyrophone_synthesis::controls::{Controls, DynamicRange, MixControls};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;
use pyrophone_synthesis::{EngineConfig, Error};

const RATE_HZ: f64 = 44_100.0;
const MONO: Channels = Channels { input: 1, sidechain: 0, output: 1 };
const COMPANDED: EngineConfig = EngineConfig {
    levels: 6,
    window: 4,
    feature: 3,
    falloff: 0.025,
    half_width: 500,
    fit_width_hz: 30.0,
    dynamics: MatchingMode::Companded,
};

fn texture_alone() -> Controls {
    let mut controls =
        Controls { mix: MixControls { low: 0.0, extension: 0.0, ..MixControls::default() }, ..Controls::default() };
    controls.drive.high_pass_hz = 5.0;
    controls.texture.scaling_alpha = 0.0;
    controls
}

fn chain_with(recording: &[f64]) -> Chain {
    let shape = PyramidConfig::at_rate(&COMPANDED, RATE_HZ);
    let recording = [recording.to_vec()];
    let dictionary = RecordingDictionary::companded(&recording, RATE_HZ, &shape, &|_| true).unwrap();
    let mut chain = Chain::new(RATE_HZ, MONO, &COMPANDED).unwrap();
    chain.swap_dictionary(Some(Arc::new(dictionary)));
    chain
}

/// What comes of `drive`, the latency cut off.
fn run(chain: &mut Chain, drive: &[f32], controls: &Controls) -> Vec<f64> {
    let mut input = drive.to_vec();
    input.resize(drive.len() + chain.latency_samples(), 0.0);
    let first = Event { at: 0, controls: *controls, jump: None };
    let out = play(chain, &[input], &[], 1, &[first], 0, || 512);
    out[0][chain.latency_samples()..].iter().map(|x| f64::from(*x)).collect()
}

fn rms_db(signal: &[f64]) -> f64 {
    10.0 * (signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64).max(1e-30).log10()
}

/// A drive and a recording that are made up.
fn made_up() -> (Vec<f32>, Vec<f64>) {
    let recording = channels(21, 1, 200_000).remove(0).iter().map(|x| 0.3 * f64::from(*x)).collect();
    let swell = |i: usize| (1.0 + (i as f32 / 9000.0).sin()) * 0.2;
    let drive = channels(22, 1, 150_000).remove(0).iter().enumerate().map(|(i, x)| swell(i) * x).collect();
    (drive, recording)
}

#[test]
fn on_the_reference_pairs_it_is_like_the_recording() {
    let Some(folder) = crate::common::reference_dir() else { return };
    let read = |kind: &str, name: &str| -> Vec<f64> {
        let reader = hound::WavReader::open(folder.join(kind).join(format!("{name}.wav"))).unwrap();
        reader.into_samples::<f32>().map(|x| f64::from(x.unwrap())).collect()
    };
    for name in ["burning_brick", "dragon", "torch"] {
        let (drive, recording) = (read("signals", name), read("training", name));
        let drive: Vec<f32> = drive.iter().map(|x| *x as f32).collect();
        let out = run(&mut chain_with(&recording), &drive, &texture_alone());
        let levels = |signal: &[f64]| Power::of_signal(signal, RATE_HZ).third_octaves_db(RATE_HZ);
        let spectrum_db = distance_db(&levels(&out), &levels(&recording));
        let level_db = rms_db(&out) - rms_db(&recording);
        println!("{name}: spectrum {spectrum_db:.2} dB, level {level_db:+.2} dB");
        // Pauses of the drive count in the level of what comes of it.
        assert!(spectrum_db < 2.0 && level_db.abs() < 4.0, "{name}: {spectrum_db} dB, level {level_db} dB");
    }
}

#[test]
fn a_learned_drive_gives_the_recordings_level_however_loud_it_is() {
    let (drive, recording) = made_up();
    let mut controls = texture_alone();
    controls.texture.dynamic_range = DynamicRange::Learned;
    controls.texture.gate = 1e-6;
    let mut outputs = Vec::new();
    for gain in [0.01f32, 1.0, 100.0] {
        let drive: Vec<f32> = drive.iter().map(|x| gain * x).collect();
        let mut chain = chain_with(&recording);
        let learned = learn(RATE_HZ, &COMPANDED, &controls, std::slice::from_ref(&drive), &[]).unwrap();
        chain.swap_distribution(Some(Arc::new(learned)));
        let out = run(&mut chain, &drive, &controls);
        let level_db = rms_db(&out) - rms_db(&recording);
        assert!(level_db.abs() < 3.0, "gain {gain}: {level_db} dB from the recording's level");
        outputs.push(rms_db(&out));
    }
    assert!((outputs[0] - outputs[2]).abs() < 0.5, "{outputs:?}");
}

#[test]
fn nothing_is_learned_from_next_to_nothing() {
    let learn = |samples| learn(RATE_HZ, &COMPANDED, &texture_alone(), &[vec![0.1; samples]], &[]);
    assert!(matches!(learn(31), Err(Error::TooShort { found: 31, least: 32, .. })));
    assert!(learn(32).is_ok());
}

#[test]
fn dynamics_follow_the_drive_as_far_as_asked() {
    let recording = made_up().1;
    // 20 dB up and down, a second each.
    let noise = channels(23, 1, 6 * 44_100).remove(0);
    let drive: Vec<f32> =
        noise.iter().enumerate().map(|(i, x)| if i / 44_100 % 2 == 0 { 0.3 * x } else { 0.03 * x }).collect();
    let step_db = |dynamics: f64| {
        let mut controls = texture_alone();
        controls.texture.companding.dynamics = dynamics;
        controls.texture.companding.low_end_hz = 0.0;
        let out = run(&mut chain_with(&recording), &drive, &controls);
        let level = |second: usize| rms_db(&out[second * 44_100 + 11_025..(second + 1) * 44_100 - 4410]);
        level(4) - level(5)
    };
    let steps = [0.0, 0.5, 1.0].map(step_db);
    assert!(steps[0] < 10.0 && steps[0] < steps[1] && steps[1] < steps[2], "{steps:?}");
    assert!((16.0..27.0).contains(&steps[2]), "{steps:?}");
}

#[test]
fn silence_is_silent_before_and_after() {
    let (mut drive, recording) = made_up();
    drive[..30_000].fill(0.0);
    drive[60_000..].fill(0.0);
    let mut chain = chain_with(&recording);
    let out = run(&mut chain, &drive, &texture_alone());
    let latency = chain.latency_samples();
    // Loudness looks ahead by no more than the latency.
    assert!(out[..30_000 - latency].iter().all(|x| *x == 0.0));
    assert!(out[30_000..60_000].iter().any(|x| x.abs() > 1e-3));
    let over = 60_000 + chain.tail_samples().unwrap() - latency;
    let after = out[over..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
    assert!(over < 120_000 && after < 1e-5, "{after} after {over}");
    // The high-pass of the drive, 5 Hz, rings on far below that.
    let last = out.iter().rposition(|x| *x != 0.0).unwrap();
    assert!(last < 130_000, "heard until {last}");
}

#[test]
fn two_starts_in_one_silence_agree() {
    let (mut drive, recording) = made_up();
    drive.truncate(60_000);
    drive[..30_000].fill(0.0);
    let mut chain = chain_with(&recording);
    let first = Event { at: 0, controls: texture_alone(), jump: None };
    let mut from = |position: usize| {
        chain.reset();
        let out = play(&mut chain, &[drive[position..].to_vec()], &[], 1, &[first], position as i64, || 512);
        out[0][30_000 - position..].to_vec()
    };
    let expected = from(0);
    assert!(expected.iter().any(|x| *x != 0.0));
    for position in [1, 17, 500, 20_001] {
        assert!(from(position) == expected, "from {position}");
    }
}

#[test]
fn without_a_recording_extension_stands_in() {
    let drive = made_up().0;
    let mut without = Chain::new(RATE_HZ, MONO, &COMPANDED).unwrap();
    let stands_in = run(&mut without, &drive, &texture_alone());
    let mut extension = Controls { mix: MixControls { texture: 0.0, ..MixControls::default() }, ..texture_alone() };
    extension.drive.high_pass_hz = 5.0;
    let expected = run(&mut Chain::new(RATE_HZ, MONO, &COMPANDED).unwrap(), &drive, &extension);
    // 12 dB softer.
    let largest = stands_in.iter().zip(&expected).map(|(a, b)| (a - 0.25 * b).abs()).fold(0.0, f64::max);
    assert!(largest < 1e-6, "{largest}");
    assert!(without.take_meters().no_recording);
}

#[test]
fn latency_is_the_papers() {
    for rate_hz in [44_100.0, 48_000.0, 96_000.0] {
        let latency =
            |dynamics| Chain::new(rate_hz, MONO, &EngineConfig { dynamics, ..COMPANDED }).unwrap().latency_samples();
        assert_eq!(latency(MatchingMode::Companded), latency(MatchingMode::Paper));
    }
}
