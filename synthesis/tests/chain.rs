//! The whole effect: blocks, reset, transport, automation, latency, bypass, bad input.

#[path = "common/effect.rs"]
mod effect;
#[path = "common/signals.rs"]
mod signals;

use std::sync::Arc;

use effect::{Event, MODES, STEREO, any_controls, chain, channels, dictionary, play};
use pyrophone_synthesis::Structure;
use pyrophone_synthesis::chain::{Chain, Channels, Transport, learn};
use pyrophone_synthesis::controls::{Controls, DynamicRange, MixControls, Quality, TextureControls};
use pyrophone_synthesis::structure::Dynamics;
use pyrophone_synthesis::texture::{Shape, offline, shape::Padding};
use signals::Random;

const RATE_HZ: f64 = 44_100.0;

fn first(controls: Controls) -> Event {
    Event { at: 0, controls, jump: None }
}

/// All layers audible, nothing random.
fn plain() -> Controls {
    let texture = TextureControls { quality: Quality::Bounded { candidates: 128 }, ..TextureControls::default() };
    Controls { texture, ..Controls::default() }
}

#[test]
fn blocks_never_matter_under_automation_and_jumps() {
    let samples = 40_000;
    let (input, sidechain) = (channels(1, 2, samples), channels(2, 1, samples));
    for (seed, dynamics) in (0..4).flat_map(|seed| MODES.map(|dynamics| (seed, dynamics))) {
        let mut random = Random::new(seed);
        let mut events = vec![first(any_controls(&mut random))];
        for _ in 0..12 {
            let jump = (random.below(3) == 0).then(|| random.below(2_000_000) as i64 - 1_000_000);
            events.push(Event { at: random.below(samples), controls: any_controls(&mut random), jump });
        }
        events.sort_by_key(|event| event.at);
        let mut chain = chain(RATE_HZ, STEREO, dynamics);
        let expected = play(&mut chain, &input, &sidechain, 2, &events, -500, || samples);
        assert!(expected.iter().flatten().all(|x| x.is_finite()));
        assert!(expected[0].iter().any(|x| x.abs() > 1e-3), "seed {seed} is silent");
        for block in [1, 17, 64, 480, 1024, 4096, 8192] {
            chain.reset();
            let out = play(&mut chain, &input, &sidechain, 2, &events, -500, || block);
            assert!(out == expected, "{dynamics:?}, seed {seed}, blocks of {block}");
        }
        chain.reset();
        let out = play(&mut chain, &input, &sidechain, 2, &events, -500, || random.below(3000));
        assert!(out == expected, "{dynamics:?}, seed {seed}, random blocks");
    }
}

#[test]
fn a_jump_ends_in_what_a_fresh_start_there_gives() {
    let (before, after) = (13_000, 40_000);
    let input = channels(3, 2, before + after);
    let jumps = [(777_777, None), (-5, None), (123, Some(900)), (4_000_000_000, Some(1))];
    for ((jump, again), dynamics) in jumps.into_iter().flat_map(|jump| MODES.map(|dynamics| (jump, dynamics))) {
        // `again`: a second jump while the first is under way.
        let mut events = vec![first(plain()), Event { at: before, controls: plain(), jump: Some(jump) }];
        let (mut from, mut position) = (before, jump);
        if let Some(later) = again {
            events.push(Event { at: before + later, controls: plain(), jump: Some(50_000) });
            let chain = chain(RATE_HZ, STEREO, dynamics);
            // The second one waits until the first is through.
            let wait = chain.latency_samples() + 441;
            from = before + wait;
            position = 50_000 + (wait - later) as i64;
        }
        let mut chain = chain(RATE_HZ, STEREO, dynamics);
        let out = play(&mut chain, &input, &[], 2, &events, 99, || 512);
        let rest: Vec<Vec<f32>> = input.iter().map(|x| x[from..].to_vec()).collect();
        let mut fresh = effect::chain(RATE_HZ, STEREO, dynamics);
        let expected = play(&mut fresh, &rest, &[], 2, &[first(plain())], position, || 300);
        let settled = fresh.latency_samples() + 441;
        for channel in 0..2 {
            assert!(out[channel][from + settled..] == expected[channel][settled..], "jump to {jump}, then {again:?}");
        }
        // Until the jump comes out, nothing has changed.
        let mut straight = effect::chain(RATE_HZ, STEREO, dynamics);
        let unjumped = play(&mut straight, &input, &[], 2, &[first(plain())], 99, || 512);
        let heard = before + straight.latency_samples();
        assert!(out[0][..heard] == unjumped[0][..heard]);
    }
}

#[test]
fn the_counter_runs_free_while_the_host_stops_or_is_silent_about_time() {
    let input = channels(4, 2, 30_000);
    let run = |transports: &dyn Fn(usize) -> Transport| {
        let mut chain = chain(RATE_HZ, STEREO, Dynamics::Paper);
        let mut out = input.clone();
        for start in (0..30_000).step_by(500) {
            let mut main: Vec<&mut [f32]> = out.iter_mut().map(|x| &mut x[start..start + 500]).collect();
            chain.process(&mut main, &[], &plain(), transports(start));
        }
        out
    };
    let told = |start: usize, playing| Transport { playing, position: Some(7000 + start as i64) };
    let expected = run(&|start| told(start, true));
    // Stopped at one place, and stopped with a position that moves about.
    assert!(run(&|start| if start < 9000 { told(start, true) } else { told(8500, false) }) == expected);
    assert!(run(&|start| if start < 9000 { told(start, true) } else { told(start * 7919 % 1000, false) }) == expected);
    assert!(run(&|start| if start == 0 { told(0, false) } else { Transport::default() }) == expected);
    assert!(run(&|_| Transport::default()) == run(&|start| Transport { playing: true, position: Some(start as i64) }));
    // A start of playback where the counter already is changes nothing; elsewhere it does.
    assert!(run(&|start| told(start, start > 9000)) == expected);
    assert!(run(&|start| if start < 9000 { told(start, false) } else { told(start + 100, true) }) != expected);
}

#[test]
fn reset_equals_fresh_and_two_runs_are_identical() {
    let mut random = Random::new(5);
    let input = channels(5, 2, 20_000);
    let events =
        [first(any_controls(&mut random)), Event { at: 9000, controls: any_controls(&mut random), jump: Some(5) }];
    for dynamics in MODES {
        let mut used = chain(RATE_HZ, STEREO, dynamics);
        play(&mut used, &input, &input[..1], 2, &events, 31, || 100);
        used.reset();
        let again = play(&mut used, &input, &input[..1], 2, &events, 31, || 100);
        let fresh = play(&mut chain(RATE_HZ, STEREO, dynamics), &input, &input[..1], 2, &events, 31, || 100);
        assert!(again == fresh, "{dynamics:?}");
    }
}

#[test]
fn latency_measured_is_latency_reported() {
    for rate_hz in [44_100.0, 48_000.0, 88_200.0, 96_000.0, 192_000.0] {
        let channels = Channels { input: 1, sidechain: 0, output: 1 };
        let mut chain = chain(rate_hz, channels, Dynamics::Paper);
        let at = 3000;
        let mut input = vec![vec![0.0f32; 40_000]];
        input[0][at] = 1.0;
        let mut controls =
            Controls { mix: MixControls { extension: 0.0, texture: 0.0, ..MixControls::default() }, ..plain() };
        controls.drive.high_pass_hz = 0.0;
        let largest = |x: &[f32]| (0..x.len()).max_by(|a, b| x[*a].abs().total_cmp(&x[*b].abs())).unwrap();
        let low = play(&mut chain, &input, &[], 1, &[first(controls)], 0, || 64);
        assert_eq!(largest(&low[0]) - at, chain.latency_samples(), "low at {rate_hz}");
        chain.reset();
        controls.mix.bypass = true;
        let dry = play(&mut chain, &input, &[], 1, &[first(controls)], 0, || 64);
        let expected: Vec<f32> =
            (0..40_000).map(|i| if i == at + chain.latency_samples() { 1.0 } else { 0.0 }).collect();
        assert!(dry[0] == expected, "bypass at {rate_hz}");
    }
}

#[test]
fn texture_through_the_chain_is_the_offline_run() {
    // The reference's padding fed from reset on, gate off, distribution learned, exact search.
    let structure = Structure::default();
    let shape = Shape::default();
    let input: Vec<f32> = channels(6, 1, 20_000).remove(0);
    let wide: Vec<f64> = input.iter().map(|x| f64::from(*x)).collect();
    let dictionary = dictionary(RATE_HZ, &structure, 1);
    let whole = offline::synthesize(&wide, &dictionary, &offline::Options::default(), &|_| true).unwrap();

    let mut controls = Controls { mix: MixControls { low: 0.0, extension: 0.0, ..MixControls::default() }, ..plain() };
    controls.drive.high_pass_hz = 0.0;
    controls.texture = TextureControls {
        scaling_alpha: 1.0,
        dynamic_range: DynamicRange::Learned,
        gate: 0.0,
        quality: Quality::Exact,
        ..TextureControls::default()
    };
    let channels = Channels { input: 1, sidechain: 0, output: 1 };
    let mut chain = Chain::new(RATE_HZ, channels, &structure).unwrap();
    chain.swap_dictionary(Some(dictionary));
    let learned = learn(RATE_HZ, &structure, &controls, std::slice::from_ref(&input), &[]).unwrap();
    chain.swap_distribution(Some(Arc::new(learned)));
    let Padding { size, start, .. } = Padding::new(input.len(), shape.levels, "input").unwrap();
    let mut padded = vec![0.0f32; size[0] + chain.latency_samples()];
    padded[start[0]..start[0] + input.len()].copy_from_slice(&input);
    let out = play(&mut chain, &[padded], &[], 1, &[first(controls)], 0, || 64);
    let from = start[0] + chain.latency_samples();
    let expected: Vec<f32> = whole[0].iter().map(|x| *x as f32).collect();
    assert!(out[0][from..from + input.len()] == expected[..]);
}

#[test]
fn a_step_of_any_level_is_heard_at_its_own_sample() {
    let input = channels(7, 1, 30_000);
    let channels = Channels { input: 1, sidechain: 0, output: 1 };
    let loud = plain();
    let step = 12_345;
    for change in 0..4 {
        let mut quiet = loud;
        match change {
            0 => quiet.mix.low = 0.0,
            1 => quiet.mix.extension = 0.5,
            2 => quiet.mix.output = 0.1,
            _ => quiet.mix.bypass = true,
        }
        let mut chain = chain(RATE_HZ, channels, Dynamics::Paper);
        let before = play(&mut chain, &input, &[], 1, &[first(loud)], 0, || 1000);
        chain.reset();
        let events = [first(loud), Event { at: step, controls: quiet, jump: None }];
        let after = play(&mut chain, &input, &[], 1, &events, 0, || 1000);
        let heard = (0..30_000).find(|i| before[0][*i] != after[0][*i]).unwrap();
        let due = step + chain.latency_samples();
        assert!((due..due + 4).contains(&heard), "change {change}: {heard}, due {due}");
    }
}

#[test]
fn a_step_of_alpha_or_scaling_is_heard_within_a_window() {
    let input = channels(8, 1, 30_000);
    let channels = Channels { input: 1, sidechain: 0, output: 1 };
    let step = 12_345usize;
    for (what, window) in [("alpha", 500), ("scaling_alpha", 128)] {
        let before_step = plain();
        let mut after_step = before_step;
        match what {
            "alpha" => after_step.extend.alpha = 4.0,
            _ => after_step.texture.scaling_alpha = 0.0,
        }
        let mut controls = [before_step, after_step];
        for controls in &mut controls {
            controls.mix.extension = if what == "alpha" { 1.0 } else { 0.0 };
            controls.mix.texture = 1.0 - controls.mix.extension;
            controls.mix.low = 0.0;
        }
        let mut chain = chain(RATE_HZ, channels, Dynamics::Paper);
        let straight = play(&mut chain, &input, &[], 1, &[first(controls[0])], 0, || 1000);
        chain.reset();
        let events = [first(controls[0]), Event { at: step, controls: controls[1], jump: None }];
        let stepped = play(&mut chain, &input, &[], 1, &events, 0, || 1000);
        let due = step + chain.latency_samples();
        let size = straight[0].iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        let heard = (0..30_000).find(|i| (straight[0][*i] - stepped[0][*i]).abs() > 1e-3 * size).unwrap();
        assert!(heard.abs_diff(due) <= window + 150, "{what}: heard at {heard}, due at {due}");
    }
}

#[test]
fn bad_input_stays_finite_and_is_forgotten() {
    let channels_of = Channels { input: 1, sidechain: 1, output: 1 };
    let good = channels(9, 1, 120_000);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 1e-40];
    for (bad, dynamics) in bad.into_iter().flat_map(|bad| MODES.map(|dynamics| (bad, dynamics))) {
        let mut input = good.clone();
        input[0][20_000..20_500].fill(bad);
        input[0][30_000..].fill(0.0);
        let mut chain = chain(RATE_HZ, channels_of, dynamics);
        let mut controls = plain();
        controls.texture.gate = 1e-3;
        controls.mix.texture = 1.0;
        let out = play(&mut chain, &input, &input, 1, &[first(controls)], 0, || 777);
        assert!(out[0].iter().all(|x| x.is_finite()), "{dynamics:?}, {bad}");
        let quiet_from = 30_000 + chain.tail_samples().unwrap() + RATE_HZ as usize;
        assert!(out[0][quiet_from..].iter().all(|x| *x == 0.0), "{dynamics:?}, {bad}: still sounding");
        assert!(chain.is_silent(), "{dynamics:?}, {bad}");
    }
}

#[test]
fn bad_configurations_are_refused() {
    let structure = Structure::default();
    let stereo = STEREO;
    assert!(Chain::new(1000.0, stereo, &structure).is_err());
    assert!(Chain::new(f64::NAN, stereo, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { input: 0, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { output: 1, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { output: 9, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, stereo, &Structure { levels: 9, ..structure }).is_err());
    assert!(Chain::new(RATE_HZ, stereo, &Structure { falloff: f64::NAN, ..structure }).is_err());
    assert!(learn(RATE_HZ, &structure, &Controls::default(), &[vec![0.0; 20]], &[]).is_err());
}

#[test]
fn a_recording_of_another_rate_is_never_used() {
    let mut chain = Chain::new(48_000.0, STEREO, &Structure::default()).unwrap();
    let wrong = dictionary(44_100.0, &Structure::default(), 1);
    assert!(Arc::ptr_eq(&chain.swap_dictionary(Some(Arc::clone(&wrong))).unwrap(), &wrong));
    assert!(chain.take_meters().no_recording);
}
