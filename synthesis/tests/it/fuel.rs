//! Fire without a recording: the crackle, hiss and body of a fuel, in the whole effect.

use crate::effect::{Event, STEREO, channels, dictionary, play};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels};
use pyrophone_synthesis::controls::{Controls, CrackleControls, Fuel, FuelControls, MixControls};
use pyrophone_synthesis::fuel::{FuelNoise, LOUDNESS_LUFS, NoiseLevels};
use pyrophone_synthesis::structure::MatchingMode;

const RATE_HZ: f64 = 44_100.0;
const MONO: Channels = Channels { input: 1, sidechain: 0, output: 1 };
const BLOCK: usize = 500;

fn companded() -> EngineConfig {
    EngineConfig { dynamics: MatchingMode::Companded, ..EngineConfig::default() }
}

fn chain(layout: Channels) -> Chain {
    Chain::new(RATE_HZ, layout, &companded()).unwrap()
}

/// Crackle, hiss and body of a fuel at these levels, and nothing else.
fn controls(fuel: Fuel, [crackle, hiss, body]: [f64; 3]) -> Controls {
    let mut controls = Controls::default();
    controls.mix = MixControls { low: 0.0, extension: 0.0, texture: 0.0, crackle, hiss, body, ..controls.mix };
    controls.crackle.fuel = fuel;
    controls.fuel.fuel = fuel;
    controls
}

fn run(chain: &mut Chain, controls: Controls, input: &[Vec<f32>], outputs: usize, position: i64) -> Vec<Vec<f32>> {
    let first = Event { at: 0, controls, jump: None };
    play(chain, input, &[], outputs, &[first], position, || 512)
}

fn power(signal: &[f32]) -> f64 {
    signal.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / signal.len().max(1) as f64
}

#[test]
fn loud_crackles_stay_below_the_ceiling_on_both_sides_and_at_any_sharpness() {
    let drive = channels(22, 1, 400_000);
    for fuel in &Fuel::ALL[1..] {
        for sharpness in [-1.0, 0.0, 1.0] {
            let mut loud = controls(*fuel, [30.0, 0.0, 0.0]);
            loud.mix.ceiling = true;
            // So few that hardly two sound together.
            loud.crackle = CrackleControls { density: 0.1, follow: 0.0, sharpness, ..loud.crackle };
            let out = run(&mut chain(STEREO), loud, &[drive[0].clone(), drive[0].clone()], 2, 0);
            let peak = out.iter().flatten().fold(0.0f32, |peak, x| peak.max(x.abs()));
            assert!((0.3..0.95).contains(&peak), "{fuel:?} {sharpness}: {peak}");
        }
    }
}

#[test]
fn every_fuel_sounds_without_a_recording_and_differs_from_the_others() {
    let drive = channels(22, 1, 90_000);
    let layers = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for levels in layers {
        let mut heard: Vec<Vec<f32>> = Vec::new();
        for fuel in &Fuel::ALL[1..] {
            let mut chain = chain(MONO);
            let out = run(&mut chain, controls(*fuel, levels), &drive, 1, 0).remove(0);
            assert!(power(&out) > 1e-9, "{fuel:?} {levels:?} is silent");
            assert!(heard.iter().all(|other| *other != out), "{fuel:?} {levels:?} is another fuel");
            let meters = chain.take_meters();
            let measured = [meters.crackle, meters.hiss, meters.body];
            for (level, meter) in levels.iter().zip(measured) {
                assert_eq!(*level > 0.0, meter > 0.0, "{fuel:?} {levels:?}: {measured:?}");
            }
            heard.push(out);
        }
    }
    let mut chain = chain(MONO);
    assert_eq!(power(&run(&mut chain, controls(Fuel::Off, [1.0, 0.0, 0.0]), &drive, 1, 0)[0]), 0.0);
}

#[test]
fn silence_in_is_silence_out_after_the_tail() {
    let mut chain = chain(MONO);
    let mut drive = channels(22, 1, 150_000).remove(0);
    drive[..40_000].fill(0.0);
    drive[90_000..].fill(0.0);
    let mut controls = controls(Fuel::WetWood, [1.0; 3]);
    controls.fuel.follow = 0.0;
    controls.crackle.follow = 0.0;
    let out = run(&mut chain, controls, &[drive], 1, 0).remove(0);
    assert!(out[..40_000].iter().all(|x| *x == 0.0));
    assert!(power(&out[50_000..90_000]) > 1e-8);
    assert!(out[90_000 + chain.tail_samples().unwrap()..].iter().all(|x| *x == 0.0));
}

#[test]
fn cutting_and_jumps_and_resets_change_nothing() {
    let mut chain = chain(STEREO);
    let (input, side) = (channels(23, 2, 60_000), channels(24, 1, 60_000));
    let mut first = Event { at: 0, controls: controls(Fuel::Grass, [1.0; 3]), jump: None };
    first.controls.crackle.density = 4.0;
    // The second fuel takes over while crackles of the first sound, and the noise changes its tone.
    let mut second = Event { at: 20_000, controls: controls(Fuel::WetWood, [1.0; 3]), jump: None };
    second.controls.fuel.hiss_tone = -1.0;
    let off = Event { at: 30_000, controls: controls(Fuel::Off, [1.0, 0.0, 0.5]), jump: None };
    let jump = Event { at: 40_000, jump: Some(1_000_000), ..first };
    let mut run = |blocks: &[usize]| {
        chain.reset();
        let mut number = 0;
        let next = || {
            number += 1;
            blocks[number % blocks.len()]
        };
        play(&mut chain, &input, &side, 2, &[first, second, off, jump], 500, next)
    };
    let whole = run(&[8192]);
    assert!(whole.iter().all(|channel| channel.iter().any(|x| x.abs() > 1e-3)));
    assert!(run(&[1, 17, 480, 64]) == whole);
    assert!(run(&[256]) == whole);
}

#[test]
fn noise_is_a_function_of_seed_and_position() {
    let (loudness, latency) = (vec![1.0; 60_000], 2048);
    let levels = NoiseLevels { hiss: 1.0, body: 1.0 };
    let run = |controls: &FuelControls, position: i64, samples: usize| {
        let mut noise = FuelNoise::new(RATE_HZ, 2, latency);
        noise.reset(position);
        let mut out = vec![vec![0.0; samples]; 4];
        let [a, b, c, d] = &mut out[..] else { panic!() };
        let blocks = a.chunks_mut(BLOCK).zip(b.chunks_mut(BLOCK)).zip(c.chunks_mut(BLOCK)).zip(d.chunks_mut(BLOCK));
        for (((a, b), c), d) in blocks {
            let loudness = &loudness[..a.len()];
            noise.process(loudness, controls, levels, &mut [a, b], &mut [c, d]);
        }
        out
    };
    let controls = FuelControls { fuel: Fuel::DryWood, ..FuelControls::default() };
    let whole = run(&controls, -70_000, 60_000);
    let later = run(&controls, -70_000 + 12_345, 20_000);
    for (whole, later) in whole.iter().zip(&later) {
        assert_eq!(whole[12_345..32_345], later[..]);
    }
    assert_ne!(run(&FuelControls { seed: 43, ..controls }, -70_000, 1000)[0], whole[0][..1000]);
    for fuel in Fuel::ALL {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let broken = FuelControls {
                fuel,
                hiss_tone: value,
                hiss_flutter: value,
                body_tone: value,
                body_flutter: value,
                follow: value,
                seed: 1,
            };
            for position in [i64::MIN, 0, i64::MAX] {
                assert!(run(&broken, position, 3000).iter().flatten().all(|x| x.is_finite()), "{fuel:?} {value}");
            }
        }
    }
}

#[test]
fn layers_have_the_loudness_that_is_stated() {
    let noise = |levels: NoiseLevels| {
        let mut noise = FuelNoise::new(RATE_HZ, 1, 0);
        noise.reset(0);
        let (mut hiss, mut body) = (vec![0.0; 30 * 44_100], vec![0.0; 30 * 44_100]);
        let loudness = vec![1.0; BLOCK];
        for (hiss, body) in hiss.chunks_mut(BLOCK).zip(body.chunks_mut(BLOCK)) {
            noise.process(&loudness[..hiss.len()], &FuelControls::default(), levels, &mut [hiss], &mut [body]);
        }
        [hiss, body]
    };
    let [hiss, body] = noise(NoiseLevels { hiss: 1.0, body: 1.0 });
    for (name, signal) in [("hiss", hiss), ("body", body)] {
        let lufs = lufs(&signal);
        assert!((lufs - LOUDNESS_LUFS).abs() < 1.0, "{name}: {lufs} LUFS");
    }
    let [hiss, body] = noise(NoiseLevels { hiss: 0.0, body: 0.0 });
    assert!(hiss.iter().chain(&body).all(|x| *x == 0.0), "a layer that is off is not made");
}

/// Loudness of a whole signal by the filters of ITU-R BS.1770 at 44.1 kHz, without its gates.
fn lufs(signal: &[f64]) -> f64 {
    use std::f64::consts::PI;
    let biquad = |b: [f64; 3], a: [f64; 2], signal: &[f64]| -> Vec<f64> {
        let mut past = [0.0; 4];
        signal
            .iter()
            .map(|x| {
                let y = b[0] * x + b[1] * past[0] + b[2] * past[1] - a[0] * past[2] - a[1] * past[3];
                past = [*x, past[0], y, past[2]];
                y
            })
            .collect()
    };
    let (k, q, gain) = ((PI * 1681.974 / RATE_HZ).tan(), 0.707_175, 10f64.powf(3.999_84 / 20.0));
    let (root, a0) = (gain.powf(0.499_67), 1.0 + k / q + k * k);
    let shelf = biquad(
        [(gain + root * k / q + k * k) / a0, 2.0 * (k * k - gain) / a0, (gain - root * k / q + k * k) / a0],
        [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0],
        signal,
    );
    let (k, q) = ((PI * 38.1355 / RATE_HZ).tan(), 0.500_327);
    let a0 = 1.0 + k / q + k * k;
    let weighted = biquad([1.0, -2.0, 1.0], [2.0 * (k * k - 1.0) / a0, (1.0 - k / q + k * k) / a0], &shelf);
    -0.691 + 10.0 * (weighted.iter().map(|x| x * x).sum::<f64>() / weighted.len() as f64).log10()
}

#[test]
fn the_loudness_parameter_moves_all_of_a_fuel_alike() {
    let drive = channels(22, 1, 120_000);
    for levels in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
        let level_db = |target: Option<f64>| {
            let mut controls = controls(Fuel::DryWood, levels);
            controls.mix.loudness_lufs = target;
            10.0 * power(&run(&mut chain(MONO), controls, &drive, 1, 0)[0]).log10()
        };
        let plain = level_db(None);
        assert!((level_db(Some(LOUDNESS_LUFS)) - plain).abs() < 1e-6, "{levels:?}");
        assert!((level_db(Some(LOUDNESS_LUFS - 12.0)) - plain + 12.0).abs() < 1e-3, "{levels:?}");
    }
}

#[test]
fn a_recording_without_crackles_leaves_them_to_the_fuel_and_no_fuel_to_itself() {
    let drive = channels(22, 1, 60_000);
    // A recording of even noise: it has no crackles.
    let mut with = chain(MONO);
    with.swap_dictionary(Some(dictionary(RATE_HZ, &companded(), 1)));
    let of_fuel = run(&mut chain(MONO), controls(Fuel::DryWood, [1.0, 0.0, 0.0]), &drive, 1, 0);
    let beside = run(&mut with, controls(Fuel::DryWood, [1.0, 0.0, 0.0]), &drive, 1, 0);
    assert!(power(&of_fuel[0]) > 0.0);
    assert_eq!(of_fuel, beside);
    with.reset();
    assert_eq!(power(&run(&mut with, controls(Fuel::Off, [1.0, 0.0, 0.0]), &drive, 1, 0)[0]), 0.0);
    // Layers that are off leave the sound as it was, bit for bit, and spectral extension stands in for want of a fuel alone.
    with.reset();
    let mut plain = Controls::default();
    plain.crackle.seed = 5;
    let before = run(&mut with, plain, &drive, 1, 0);
    with.reset();
    let mut muted = plain;
    (muted.crackle.fuel, muted.fuel.fuel, muted.mix.crackle) = (Fuel::Coal, Fuel::Coal, 0.0);
    assert_eq!(run(&mut with, muted, &drive, 1, 0), before);
    let mut texture = controls(Fuel::Off, [0.0; 3]);
    texture.mix.texture = 1.0;
    assert!(power(&run(&mut chain(MONO), texture, &drive, 1, 0)[0]) > 0.0);
    (texture.crackle.fuel, texture.fuel.fuel) = (Fuel::Coal, Fuel::Coal);
    assert_eq!(power(&run(&mut chain(MONO), texture, &drive, 1, 0)[0]), 0.0);
}

#[test]
fn nothing_is_allocated_while_a_fuel_burns() {
    let mut noise = FuelNoise::new(RATE_HZ, 2, 2048);
    let mut buffers = vec![vec![0.0; BLOCK]; 4];
    let [a, b, c, d] = &mut buffers[..] else { panic!() };
    let loudness = vec![1.0; BLOCK];
    let seen = allocation_counter::measure(|| {
        for block in 0..400usize {
            let controls = FuelControls {
                fuel: Fuel::from_index(block / 20 % 6),
                seed: block as u32 / 50,
                hiss_tone: (block % 3) as f64 - 1.0,
                ..FuelControls::default()
            };
            if block % 100 == 0 {
                noise.reset(block as i64 * 1000);
            }
            let levels = NoiseLevels { hiss: (block / 150 % 2) as f64, body: 1.0 };
            noise.process(&loudness, &controls, levels, &mut [a, b], &mut [c, d]);
        }
    });
    assert!(buffers[3].iter().any(|x| *x != 0.0));
    assert_eq!((seen.count_total, seen.count_current), (0, 0));
}
