//! What the drive makes of its inputs.

use std::f64::consts::TAU;

use pyrophone_synthesis::controls::{DriveControls, DriveMode, FlameControls};
use pyrophone_synthesis::drive::{Drive, SCENES};
use pyrophone_synthesis::dsp::White;

const RATES_HZ: [f64; 3] = [44_100.0, 48_000.0, 96_000.0];

fn off(mode: DriveMode) -> DriveControls {
    DriveControls { mode, high_pass_hz: 0.0, ..DriveControls::default() }
}

fn white(stream: u32, samples: usize) -> Vec<f64> {
    let mut out = vec![0.0; samples];
    White::new(5, stream).fill(0, &mut out);
    out
}

fn drive(main: &[&[f64]], sidechain: &[&[f64]], controls: &DriveControls, rate_hz: f64) -> Vec<f64> {
    let mut out = vec![f64::NAN; main.first().map_or(0, |channel| channel.len())];
    Drive::new(rate_hz).expect("drive").process(main, sidechain, controls, &mut out);
    out
}

fn rms(signal: &[f64]) -> f64 {
    (signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64).sqrt()
}

#[test]
fn pressure_passes_untouched() {
    let input = white(0, 10_000);
    assert_eq!(drive(&[&input], &[], &off(DriveMode::Pressure), 44_100.0), input);
    let halved = drive(&[&input], &[], &DriveControls { gain: 0.5, ..off(DriveMode::Pressure) }, 44_100.0);
    assert!(halved.iter().zip(&input).all(|(half, x)| *half == 0.5 * x));
}

#[test]
fn channels_are_averaged_and_cancelling_is_reported() {
    let (left, right) = (white(0, 20_000), white(1, 20_000));
    let inverse: Vec<f64> = left.iter().map(|x| -x).collect();
    let mean = drive(&[&left, &right], &[], &off(DriveMode::Pressure), 44_100.0);
    assert!(mean.iter().zip(left.iter().zip(&right)).all(|(mean, (l, r))| *mean == 0.5 * (l + r)));
    let cancels = |channels: &[&[f64]]| {
        let mut engine = Drive::new(44_100.0).expect("drive");
        engine.process(channels, &[], &off(DriveMode::Pressure), &mut vec![0.0; 20_000]);
        let told = engine.cancels();
        engine.reset(0);
        (told, engine.cancels())
    };
    assert_eq!(cancels(&[&left, &inverse]), (true, false));
    assert_eq!(cancels(&[&left, &right]), (false, false));
    assert_eq!(cancels(&[&left, &left]), (false, false));
    assert_eq!(cancels(&[&left]), (false, false));
    assert_eq!(cancels(&[&[0.0; 20_000], &[0.0; 20_000]]), (false, false));
}

#[test]
fn flux_is_differentiated_with_unity_gain_at_100_hz() {
    for rate_hz in RATES_HZ {
        for (frequency_hz, gain) in [(50.0, 0.5), (100.0, 1.0), (150.0, 1.5)] {
            let flux: Vec<f64> =
                (0..rate_hz as usize).map(|n| 3.0 + (TAU * frequency_hz * n as f64 / rate_hz).sin()).collect();
            let pressure = drive(&[&flux], &[], &off(DriveMode::Flux), rate_hz);
            // A constant flux has no pressure: neither at the start nor in the mean.
            assert_eq!(pressure[0], 0.0);
            let found = rms(&pressure[1..]) * 2f64.sqrt();
            assert!((found / gain - 1.0).abs() < 1e-3, "{rate_hz} Hz: gain {found} at {frequency_hz} Hz");
        }
    }
}

#[test]
fn envelope_shapes_a_rumble_of_its_own() {
    // An average is scaled so that a sine's is its peak; a constant is larger by a quarter of a turn.
    for (rate_hz, (averaging_s, level)) in
        RATES_HZ.into_iter().flat_map(|rate_hz| [(rate_hz, (0.0, 0.25)), (rate_hz, (0.014, 0.25 * TAU / 4.0))])
    {
        let second = rate_hz as usize;
        let mut sidechain = vec![0.0; 20 * second];
        sidechain[5 * second..15 * second].fill(0.25);
        let main = white(0, sidechain.len());
        let controls = DriveControls { averaging_s, threshold: 0.0, ..off(DriveMode::Envelope) };
        let out = drive(&[&main], &[&sidechain], &controls, rate_hz);
        assert!(out[..5 * second].iter().all(|x| *x == 0.0));
        let loud = &out[6 * second..15 * second];
        assert!((rms(loud) / level - 1.0).abs() < 0.1, "{rate_hz} Hz: {}", rms(loud));
        assert!(out[18 * second..].iter().all(|x| x.abs() < 1e-9));
        // The band: next to nothing outside 40-150 Hz.
        let power_at = |frequency_hz: f64| -> f64 {
            let bins = loud.chunks_exact(second).map(|chunk| {
                let (mut re, mut im) = (0.0, 0.0);
                for (n, x) in chunk.iter().enumerate() {
                    let hann = 0.5 - 0.5 * (TAU * n as f64 / second as f64).cos();
                    let (sin, cos) = (TAU * frequency_hz * n as f64 / rate_hz).sin_cos();
                    (re, im) = (re + hann * x * cos, im + hann * x * sin);
                }
                re * re + im * im
            });
            bins.sum()
        };
        let inside: f64 = (60..130).step_by(7).map(|hz| power_at(f64::from(hz))).sum::<f64>() / 10.0;
        for outside_hz in [3.0, 10.0, 200.0, 400.0, 3000.0] {
            assert!(power_at(outside_hz) < 1e-3 * inside, "{rate_hz} Hz: at {outside_hz} Hz");
        }
    }
}

#[test]
fn without_a_sidechain_the_main_inputs_envelope_drives() {
    let main = white(0, 30_000);
    let controls = off(DriveMode::Envelope);
    let other = white(1, 30_000);
    let of_main = drive(&[&main], &[], &controls, 44_100.0);
    assert_eq!(of_main, drive(&[&other], &[&main], &controls, 44_100.0));
    // Asked for, also where there is a sidechain.
    assert_eq!(of_main, drive(&[&main], &[&other], &off(DriveMode::InputEnvelope), 44_100.0));
    assert_ne!(of_main, drive(&[&main], &[&other], &controls, 44_100.0));
}

#[test]
fn blocks_do_not_matter_and_reset_is_fresh() {
    let (left, right, side) = (white(0, 40_000), white(1, 40_000), white(2, 40_000));
    // Cuts at every change of the controls: every 1000 samples.
    let controls = |at: usize| DriveControls {
        mode: [DriveMode::Pressure, DriveMode::Flux, DriveMode::Envelope, DriveMode::Flame][at / 4000 % 4],
        gain: 1.0 + (at / 1000 % 2) as f64,
        high_pass_hz: [30.0, 0.0, 50.0][at / 3000 % 3],
        seed: (at / 9000) as u32,
        flame: FlameControls {
            scene: at / 1000 % 9,
            intensity: (at / 1000 % 3) as f64,
            wind: (at / 2000 % 3) as f64 * 0.5,
            offset_s: (at / 3000) as f64,
        },
        ..DriveControls::default()
    };
    let run = |engine: &mut Drive, block: usize| {
        let mut out = vec![0.0; left.len()];
        let mut at = 0;
        while at < out.len() {
            let end = (at + block).min((at / 1000 + 1) * 1000).min(out.len());
            let (main, sidechain) = ([&left[at..end], &right[at..end]], [&side[at..end]]);
            engine.process(&main, &sidechain, &controls(at), &mut out[at..end]);
            at = end;
        }
        out
    };
    let mut engine = Drive::new(44_100.0).expect("drive");
    engine.reset(-700);
    let expected = run(&mut engine, 1000);
    for block in [1, 17, 64, 480, 999] {
        engine.reset(-700);
        assert!(run(&mut engine, block) == expected, "block {block}");
    }
}

#[test]
fn silence_gives_exact_silence() {
    for mode in [DriveMode::Pressure, DriveMode::Flux, DriveMode::Envelope, DriveMode::InputEnvelope] {
        let controls = DriveControls { mode, ..DriveControls::default() };
        let mut input = white(0, 10_000);
        input.resize(200_000, 0.0);
        let out = drive(&[&input], &[], &controls, 44_100.0);
        assert!(out[..10_000].iter().any(|x| *x != 0.0));
        assert!(out[150_000..].iter().all(|x| *x == 0.0), "{mode:?}");
        assert!(drive(&[&input[10_000..]], &[], &controls, 44_100.0).iter().all(|x| *x == 0.0), "{mode:?}");
    }
}

fn burning(flame: FlameControls) -> DriveControls {
    DriveControls { flame, ..off(DriveMode::Flame) }
}

/// A flame from `position` on, its controls changed at samples of the run.
fn burn(rate_hz: f64, position: i64, samples: usize, changes: &[(usize, FlameControls)]) -> Vec<f64> {
    let mut engine = Drive::new(rate_hz).expect("drive");
    engine.reset(position);
    let mut out = vec![0.0; samples];
    let ends = changes.iter().skip(1).map(|(at, _)| *at).chain([samples]);
    for ((start, flame), end) in changes.iter().zip(ends) {
        engine.process(&[], &[], &burning(*flame), &mut out[*start..end]);
    }
    out
}

/// Every scene, at three rates.
fn scenes() -> impl Iterator<Item = (f64, FlameControls)> {
    let flames = (0..SCENES.len()).map(|scene| FlameControls { scene, ..FlameControls::default() });
    flames.flat_map(|flame| RATES_HZ.map(|rate_hz| (rate_hz, flame)))
}

#[test]
fn a_flame_depends_on_its_place_on_the_timeline_alone() {
    for (rate_hz, flame) in scenes() {
        let second = rate_hz as usize;
        let from_start = burn(rate_hz, 0, 2 * second, &[(0, flame)]);
        let late = burn(rate_hz, second as i64, second, &[(0, flame)]);
        assert!(from_start[second..] == late, "{} at {rate_hz} Hz", SCENES[flame.scene]);
        let shifted = burn(rate_hz, 0, second, &[(0, FlameControls { offset_s: 1.0, ..flame })]);
        let largest = late.iter().zip(&shifted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest < 1e-9, "{} at {rate_hz} Hz: off by {largest}", SCENES[flame.scene]);
        // Ages ago too.
        let past = burn(rate_hz, -((1i64 << 40) + 7), 3 * second, &[(0, flame)]);
        assert!(past.iter().all(|x| x.is_finite()) && rms(&past) > 1e-3, "{}", SCENES[flame.scene]);
    }
}

#[test]
fn a_flame_hears_no_input() {
    let input = white(0, 20_000);
    let controls = burning(FlameControls::default());
    let alone = burn(44_100.0, 0, 20_000, &[(0, FlameControls::default())]);
    assert_eq!(drive(&[&input, &input], &[&input], &controls, 44_100.0), alone);
}

#[test]
fn pressure_is_proportional_to_a_flames_intensity() {
    for (rate_hz, flame) in scenes() {
        let with = |intensity: f64| FlameControls { intensity, ..flame };
        let seconds = |count: f64| (count * rate_hz) as usize;
        let level = |intensity: f64| rms(&burn(rate_hz, 0, seconds(9.0), &[(0, with(intensity))]));
        let (half, whole, double) = (level(0.5), level(1.0), level(2.0));
        assert!((half / whole - 0.5).abs() < 1e-9 && (double / whole - 2.0).abs() < 1e-9, "{}", SCENES[flame.scene]);
        let out = burn(rate_hz, 0, seconds(2.0), &[(0, flame), (seconds(1.0), with(0.0))]);
        assert!(out[seconds(1.5)..].iter().all(|x| *x == 0.0), "{}", SCENES[flame.scene]);
    }
}

#[test]
fn changes_of_a_flame_do_not_click() {
    let rate_hz = 48_000.0;
    let calm = FlameControls { intensity: 0.3, ..FlameControls::default() };
    let bend = |signal: &[f64]| signal.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max);
    let changed = |flame: FlameControls| burn(rate_hz, 0, 48_000, &[(0, calm), (20_000, flame)]);
    for (what, flame) in [
        ("intensity", FlameControls { intensity: 2.0, ..calm }),
        ("wind", FlameControls { wind: 1.0, ..calm }),
        ("offset", FlameControls { offset_s: 5.0, ..calm }),
        ("scene", FlameControls { scene: 4, ..calm }),
    ] {
        let straight = [calm, flame].map(|flame| bend(&burn(rate_hz, 0, 48_000, &[(0, flame)])));
        let bent = bend(&changed(flame));
        assert!(bent < 3.0 * straight[0].max(straight[1]), "{what}: {bent} beside {straight:?}");
        // And it ends in what it was changed to.
        let after = burn(rate_hz, 0, 48_000, &[(0, flame)]);
        assert_eq!(changed(flame)[40_000..], after[40_000..], "{what}");
    }
}
