//! Recordings side by side: one gives way to another without a gap, two are blended, and nothing depends on blocks.

use std::sync::Arc;

use crate::effect::{Event, MODES, channels, play};
use pyrophone_synthesis::EngineConfig;
use pyrophone_synthesis::chain::{Chain, Channels};
use pyrophone_synthesis::controls::{Controls, MixControls, RecordingControls};
use pyrophone_synthesis::recording::RecordingDictionary;
use pyrophone_synthesis::structure::MatchingMode;
use pyrophone_synthesis::texture::PyramidConfig;

const RATE_HZ: f64 = 44_100.0;
const MONO: Channels = Channels { input: 1, sidechain: 0, output: 1 };
const SECONDS: usize = 3;
const SAMPLES: usize = SECONDS * RATE_HZ as usize;
const DARK: usize = 0;
const BRIGHT: usize = 2;

/// Noise below or above 1.5 kHz, at a level of its own.
fn recording(is_bright: bool, level: f64) -> Vec<f64> {
    let mut random = crate::signals::Random::new(if is_bright { 71 } else { 72 });
    let (mut first, mut second) = (0.0, 0.0);
    let keep = 1.0 - (-2.0 * std::f64::consts::PI * 1500.0 / RATE_HZ).exp();
    let next = |_| {
        let noise = 2.0 * random.unit() - 1.0;
        first += keep * (noise - first);
        second += keep * (first - second);
        level * if is_bright { noise - 2.0 * first + second } else { second }
    };
    (0..120_000).map(next).collect()
}

fn dictionary(dynamics: MatchingMode, is_bright: bool, level: f64) -> Arc<RecordingDictionary> {
    let structure = EngineConfig { dynamics, ..EngineConfig::default() };
    let shape = PyramidConfig::at_rate(&structure, RATE_HZ);
    let recording = [recording(is_bright, level)];
    Arc::new(RecordingDictionary::new(dynamics, &recording, RATE_HZ, &shape, &|_| true).expect("long enough"))
}

/// Both recordings, the bright one ten times as loud.
fn pair(dynamics: MatchingMode) -> [Arc<RecordingDictionary>; 2] {
    [dictionary(dynamics, false, 0.03), dictionary(dynamics, true, 0.3)]
}

fn chain(dynamics: MatchingMode, [dark, bright]: &[Arc<RecordingDictionary>; 2]) -> Chain {
    let mut chain = Chain::new(RATE_HZ, MONO, &EngineConfig { dynamics, ..EngineConfig::default() }).expect("a chain");
    chain.swap_slot(DARK, Some(Arc::clone(dark)));
    chain.swap_slot(BRIGHT, Some(Arc::clone(bright)));
    chain
}

fn texture_alone(recordings: RecordingControls) -> Controls {
    let mix = MixControls { low: 0.0, extension: 0.0, loudness_lufs: Some(-30.0), ..MixControls::default() };
    let mut controls = Controls { mix, ..Controls::default() };
    controls.texture.companding.low_end_hz = 0.0;
    controls.texture.recordings = recordings;
    controls
}

fn only(slot: usize) -> RecordingControls {
    RecordingControls { slot, ..RecordingControls::default() }
}

fn blended(blend: f64) -> RecordingControls {
    RecordingControls { slot: DARK, second: BRIGHT, blend }
}

/// What a steady drive makes with these controls from these samples on.
fn run(chain: &mut Chain, events: &[(usize, RecordingControls)], mut block: impl FnMut() -> usize) -> Vec<f32> {
    let events: Vec<Event> = events
        .iter()
        .map(|(at, recordings)| Event { at: *at, controls: texture_alone(*recordings), jump: None })
        .collect();
    chain.reset();
    play(chain, &channels(73, 1, SAMPLES), &[], 1, &events, 44_100, &mut block).remove(0)
}

/// Powers below and above 1.5 kHz.
fn powers(signal: &[f32]) -> [f64; 2] {
    let keep = 1.0 - (-2.0 * std::f64::consts::PI * 1500.0 / RATE_HZ).exp();
    let (mut first, mut second, mut sums) = (0.0, 0.0, [0.0; 2]);
    for x in signal.iter().map(|x| f64::from(*x)) {
        first += keep * (x - first);
        second += keep * (first - second);
        sums[0] += second * second;
        sums[1] += (x - 2.0 * first + second).powi(2);
    }
    sums.map(|sum| sum / signal.len() as f64)
}

fn db(power: f64) -> f64 {
    10.0 * power.max(1e-30).log10()
}

#[test]
fn a_recording_beside_others_sounds_as_it_does_alone() {
    for dynamics in MODES {
        let pair = pair(dynamics);
        let mut alone =
            Chain::new(RATE_HZ, MONO, &EngineConfig { dynamics, ..EngineConfig::default() }).expect("a chain");
        alone.swap_dictionary(Some(Arc::clone(&pair[0])));
        let expected = run(&mut alone, &[(0, only(DARK))], || 512);
        let mut both = chain(dynamics, &pair);
        assert!(run(&mut both, &[(0, only(DARK))], || 512) == expected, "{dynamics:?}: to the last bit");
        assert!(run(&mut both, &[(0, blended(0.0))], || 512) == expected, "{dynamics:?}: with none of the second");
        // The other one is matched on a scale that is not its own, and rounds differently.
        alone.swap_dictionary(Some(Arc::clone(&pair[1])));
        let [expected, found] =
            [run(&mut alone, &[(0, only(0))], || 512), run(&mut both, &[(0, only(BRIGHT))], || 512)]
                .map(|x| powers(&x));
        for (expected, found) in expected.into_iter().zip(found) {
            assert!((db(found) - db(expected)).abs() < 0.5, "{dynamics:?}: {expected} became {found}");
        }
    }
}

#[test]
fn nothing_depends_on_how_blocks_are_cut() {
    for dynamics in MODES {
        let mut chain = chain(dynamics, &pair(dynamics));
        let events = [
            (0, only(DARK)),
            (20_011, only(BRIGHT)),
            (40_507, blended(0.4)),
            (60_001, RecordingControls { slot: BRIGHT, second: DARK, blend: 0.7 }),
            (60_009, only(1)),
            (90_000, only(BRIGHT)),
        ];
        let whole = run(&mut chain, &events, || 4096);
        for cut in [1, 37, 480] {
            assert!(run(&mut chain, &events, || cut) == whole, "{dynamics:?}: blocks of {cut}");
        }
        let mut random = crate::signals::Random::new(5);
        assert!(run(&mut chain, &events, || 1 + random.below(900)) == whole, "{dynamics:?}: blocks of any length");
    }
}

#[test]
fn changing_the_slot_leaves_no_gap_and_no_click() {
    let at = 60_000;
    let pair = pair(MatchingMode::Companded);
    let mut chain = chain(MatchingMode::Companded, &pair);
    let [dark, bright] = [DARK, BRIGHT].map(|slot| run(&mut chain, &[(0, only(slot))], || 512));
    let changed = run(&mut chain, &[(0, only(DARK)), (at, only(BRIGHT))], || 512);
    let heard_at = at + chain.latency_samples();
    // A window belongs to its centre: the coarsest begin that much earlier.
    assert!(changed[..heard_at - 400] == dark[..heard_at - 400], "nothing is heard before its sample");
    let after = heard_at + 4000;
    let [low, high] = powers(&changed[after..]);
    let [expected_low, expected_high] = powers(&bright[after..]);
    assert!((db(high) - db(expected_high)).abs() < 1.0 && low < 2.0 * expected_low, "then the other alone is heard");
    // By the drive's own loudness: as loud as the softer of the two in every stretch of 5 ms.
    let piece = (0.005 * RATE_HZ) as usize;
    let level = |signal: &[f32], from: usize| {
        db(signal[from..from + piece].iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / piece as f64)
    };
    for from in (heard_at - piece..heard_at + 3000).step_by(piece) {
        let least = level(&dark, from).min(level(&bright, from));
        assert!(level(&changed, from) > least - 7.0, "a gap {} ms after the change", (from - heard_at) * 10 / 441);
    }
    let steepest = |signal: &[f32]| signal.windows(2).map(|x| (x[1] - x[0]).abs()).fold(0.0f32, f32::max);
    let part = heard_at - 500..heard_at + 4000;
    let (step, usual) = (steepest(&changed[part.clone()]), steepest(&bright[part.clone()]).max(steepest(&dark[part])));
    assert!(step < 1.3 * usual, "a step of {step}, where {usual} is usual");
}

#[test]
fn the_share_of_a_second_recording_is_heard_in_proportion() {
    for dynamics in MODES {
        let mut chain = chain(dynamics, &pair(dynamics));
        let mut share = |blend: f64| {
            let [low, high] = powers(&run(&mut chain, &[(0, blended(blend))], || 512)[20_000..]);
            (low, high)
        };
        let ((dark, none), (some, bright)) = (share(0.0), share(1.0));
        let mut last = 0.0;
        for blend in [0.1, 0.25, 0.5, 0.75, 0.9] {
            let (low, high) = share(blend);
            let found = (high - none) / (bright - none);
            println!(
                "{dynamics:?} {blend}: {found:.3} of the bright one, {:.3} of the dark one",
                (low - some) / (dark - some)
            );
            assert!(found > last, "{dynamics:?}: more of it is heard at {blend}");
            assert!((db(found) - db(blend)).abs() < 2.0, "{dynamics:?}: {found} of it is heard at {blend}");
            last = found;
        }
    }
}

#[test]
fn an_empty_slot_is_as_no_recording() {
    let mut chain = chain(MatchingMode::Companded, &pair(MatchingMode::Companded));
    let mut without =
        Chain::new(RATE_HZ, MONO, &EngineConfig { dynamics: MatchingMode::Companded, ..EngineConfig::default() })
            .expect("a chain");
    let found = run(&mut chain, &[(0, only(1))], || 512);
    let expected = run(&mut without, &[(0, only(1))], || 512);
    let largest = expected.iter().fold(0.0f32, |most, x| most.max(x.abs()));
    let error = found.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0f32, f32::max);
    assert!(largest > 1e-3 && error < 1e-6 * largest, "extension stands in: {error} of {largest}");
    let blend = RecordingControls { slot: DARK, second: 1, blend: 0.8 };
    let alone = run(&mut chain, &[(0, only(DARK))], || 512);
    assert!(run(&mut chain, &[(0, blend)], || 512) == alone, "an empty second slot has no share");
}

#[test]
fn a_passage_repeats_bit_for_bit() {
    let mut chain = chain(MatchingMode::Companded, &pair(MatchingMode::Companded));
    let events = [(0, blended(0.5)), (30_000, only(BRIGHT))];
    let first = run(&mut chain, &events, || 512);
    run(&mut chain, &[(0, only(BRIGHT))], || 333);
    assert!(run(&mut chain, &events, || 100) == first);
}
