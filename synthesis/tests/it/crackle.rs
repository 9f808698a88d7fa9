//! Crackle: the split of a recording, and the layer that plays what was split off.

use std::f64::consts::PI;
use std::sync::Arc;

use crate::effect::{Event, STEREO, channels, play};
use pyrophone_synthesis::chain::{Chain, Channels};
use pyrophone_synthesis::controls::{Controls, CrackleControls, Fuel, MixControls};
use pyrophone_synthesis::crackle::{Crackle, Crackles, Sources, split};
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;
use pyrophone_synthesis::{EngineConfig, Error};

const RATE_HZ: f64 = 44_100.0;
const MONO: Channels = Channels { input: 1, sidechain: 0, output: 1 };
const LATENCY: usize = 2048;
const BLOCK: usize = 500;

fn noise(stream: u32, samples: usize, level: f64) -> Vec<f64> {
    let mut noise = vec![0.0; samples];
    White::new(7, stream).fill(0, &mut noise);
    noise.iter_mut().for_each(|x| *x *= level);
    noise
}

/// Clicks of half a millisecond in noise, every 0.05-0.25 s, 20-40 dB above it; their samples and peaks.
fn clicks(samples: usize) -> (Vec<f64>, Vec<(usize, f64)>) {
    let (mut signal, random) = (noise(1, samples, 0.003), White::new(8, 9));
    let (mut placed, mut at) = (Vec::new(), 3000usize);
    while at + 4000 < samples {
        let count = placed.len() as i64;
        let unit = |draw: i64| 0.5 + random.sample_at(2 * count + draw) / 12f64.sqrt();
        let peak = 0.05 * 10f64.powf(unit(0));
        for (i, sample) in signal[at..at + 200].iter_mut().enumerate() {
            let time_s = i as f64 / RATE_HZ;
            *sample += peak * (2.0 * PI * 5000.0 * time_s).cos() * (-time_s / 0.0005).exp();
        }
        placed.push((at, peak));
        at += ((0.05 + 0.2 * unit(1)) * RATE_HZ) as usize;
    }
    (signal, placed)
}

fn crackles() -> Crackles {
    split(&[clicks(400_000).0], RATE_HZ).crackles.expect("crackles")
}

/// The layer alone over a drive of this loudness, cut into blocks by `next_block`.
fn layer(
    crackles: &Crackles,
    loudness: &[f64],
    controls: &CrackleControls,
    position: i64,
    mut next_block: impl FnMut() -> usize,
) -> Vec<f64> {
    let mut crackle = Crackle::new(RATE_HZ, 1, LATENCY, BLOCK);
    crackle.reset(position);
    let mut out = vec![0.0; loudness.len()];
    let mut start = 0;
    while start < loudness.len() {
        let end = loudness.len().min(start + next_block());
        crackle.process(&loudness[start..end], controls, &Sources::of_recording(crackles), &mut [&mut out[start..end]]);
        start = end;
    }
    out
}

fn power(signal: &[f64]) -> f64 {
    signal.iter().map(|x| x * x).sum()
}

/// Number of times that the level rises out of silence.
fn onsets(signal: &[f64]) -> usize {
    onset_places(signal).len()
}

/// Where the level rises out of silence, in 5 ms.
fn onset_places(signal: &[f64]) -> Vec<usize> {
    let levels: Vec<f64> =
        signal.chunks(220).map(|part| part.iter().fold(0.0f64, |most, x| most.max(x.abs()))).collect();
    let rises = levels.windows(2).enumerate().filter(|(_, pair)| pair[0] < 0.01 && pair[1] > 0.01);
    rises.map(|(place, _)| place).collect()
}

#[test]
fn split_recovers_clicks_in_noise_with_their_times_and_levels() {
    let (signal, placed) = clicks(400_000);
    let parts = split(std::slice::from_ref(&signal), RATE_HZ);
    let found = parts.crackles.expect("crackles");
    let share = found.events().len() as f64 / placed.len() as f64;
    assert!((0.95..1.05).contains(&share), "{} of {} clicks", found.events().len(), placed.len());
    let mut errors_db = Vec::new();
    for event in found.events() {
        let nearest = placed.iter().min_by_key(|(at, _)| at.abs_diff(event.onset + 88)).unwrap();
        assert!(
            nearest.0.abs_diff(event.onset + 88) < 130,
            "{} is {} away",
            event.onset,
            nearest.0.abs_diff(event.onset)
        );
        errors_db.push(20.0 * (event.peak / nearest.1).log10());
        assert!((3500.0..7000.0).contains(&event.centroid_hz) && event.decay_s < 0.004, "{event:?}");
    }
    let mean_db = errors_db.iter().sum::<f64>() / errors_db.len() as f64;
    assert!(mean_db.abs() < 1.0 && errors_db.iter().all(|x| x.abs() < 3.0), "{errors_db:?}");
    let summary = found.summary();
    let expected = placed.len() as f64 / (400_000.0 / RATE_HZ);
    assert!((summary.per_second / expected - 1.0).abs() < 0.05, "{summary:?}");
    assert!((0.2..0.6).contains(&summary.gap_variation), "evenly spread gaps: {summary:?}");
}

#[test]
fn bed_is_as_loud_as_the_noise_between_the_clicks() {
    let (signal, placed) = clicks(400_000);
    let bed = split(std::slice::from_ref(&signal), RATE_HZ).bed.remove(0);
    let goal = power(&noise(1, 400_000, 0.003)) / 400_000.0;
    for (at, peak) in placed {
        let here = power(&bed[at..at + 88]) / 88.0;
        assert!(
            10.0 * (here / goal).log10() < 6.0,
            "a click of {peak} at {at} leaves {} dB",
            10.0 * (here / goal).log10()
        );
    }
    let whole_db = 10.0 * (power(&bed) / 400_000.0 / goal).log10();
    assert!(whole_db.abs() < 0.3, "the bed is {whole_db} dB from the noise");
}

#[test]
fn recordings_without_crackles_stay_whole() {
    let samples = 300_000;
    let tone = |i: usize| (2.0 * PI * 3000.0 * i as f64 / RATE_HZ).sin();
    // A bird's notes: 80 ms, risen within 8 ms, one octave.
    let note = |i: usize| {
        let into = (i % 15_000) as f64 / RATE_HZ;
        let envelope = (into / 0.008).min(1.0) * ((0.08 - into) / 0.008).clamp(0.0, 1.0);
        envelope * (2.0 * PI * (3000.0 + 8000.0 * into) * into).sin()
    };
    let gust = |i: usize| 10f64.powf(1.5 * (2.0 * PI * 1.3 * i as f64 / RATE_HZ).sin() - 1.5);
    let hiss = noise(3, samples, 0.01);
    let over = |sound: &dyn Fn(usize) -> f64| -> Vec<f64> {
        hiss.iter().enumerate().map(|(i, x)| x + 0.3 * sound(i)).collect()
    };
    let recordings = [
        ("noise", hiss.clone()),
        ("a tone", over(&tone)),
        ("birds", over(&note)),
        ("gusts", hiss.iter().enumerate().map(|(i, x)| 30.0 * gust(i) * x).collect()),
        ("silence", vec![0.0; samples]),
        ("one sample", vec![0.5]),
        ("nothing", vec![]),
    ];
    for (name, recording) in recordings {
        let parts = split(std::slice::from_ref(&recording), RATE_HZ);
        assert!(parts.crackles.is_none(), "{name} crackles: {:?}", parts.crackles.unwrap().summary());
        assert!(parts.bed[0] == recording, "{name} is not its own bed");
    }
}

#[test]
fn split_is_the_same_every_time_and_works_at_other_rates() {
    let recording = [clicks(200_000).0, noise(5, 200_000, 0.01)];
    let [first, second] = [split(&recording, RATE_HZ), split(&recording, RATE_HZ)];
    assert!(first.bed == second.bed && first.crackles.is_some());
    assert_eq!(first.crackles.unwrap().events(), second.crackles.unwrap().events());
    for rate_hz in [8_000.0, 96_000.0, 384_000.0] {
        let parts = split(&recording, rate_hz);
        assert!(parts.bed.iter().flatten().all(|x| x.is_finite()), "{rate_hz} Hz");
    }
}

#[test]
fn layer_does_not_depend_on_how_blocks_are_cut() {
    let crackles = crackles();
    let loudness: Vec<f64> = (0..200_000).map(|i| 1.0 + (f64::from(i) / 9000.0).sin()).collect();
    let controls = CrackleControls { density: 3.0, ..CrackleControls::default() };
    let whole = layer(&crackles, &loudness, &controls, -70_000, || BLOCK);
    assert!(onsets(&whole) > 30);
    let mut random = crate::signals::Random::new(4);
    assert!(layer(&crackles, &loudness, &controls, -70_000, || 1 + random.below(BLOCK)) == whole);
    assert!(layer(&crackles, &loudness, &controls, -70_000, || 1) == whole);
}

#[test]
fn a_start_anywhere_gives_what_running_on_gives() {
    let crackles = crackles();
    let loudness = vec![1.0; 600_000];
    let controls = CrackleControls { density: 2.0, ..CrackleControls::default() };
    let whole = layer(&crackles, &loudness, &controls, 1000, || BLOCK);
    // A crackle that began before the start is missed; the longest takes 66 ms.
    let look_back = 3000;
    for start in [1, 17, 40_000, 333_333, 500_000] {
        let later = layer(&crackles, &loudness[start..], &controls, 1000 + start as i64, || BLOCK);
        assert!(later[look_back..] == whole[start + look_back..], "from {start}");
    }
    assert!(onsets(&whole) > 60);
}

#[test]
fn reset_is_as_fresh_and_another_seed_another_order() {
    let crackles = crackles();
    let loudness = vec![1.0; 100_000];
    let controls = CrackleControls::default();
    let fresh = layer(&crackles, &loudness, &controls, 5, || BLOCK);
    let mut used = Crackle::new(RATE_HZ, 1, LATENCY, BLOCK);
    let mut out = vec![0.0; 100_000];
    for position in [777, 5] {
        used.reset(position);
        for (loudness, out) in loudness.chunks(BLOCK).zip(out.chunks_mut(BLOCK)) {
            used.process(loudness, &controls, &Sources::of_recording(&crackles), &mut [out]);
        }
    }
    assert!(out == fresh);
    assert!(layer(&crackles, &loudness, &CrackleControls { seed: 43, ..controls }, 5, || BLOCK) != fresh);
}

#[test]
fn density_is_the_recordings_and_as_asked() {
    let crackles = crackles();
    let loudness = vec![1.0; 1_300_000];
    let rate = |density: f64| {
        let controls = CrackleControls { density, spread: 0.0, ..CrackleControls::default() };
        onsets(&layer(&crackles, &loudness, &controls, 0, || BLOCK)) as f64 / (1_300_000.0 / RATE_HZ)
    };
    let own = crackles.summary().per_second;
    let rates = [0.0, 0.25, 1.0, 2.0].map(rate);
    assert_eq!(rates[0], 0.0);
    assert!((rates[1] / own - 0.25).abs() < 0.1, "{rates:?} where the recording has {own}");
    assert!((rates[2] / own - 1.0).abs() < 0.1, "{rates:?} where the recording has {own}");
    // Some fall together.
    assert!((1.6..2.1).contains(&(rates[3] / own)), "{rates:?} where the recording has {own}");
}

#[test]
fn thinned_crackles_leave_no_gaps_as_long_as_a_run() {
    let controls = CrackleControls { density: 0.5, spread: 0.0, ..CrackleControls::default() };
    let places = onset_places(&layer(&crackles(), &vec![1.0; 2_600_000], &controls, 0, || BLOCK));
    let gaps: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]) as f64).collect();
    let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
    let variance = gaps.iter().map(|gap| (gap - mean) * (gap - mean)).sum::<f64>() / gaps.len() as f64;
    // Independent omission gives 0.76 from the recording's 0.38; runs omitted as a whole give 1.3 and more.
    let variation = variance.sqrt() / mean;
    assert!((0.6..0.95).contains(&variation), "{variation}");
}

#[test]
fn each_comes_once_before_any_comes_again() {
    let (signal, placed) = clicks(400_000);
    let crackles = split(&[signal], RATE_HZ).crackles.unwrap();
    // Levels tell one from another where nothing is varied by more than that.
    let out = layer(&crackles, &vec![1.0; 800_000], &CrackleControls::default(), 0, || BLOCK);
    assert!(onsets(&out).abs_diff(2 * placed.len()) <= placed.len() / 5);
    let halves = [power(&out[..400_000]), power(&out[400_000..])];
    let own: f64 = placed.iter().map(|(_, peak)| peak * peak).sum::<f64>() * 0.25 * 0.0005 * RATE_HZ;
    for half in halves {
        assert!((10.0 * (half / own).log10()).abs() < 2.0, "{halves:?}, {own} in the recording");
    }
}

#[test]
fn follow_makes_crackles_more_and_louder_as_the_drive_is() {
    let crackles = crackles();
    let loudness: Vec<f64> = (0..880_000).map(|i| if i / 44_000 % 2 == 0 { 1.6 } else { 0.4 }).collect();
    let ratio_db = |follow: f64| {
        let controls = CrackleControls { follow, ..CrackleControls::default() };
        let out = layer(&crackles, &loudness, &controls, 0, || BLOCK);
        let part = |odd: usize| -> f64 {
            out.chunks(44_000).enumerate().filter(|(i, _)| i % 2 == odd).map(|(_, part)| power(part)).sum()
        };
        10.0 * (part(0) / part(1)).log10()
    };
    // Density by the loudness, level by its root: 6 + 6 dB for four times the loudness.
    let [none, whole] = [0.0, 1.0].map(ratio_db);
    assert!(none.abs() < 3.0 && (whole - 12.0).abs() < 3.5, "{none} and {whole} dB");
}

#[test]
fn bad_loudness_and_bad_controls_stay_finite_and_silence_is_silent() {
    let crackles = crackles();
    assert!(layer(&crackles, &vec![0.0; 50_000], &CrackleControls::default(), 0, || BLOCK).iter().all(|x| *x == 0.0));
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300];
    for value in bad {
        let controls = CrackleControls {
            fuel: Fuel::Off,
            slot: usize::MAX,
            density: value,
            sharpness: value,
            spread: value,
            follow: value,
            seed: 1,
            highest_peak: value,
        };
        let loudness: Vec<f64> = (0..50_000).map(|i| if i % 3 == 0 { value } else { 1.0 }).collect();
        for position in [0, i64::MAX - 100, i64::MIN + 100] {
            assert!(
                layer(&crackles, &loudness, &controls, position, || BLOCK).iter().all(|x| x.is_finite()),
                "{value}"
            );
        }
    }
}

fn companded() -> EngineConfig {
    EngineConfig { falloff: 0.025, dynamics: MatchingMode::Companded, ..EngineConfig::default() }
}

fn chain_with(recording: &[Vec<f64>], layout: Channels) -> Result<Chain, Error> {
    let shape = PyramidConfig::at_rate(&companded(), RATE_HZ);
    let dictionary = RecordingDictionary::companded(recording, RATE_HZ, &shape, &|_| true)?;
    let mut chain = Chain::new(RATE_HZ, layout, &companded())?;
    chain.swap_dictionary(Some(Arc::new(dictionary)));
    Ok(chain)
}

fn crackle_alone() -> Controls {
    Controls {
        mix: MixControls { low: 0.0, extension: 0.0, texture: 0.0, ..MixControls::default() },
        ..Controls::default()
    }
}

#[test]
fn the_effect_plays_crackles_behind_its_latency_and_only_while_it_is_driven() {
    let mut chain = chain_with(&[clicks(400_000).0], MONO).unwrap();
    let mut drive = channels(22, 1, 150_000).remove(0);
    drive[..40_000].fill(0.0);
    drive[90_000..].fill(0.0);
    let first = Event { at: 0, controls: crackle_alone(), jump: None };
    let out = play(&mut chain, &[drive], &[], 1, &[first], 0, || 512).remove(0);
    assert!(out[..40_000].iter().all(|x| *x == 0.0));
    let heard: Vec<f64> = out.iter().map(|x| f64::from(*x)).collect();
    assert!(onsets(&heard) > 3, "{} crackles", onsets(&heard));
    assert!(out[90_000 + chain.tail_samples().unwrap()..].iter().all(|x| *x == 0.0));
    assert!(chain.take_meters().crackle > 0.01);
}

#[test]
fn the_effect_plays_crackles_the_same_however_it_is_cut_and_after_a_jump() {
    let recording = [clicks(300_000).0, noise(6, 300_000, 0.01)];
    let mut chain = chain_with(&recording, STEREO).unwrap();
    let input = channels(23, 2, 60_000);
    let side = channels(24, 1, 60_000);
    let first = Event {
        at: 0,
        controls: Controls {
            crackle: CrackleControls { density: 4.0, ..CrackleControls::default() },
            ..crackle_alone()
        },
        jump: None,
    };
    let jump = Event { at: 30_000, jump: Some(1_000_000), ..first };
    let mut run = |blocks: &[usize]| {
        chain.reset();
        let mut number = 0;
        let next = || {
            number += 1;
            blocks[number % blocks.len()]
        };
        play(&mut chain, &input, &side, 2, &[first, jump], 500, next)
    };
    let whole = run(&[8192]);
    assert!(whole[0].iter().any(|x| x.abs() > 0.01));
    assert!(run(&[1, 17, 480, 64]) == whole);
}

#[test]
fn ceiling_holds_for_any_input() {
    let mut chain = chain_with(&[clicks(300_000).0], MONO).unwrap();
    let mut controls = Controls {
        mix: MixControls {
            low: 16.0,
            output: 16.0,
            crackle: 16.0,
            texture: 16.0,
            ceiling: true,
            ..MixControls::default()
        },
        ..Controls::default()
    };
    controls.mix.loudness_lufs = Some(-6.0);
    let mut drive: Vec<f32> = channels(22, 1, 60_000).remove(0);
    drive[20_000..].iter_mut().step_by(7).for_each(|x| *x = 1e30);
    drive[40_000] = f32::NAN;
    drive[40_001] = f32::INFINITY;
    let first = Event { at: 0, controls, jump: None };
    let out = play(&mut chain, &[drive], &[], 1, &[first], 0, || 512).remove(0);
    assert!(out.iter().all(|x| x.abs() < 1.0), "{:?}", out.iter().find(|x| x.is_nan() || x.abs() >= 1.0));
    assert!(out.iter().any(|x| x.abs() > 0.95));
}

#[test]
fn recordings_of_any_level_give_equal_loudness() {
    let recording = clicks(300_000).0;
    let drive = channels(22, 1, 200_000).remove(0);
    let level = |gain: f64| {
        let scaled: Vec<f64> = recording.iter().map(|x| gain * x).collect();
        let mut chain = chain_with(&[scaled], MONO).unwrap();
        let mut controls = Controls::default();
        controls.mix = MixControls { low: 0.0, extension: 0.0, loudness_lufs: Some(-28.0), ..controls.mix };
        let first = Event { at: 0, controls, jump: None };
        let out = play(&mut chain, std::slice::from_ref(&drive), &[], 1, &[first], 0, || 512).remove(0);
        10.0 * (out.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / 200_000.0).log10()
    };
    let levels = [0.05, 1.0].map(level);
    assert!((levels[0] - levels[1]).abs() < 0.2 && levels[0] > -45.0, "{levels:?}");
}

#[test]
fn nothing_is_allocated_while_crackles_play() {
    let crackles = crackles();
    let mut crackle = Crackle::new(RATE_HZ, 2, LATENCY, BLOCK);
    let (mut left, mut right) = (vec![0.0; BLOCK], vec![0.0; BLOCK]);
    let loudness = vec![1.0; BLOCK];
    let seen = allocation_counter::measure(|| {
        for block in 0..400u32 {
            let controls = CrackleControls { density: 16.0, seed: block / 50, ..CrackleControls::default() };
            if block % 100 == 0 {
                crackle.reset(i64::from(block) * 1000);
            }
            crackle.process(&loudness, &controls, &Sources::of_recording(&crackles), &mut [&mut left, &mut right]);
        }
        crackle.forget_slot(0);
    });
    assert!(left.iter().any(|x| *x != 0.0));
    assert_eq!((seen.count_total, seen.count_current), (0, 0));
}

#[test]
fn the_papers_mode_tells_crackling_recordings_apart_and_scaling_auto_leaves_their_amplitudes() {
    let structure = EngineConfig { dynamics: MatchingMode::Paper, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, RATE_HZ);
    let drive = channels(22, 1, 40_000);
    for (recording, is_impulsive) in [(clicks(200_000).0, true), (noise(6, 200_000, 0.01), false)] {
        let made = RecordingDictionary::new(MatchingMode::Paper, &[recording], RATE_HZ, &shape, &|_| true).unwrap();
        assert_eq!(made.is_impulsive(), is_impulsive);
        let mut chain = Chain::new(RATE_HZ, MONO, &structure).unwrap();
        chain.swap_dictionary(Some(Arc::new(made)));
        let mut alpha = |scaling_auto: bool| {
            chain.reset();
            let mut controls = Controls::default();
            controls.texture.scaling_auto = scaling_auto;
            let first = Event { at: 0, controls, jump: None };
            play(&mut chain, &drive, &[], 1, &[first], 0, || 512);
            chain.take_meters().scaling_alpha
        };
        assert_eq!(alpha(true) == 0.0, is_impulsive);
        assert!(alpha(false) > 0.9);
    }
}
