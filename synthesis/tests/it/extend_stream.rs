//! The streaming extension by itself: bands, slopes, latency, blocks, reset, silence.

use crate::extend::*;
use proptest::prelude::*;
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::controls::ExtendControls;
use pyrophone_synthesis::dsp::White;
use pyrophone_synthesis::extend::Extend;

const RATES_HZ: [f64; 3] = [44_100.0, 48_000.0, 96_000.0];

#[test]
fn the_low_part_is_flat_linear_in_phase_and_as_late_as_reported() {
    for rate_hz in RATES_HZ {
        let latency = Extend::new(&EngineConfig::default(), 1, rate_hz).expect("engine").latency_samples();
        let at = rate_hz as usize / 4 - 123;
        let mut impulse = vec![0.0; rate_hz as usize / 2];
        impulse[at] = 1.0;
        let low = run_simply(&impulse, rate_hz, ExtendControls::default()).low;
        let peak = (0..low.len()).max_by(|a, b| low[*a].total_cmp(&low[*b])).expect("samples");
        assert_eq!(peak, at, "{rate_hz} Hz: latency is {} instead of {latency}", latency + peak - at);
        let asymmetry = (1..at).map(|i| (low[at - i] - low[at + i]).abs()).fold(0.0, f64::max);
        assert!(asymmetry < 1e-12 * low[at], "{rate_hz} Hz: {asymmetry:e}");
        for frequency_hz in (40..=150).step_by(2) {
            let turn = std::f64::consts::TAU * f64::from(frequency_hz) / rate_hz;
            let gain: f64 = low.iter().enumerate().map(|(i, x)| x * (turn * (i as f64 - at as f64)).cos()).sum();
            let decibels = 20.0 * gain.log10();
            assert!(decibels.abs() <= 0.1, "{rate_hz} Hz: {decibels:+.3} dB at {frequency_hz} Hz");
        }
    }
}

#[test]
fn the_noise_stands_where_the_drive_stands() {
    for rate_hz in RATES_HZ {
        let mut burst = vec![0.0; rate_hz as usize];
        let middle = rate_hz as usize / 2;
        let reach = (0.02 * rate_hz) as usize;
        for (i, sample) in burst[middle - reach..=middle + reach].iter_mut().enumerate() {
            let from_middle = i as f64 - reach as f64;
            let hann = (std::f64::consts::FRAC_PI_2 * from_middle / reach as f64).cos().powi(2);
            *sample = hann * (std::f64::consts::TAU * 120.0 * from_middle / rate_hz).cos();
        }
        // Averaged over seeds, the power's centre of gravity is the burst's.
        let (mut moment, mut power) = (0.0, 0.0);
        for seed in 0..64 {
            let noise = &run_simply(&burst, rate_hz, ExtendControls { seed, ..ExtendControls::default() }).noise[0];
            for (at, sample) in noise.iter().enumerate() {
                moment += sample * sample * (at as f64 - middle as f64);
                power += sample * sample;
            }
        }
        let lag_s = moment / power / rate_hz;
        assert!(power > 0.0 && lag_s.abs() < 0.002, "{rate_hz} Hz: {} ms", 1000.0 * lag_s);
    }
}

#[test]
fn slopes_are_those_asked_for() {
    for rate_hz in RATES_HZ {
        let drive = steady_drive(60 * rate_hz as usize, rate_hz);
        // The noise is the same at every rate: the ends at one of them, the middle at the others, everything in the long tests.
        let is_soak = std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1");
        let all = [2.0, 2.5, 3.0, 3.5, 4.0];
        let is_first = rate_hz == RATES_HZ[0];
        let alphas: Vec<f64> = match (is_soak, is_first) {
            (true, _) => all.to_vec(),
            (false, true) => vec![all[0], all[4]],
            (false, false) => vec![all[2]],
        };
        for alpha in alphas {
            let sum = run_simply(&drive, rate_hz, ExtendControls { alpha, ..ExtendControls::default() }).sum();
            let error = slope(&sum, rate_hz) + alpha;
            println!("{rate_hz} Hz, alpha {alpha}: slope off by {error:+.3}");
            assert!(error.abs() <= 0.15, "{rate_hz} Hz, alpha {alpha}: {error:+.3}");
        }
    }
}

#[test]
fn a_fast_sweep_of_alpha_does_not_click() {
    let rate_hz = 44_100.0;
    let drive = steady_drive(3 * 44_100, rate_hz);
    let second_difference =
        |signal: &[f64]| signal.windows(3).map(|x| (x[2] - 2.0 * x[1] + x[0]).abs()).fold(0.0, f64::max);
    let with = |alpha: &dyn Fn(usize) -> f64| {
        let mut engine = Extend::new(&EngineConfig::default(), 1, rate_hz).expect("engine");
        let controls = |at: usize| ExtendControls { alpha: alpha(at), ..ExtendControls::default() };
        second_difference(&run(&mut engine, 1, &drive, controls, std::iter::repeat(64)).sum())
    };
    let (two, four) = (with(&|_| 2.0), with(&|_| 4.0));
    // Sweeps one after another, so that every part of the drive meets one.
    let sweep = with(&|at| 4.0 - 2.0 * ((at % 8820) as f64 / 4410.0 - 1.0).abs());
    println!("second difference: {sweep:.3e} swept, {two:.3e} at alpha 2, {four:.3e} at alpha 4");
    assert!(sweep <= 1.1 * two.max(four));
}

/// A drive with silences, and controls that change at odd places.
fn busy_drive(samples: usize) -> Vec<f64> {
    let white = White::new(9, 9);
    let mut state = 0.0;
    (0..samples)
        .map(|at| {
            state += 0.01 * (white.sample_at(at as i64) - state);
            if (at / 7000) % 3 == 2 { 0.0 } else { state }
        })
        .collect()
}

fn busy_controls(at: usize) -> ExtendControls {
    let step = (at / 2345) as f64;
    ExtendControls {
        alpha: 2.0 + step % 3.0,
        cutoff_hz: 150.0 + 20.0 * (step % 5.0),
        blend_width_hz: 30.0 + step % 2.0,
        noise_amount: 1.0 + step % 2.0,
        seed: (at / 10_000) as u32,
        width: (step % 4.0) / 3.0,
    }
}

/// The same run cut at `blocks`, and at every change of the controls.
fn cut(engine: &mut Extend, drive: &[f64], blocks: impl IntoIterator<Item = usize>) -> Run {
    let mut at = 0;
    let cuts: Vec<usize> = blocks
        .into_iter()
        .map_while(|block| {
            if at > drive.len() + engine.latency_samples() {
                return None;
            }
            let pieces = split_at_controls(at, block);
            at += block;
            Some(pieces)
        })
        .flatten()
        .collect();
    run(engine, 2, drive, busy_controls, cuts)
}

fn split_at_controls(mut at: usize, mut block: usize) -> Vec<usize> {
    let mut pieces = Vec::new();
    while block > 0 {
        let next = [2345, 10_000].iter().map(|period| period - at % period).min().unwrap_or(block).min(block);
        pieces.push(next);
        at += next;
        block -= next;
    }
    pieces
}

fn assert_same(found: &Run, expected: &Run, what: &str) {
    assert!(found.low == expected.low, "{what}: low part differs");
    assert!(found.noise == expected.noise, "{what}: noise differs");
}

#[test]
fn blocks_do_not_matter() {
    let drive = busy_drive(40_000);
    for position in [0, -12_345, 1_000_003] {
        let fresh = || {
            let mut engine = Extend::new(&EngineConfig::default(), 2, 44_100.0).expect("engine");
            engine.reset(position);
            engine
        };
        let expected = cut(&mut fresh(), &drive, std::iter::repeat(8192));
        assert!(expected.noise[0].iter().any(|x| *x != 0.0) && expected.noise[0] != expected.noise[1]);
        for block in [1, 17, 64, 480, 1024, 4096] {
            assert_same(&cut(&mut fresh(), &drive, std::iter::repeat(block)), &expected, &format!("block {block}"));
        }
        let random = (0i64..).map(|i| (White::new(3, 3).sample_at(i).abs() * 1500.0) as usize);
        assert_same(&cut(&mut fresh(), &drive, random), &expected, "random blocks");
    }
}

#[test]
fn reset_is_fresh() {
    let drive = busy_drive(20_000);
    for rate_hz in RATES_HZ {
        let mut engine = Extend::new(&EngineConfig::default(), 2, rate_hz).expect("engine");
        let expected = cut(&mut engine, &drive, std::iter::repeat(1000));
        let mut used = Extend::new(&EngineConfig::default(), 2, rate_hz).expect("engine");
        used.reset(777);
        cut(&mut used, &busy_drive(30_000)[3000..], std::iter::repeat(333));
        used.reset(0);
        assert_same(&cut(&mut used, &drive, std::iter::repeat(1000)), &expected, "after reset");
    }
}

#[test]
fn noise_and_windows_belong_to_the_timeline() {
    let drive = busy_drive(30_000);
    let controls = |_| ExtendControls::default();
    let mut early = Extend::new(&EngineConfig::default(), 1, 44_100.0).expect("engine");
    early.reset(-5000);
    let whole = run(&mut early, 1, &drive, controls, std::iter::repeat(512));
    let mut late = Extend::new(&EngineConfig::default(), 1, 44_100.0).expect("engine");
    late.reset(4321 - 5000);
    let part = run(&mut late, 1, &drive[4321..], controls, std::iter::repeat(512));
    // Once nothing from before the later start is in reach.
    let settled = 4 * late.latency_samples();
    let difference = part.sum()[settled..]
        .iter()
        .zip(&whole.sum()[4321 + settled..])
        .fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs()));
    assert!(difference < 1e-12, "{difference:e}");
}

#[test]
fn silence_in_gives_silence_out() {
    let rate_hz = 44_100.0;
    let mut engine = Extend::new(&EngineConfig::default(), 2, rate_hz).expect("engine");
    let tail = engine.tail_samples();
    let mut drive = vec![0.0; 60_000];
    drive[10_000..20_000].copy_from_slice(&busy_drive(10_000));
    let found = run(&mut engine, 2, &drive, |_| ExtendControls::default(), std::iter::repeat(100));
    for (what, signal) in [("low", &found.low), ("left", &found.noise[0]), ("right", &found.noise[1])] {
        assert!(signal[10_000..20_000].iter().any(|x| x.abs() > 1e-6), "{what} is empty");
        assert!(signal[..10_000 - tail].iter().all(|x| *x == 0.0), "{what} sounds too early");
        assert!(signal[20_000 + tail..].iter().all(|x| *x == 0.0), "{what} sounds on");
    }
}

#[test]
fn width_keeps_the_level_and_sets_the_correlation() {
    let drive = steady_drive(10 * 44_100, 44_100.0);
    let mut levels = Vec::new();
    // Every channel fits its own beta, so at half width the outputs agree less than their noises,
    // whose correlation is 1 - width^2.
    for (width, correlations) in [(0.0, 1.0 - 1e-12..1.0 + 1e-12), (0.5, 0.55..0.8), (1.0, -0.1..0.1)] {
        let mut engine = Extend::new(&EngineConfig::default(), 2, 44_100.0).expect("engine");
        let controls = ExtendControls { width, ..ExtendControls::default() };
        let found = run(&mut engine, 2, &drive, |_| controls, std::iter::repeat(512));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (left, right) = (&found.noise[0], &found.noise[1]);
        let correlation = dot(left, right) / (dot(left, left) * dot(right, right)).sqrt();
        assert!(correlations.contains(&correlation), "width {width}: {correlation}");
        levels.push(10.0 * dot(left, left).log10());
    }
    assert!(levels.iter().all(|level| (level - levels[0]).abs() < 1.0), "{levels:?} dB");
}

#[test]
fn refuses_what_it_cannot_do() {
    let structure = EngineConfig::default();
    assert!(Extend::new(&structure, 0, 44_100.0).is_err());
    assert!(Extend::new(&structure, 11, 44_100.0).is_err());
    assert!(Extend::new(&structure, 1, 7_000.0).is_err());
    assert!(Extend::new(&EngineConfig { half_width: 99, ..structure }, 1, 44_100.0).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]
    /// Whatever the sizes and controls, sense or nonsense: finite output, on time.
    #[test]
    fn survives_any_configuration(
        half_width in 100usize..=2000,
        fit_width_hz in 3.0f64..=120.0,
        rate_hz in prop::sample::select(vec![8000.0, 22_050.0, 44_100.0, 88_200.0, 192_000.0]),
        alpha in prop::sample::select(vec![0.0, 2.5, 6.0, -1.0, 99.0, f64::NAN, f64::INFINITY]),
        cutoff_hz in prop::sample::select(vec![40.0, 180.0, 1000.0, 0.0, 1e9, f64::NAN]),
        blend_width_hz in prop::sample::select(vec![2.0, 30.0, 400.0, 0.0, f64::NAN]),
        noise_amount in prop::sample::select(vec![0.0, 1.0, 4.0, f64::NAN]),
        position in prop::sample::select(vec![0, -1, 1 << 40, i64::MIN, i64::MAX]),
    ) {
        let structure = EngineConfig { half_width, fit_width_hz, ..EngineConfig::default() };
        let mut engine = Extend::new(&structure, 1, rate_hz).expect("engine");
        engine.reset(position);
        let drive = busy_drive(4 * engine.latency_samples());
        let controls = ExtendControls { alpha, cutoff_hz, blend_width_hz, noise_amount, ..ExtendControls::default() };
        let found = run(&mut engine, 1, &drive, |_| controls, std::iter::repeat(700));
        prop_assert!(found.sum().iter().all(|x| x.is_finite() && x.abs() < 1e3));
        prop_assert!(found.low.iter().any(|x| *x != 0.0));
    }
}
