//! What the drive makes of its inputs.

use std::f64::consts::TAU;

use pyrophone_synthesis::controls::{DriveControls, DriveMode};
use pyrophone_synthesis::drive::Drive;
use pyrophone_synthesis::noise::White;

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
fn channels_are_averaged_and_cancelling_is_told() {
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
    for rate_hz in RATES_HZ {
        let second = rate_hz as usize;
        let mut sidechain = vec![0.0; 20 * second];
        sidechain[5 * second..15 * second].fill(0.25);
        let main = white(0, sidechain.len());
        let controls = DriveControls { threshold: 0.0, ..off(DriveMode::Envelope) };
        let out = drive(&[&main], &[&sidechain], &controls, rate_hz);
        assert!(out[..5 * second].iter().all(|x| *x == 0.0));
        let loud = &out[6 * second..15 * second];
        assert!((rms(loud) / 0.25 - 1.0).abs() < 0.1, "{rate_hz} Hz: {}", rms(loud));
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
fn without_a_sidechain_the_main_inputs_envelope_is_taken() {
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
        mode: [DriveMode::Pressure, DriveMode::Flux, DriveMode::Envelope][at / 4000 % 3],
        gain: 1.0 + (at / 1000 % 2) as f64,
        high_pass_hz: [30.0, 0.0, 50.0][at / 3000 % 3],
        seed: (at / 9000) as u32,
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
