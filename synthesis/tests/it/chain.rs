//! The whole effect: blocks, reset, transport, automation, latency, bypass, bad input.

use std::sync::Arc;

use crate::effect::{Event, MODES, STEREO, any_controls, chain, channels, dictionary, play};
use crate::signals::Random;
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels, Transport, learn};
use pyrophone_synthesis::controls::{
    Controls, DriveMode, DynamicRange, Flow, MixControls, Quality, TextureControls, VortexControls,
};
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::{PyramidConfig, offline, shape::Padding};
use pyrophone_synthesis::vortex::{End, SpeedField};

const RATE_HZ: f64 = 44_100.0;

fn first(controls: Controls) -> Event {
    Event { at: 0, controls, jump: None }
}

/// All layers audible, nothing random.
fn plain() -> Controls {
    let texture = TextureControls { quality: Quality::Bounded { candidates: 128 }, ..TextureControls::default() };
    let vortex = VortexControls { level: 10.0, ..VortexControls::default() };
    Controls { texture, vortex, mix: MixControls { vortex: 1.0, ..MixControls::default() }, ..Controls::default() }
}

#[test]
fn blocks_never_matter_under_automation_and_jumps() {
    let samples = 40_000;
    let (input, sidechain) = (channels(1, 2, samples), channels(2, 1, samples));
    let seeds = if std::env::var("PYROPHONE_SOAK").as_deref() == Ok("1") { 40 } else { 2 };
    for (seed, dynamics) in (0..seeds).flat_map(|seed| MODES.map(|dynamics| (seed, dynamics))) {
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
    let (before, after) = (13_000, 26_000);
    let input = channels(3, 2, before + after);
    let jumps = [(777_777, None), (-5, None), (123, Some(900)), (4_000_000_000, Some(1))];
    for (number, (jump, again)) in jumps.into_iter().enumerate() {
        let dynamics = MODES[number % MODES.len()];
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
        let mut fresh = crate::effect::chain(RATE_HZ, STEREO, dynamics);
        let expected = play(&mut fresh, &rest, &[], 2, &[first(plain())], position, || 300);
        let settled = fresh.latency_samples() + 441;
        for channel in 0..2 {
            assert!(out[channel][from + settled..] == expected[channel][settled..], "jump to {jump}, then {again:?}");
        }
        // Until the jump comes out, nothing has changed.
        let mut straight = crate::effect::chain(RATE_HZ, STEREO, dynamics);
        let unjumped = play(&mut straight, &input, &[], 2, &[first(plain())], 99, || 512);
        let heard = before + straight.latency_samples();
        assert!(out[0][..heard] == unjumped[0][..heard]);
    }
}

#[test]
fn the_counter_runs_free_while_the_host_stops_or_is_silent_about_time() {
    let input = channels(4, 2, 30_000);
    let run = |transports: &dyn Fn(usize) -> Transport| {
        let mut chain = chain(RATE_HZ, STEREO, MatchingMode::Paper);
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
        let mut chain = chain(rate_hz, channels, MatchingMode::Paper);
        let at = 3000;
        let mut input = vec![vec![0.0f32; 40_000]];
        input[0][at] = 1.0;
        let mut controls =
            Controls { mix: MixControls { extension: 0.0, texture: 0.0, ..MixControls::default() }, ..plain() };
        controls.drive.high_pass_hz = 0.0;
        let largest = |x: &[f32]| (0..x.len()).max_by(|a, b| x[*a].abs().total_cmp(&x[*b].abs())).unwrap();
        let low = play(&mut chain, &input, &[], 1, &[first(controls)], 0, || 64);
        assert_eq!(largest(&low[0]) - at, chain.latency_samples(), "low at {rate_hz}");
        let known_before = pyrophone_synthesis::chain::latency_samples(rate_hz, &EngineConfig::default());
        assert_eq!(known_before, Ok(chain.latency_samples()), "{rate_hz}");
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
    let structure = EngineConfig::default();
    let shape = PyramidConfig::default();
    let input: Vec<f32> = channels(6, 1, 20_000).remove(0);
    let wide: Vec<f64> = input.iter().map(|x| f64::from(*x)).collect();
    let dictionary = dictionary(RATE_HZ, &structure, 1);
    let whole = offline::synthesize(&wide, dictionary.windows(), &offline::Options::default(), &|_| true).unwrap();

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
        let mut chain = chain(RATE_HZ, channels, MatchingMode::Paper);
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
    // A window of the level below the top is 64 samples to either side; windows of the next finer one, which read it up to a
    // feature's reach ahead, may be other ones too.
    let reach = PyramidConfig::default().reach() << 4;
    for (what, window) in [("alpha", 500), ("scaling_alpha", 64 + reach)] {
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
        let mut chain = chain(RATE_HZ, channels, MatchingMode::Paper);
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
    let structure = EngineConfig::default();
    let stereo = STEREO;
    assert!(Chain::new(1000.0, stereo, &structure).is_err());
    assert!(Chain::new(f64::NAN, stereo, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { input: 0, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { output: 1, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, Channels { output: 11, ..stereo }, &structure).is_err());
    assert!(Chain::new(RATE_HZ, stereo, &EngineConfig { levels: 9, ..structure }).is_err());
    assert!(Chain::new(RATE_HZ, stereo, &EngineConfig { falloff: f64::NAN, ..structure }).is_err());
    assert!(learn(RATE_HZ, &structure, &Controls::default(), &[vec![0.0; 20]], &[]).is_err());
}

#[test]
fn a_recording_of_another_rate_is_never_used() {
    let mut chain = Chain::new(48_000.0, STEREO, &EngineConfig::default()).unwrap();
    let wrong = dictionary(44_100.0, &EngineConfig::default(), 1);
    assert!(Arc::ptr_eq(&chain.swap_dictionary(Some(Arc::clone(&wrong))).unwrap(), &wrong));
    assert!(chain.take_meters().no_recording);
}

/// Vortex sound alone.
fn whoosh(flow: Flow) -> Controls {
    let mix = MixControls { low: 0.0, extension: 0.0, texture: 0.0, vortex: 1.0, ..MixControls::default() };
    let vortex = VortexControls { flow, level: 10.0, ..VortexControls::default() };
    let mut controls = Controls { mix, vortex, ..Controls::default() };
    controls.drive.high_pass_hz = 0.0;
    controls
}

#[test]
fn vortex_sound_is_as_late_as_the_rest_and_ends_with_its_tail() {
    let (at, end, samples) = (9_000, 20_000, 90_000);
    let mut input = channels(3, 2, samples);
    input.iter_mut().for_each(|channel| {
        channel[..at].fill(0.0);
        channel[at..end].iter_mut().for_each(|x| *x = x.signum() * x.abs().max(0.1));
        channel[end..].fill(0.0);
    });
    let mut chain = chain(RATE_HZ, STEREO, MatchingMode::Companded);
    let out = play(&mut chain, &input, &[], 2, &[first(whoosh(Flow::Envelope))], 0, || 480);
    let heard =
        |range: std::ops::Range<usize>| out.iter().any(|channel| channel[range.clone()].iter().any(|x| *x != 0.0));
    let start = at + chain.latency_samples();
    assert!(!heard(0..start), "it comes before its drive");
    assert!(heard(start..start + 200), "it comes later than a few hops");
    let tail = chain.tail_samples().unwrap();
    assert!(tail < samples - end, "{tail}");
    assert!(!heard(end + tail..samples) && heard(end + chain.latency_samples()..end + tail));
    assert!(chain.is_silent());
    // A layer that is off has no tail, whatever its release.
    let mut off = whoosh(Flow::Envelope);
    (off.mix.vortex, off.vortex.release_s, off.vortex.threshold) = (0.0, 5.0, 0.0);
    play(&mut chain, &input, &[], 2, &[first(off)], 0, || 480);
    assert!(chain.tail_samples().unwrap() < 40_000, "{:?}", chain.tail_samples());
}

#[test]
fn vortex_sound_follows_the_field_of_the_scene_that_burns_or_the_users_and_without_both_the_envelope() {
    let (samples, silence) = (40_000, vec![vec![0.0f32; 40_000]; 2]);
    let burning = |scene: usize| {
        let mut controls = whoosh(Flow::Field);
        (controls.drive.mode, controls.drive.flame.scene) = (DriveMode::Flame, scene);
        controls
    };
    let own = |speed: f32| {
        let field = SpeedField::new(30.0, 2, vec![[0.0; 3]; 2], vec![speed; 2], End::Clamped).unwrap();
        Some(Arc::new(field))
    };
    let run = |controls: Controls, field: Option<Arc<SpeedField>>| {
        let mut chain = chain(RATE_HZ, STEREO, MatchingMode::Companded);
        chain.swap_field(field);
        let out = play(&mut chain, &silence, &[], 2, &[first(controls)], 0, || 512);
        (out, chain.tail_samples(), chain.is_silent())
    };
    let sounds = |out: &[Vec<f32>]| out[0][samples / 2..].iter().any(|x| *x != 0.0);
    let (campfire, tail, is_silent) = run(burning(5), None);
    assert!(sounds(&campfire) && tail.is_none() && !is_silent);
    let (torch, ..) = run(burning(1), None);
    assert!(torch != campfire, "each scene has a field of its own");
    let (mine, tail, is_silent) = run(whoosh(Flow::Field), own(5.0));
    assert!(sounds(&mine) && tail.is_none() && !is_silent, "the user's needs neither input nor scene");
    let mut at_campfire = run(burning(5), own(5.0)).0;
    assert!(at_campfire == mine, "the user's goes before a scene's");
    let (nothing, tail, is_silent) = run(whoosh(Flow::Field), None);
    assert!(!sounds(&nothing) && tail.is_some() && is_silent);
    // With neither, it is the envelope's.
    let input = channels(8, 2, samples);
    let enveloped = |flow: Flow| {
        let mut chain = chain(RATE_HZ, STEREO, MatchingMode::Companded);
        play(&mut chain, &input, &[], 2, &[first(whoosh(flow))], 0, || 512)
    };
    at_campfire = enveloped(Flow::Field);
    assert!(at_campfire == enveloped(Flow::Envelope) && sounds(&at_campfire));
    // A fire that is out makes no wind.
    let mut out = burning(5);
    out.drive.flame.intensity = 0.0;
    assert!(!sounds(&run(out, None).0));
}

#[test]
fn an_exchange_of_fields_and_textures_gives_back_what_was_there_and_does_not_click() {
    let samples = 60_000;
    let silence = vec![vec![0.0f32; samples]; 2];
    let field = |speed: f32| {
        let places = (0..24).map(|n| [0.1 * n as f32, 0.0, 0.0]).collect();
        Arc::new(SpeedField::new(30.0, 24, places, vec![speed; 24], End::Clamped).unwrap())
    };
    let (slow, fast) = (field(5.0), field(6.0));
    let mut chain = chain(RATE_HZ, STEREO, MatchingMode::Companded);
    assert!(chain.swap_field(Some(slow.clone())).is_none());
    let part = |chain: &mut Chain, from: usize, to: usize, texture: usize| {
        let mut controls = whoosh(Flow::Field);
        controls.vortex.texture = texture;
        let input: Vec<Vec<f32>> = silence.iter().map(|x| x[from..to].to_vec()).collect();
        play(chain, &input, &[], 2, &[first(controls)], from as i64, || 333).swap_remove(0)
    };
    let mut heard = part(&mut chain, 0, 20_000, 0);
    let back = chain.swap_field(Some(fast.clone())).unwrap();
    assert!(Arc::ptr_eq(&back, &slow));
    heard.extend(part(&mut chain, 20_000, 40_000, 0));
    heard.extend(part(&mut chain, 40_000, 60_000, 1));
    let back = chain.swap_field(None).unwrap();
    assert!(Arc::ptr_eq(&back, &fast));
    drop(back);
    assert_eq!(Arc::strong_count(&fast), 1, "nothing is kept");
    let start = chain.latency_samples();
    let step =
        |range: std::ops::Range<usize>| heard[range].windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0f32, f32::max);
    let steady = step(start + 4_000..start + 19_000).max(step(start + 44_000..60_000));
    for at in [20_000, 40_000] {
        let change = step(start + at - 100..start + at + 1_000);
        assert!(change < 1.5 * steady, "{change} at {at}, else {steady}");
    }
}
