//! The streaming texture engine: equal to the whole-signal run, whatever the blocks; gate, reset,
//! channels, odd input.

use std::sync::Arc;

use crate::signals::{Random, signal};
use pyrophone_synthesis::controls::{DynamicRange, Quality, TextureControls};
use pyrophone_synthesis::texture::pyramid::Pyramid;
use pyrophone_synthesis::texture::{Dictionary, Distribution, PyramidConfig, Texture, offline};

const RATE_HZ: f64 = 44_100.0;

fn dictionary(shape: &PyramidConfig, channels: usize, samples: usize) -> Arc<Dictionary> {
    let mut random = Random::new(11);
    let recording: Vec<Vec<f64>> = (0..channels).map(|_| signal(&mut random, 1, samples)).collect();
    Arc::new(Dictionary::new(&recording, RATE_HZ, shape, &|_| true).unwrap())
}

fn engine(shape: &PyramidConfig, dictionary: &Arc<Dictionary>, outputs: usize) -> Texture {
    let mut engine = Texture::new(shape, outputs, RATE_HZ).unwrap();
    engine.swap_dictionary(Some(Arc::clone(dictionary)));
    engine
}

/// How a run is cut into blocks.
#[derive(Debug, Clone, Copy)]
enum Cut {
    Every(usize),
    Random(u64),
}

fn run(engine: &mut Texture, drive: &[f64], controls: &TextureControls, outputs: usize, cut: Cut) -> Vec<Vec<f64>> {
    let mut random = Random::new(match cut {
        Cut::Random(seed) => seed,
        Cut::Every(_) => 0,
    });
    let mut out = vec![vec![0.0; drive.len()]; outputs];
    let mut start = 0;
    while start < drive.len() {
        let block = match cut {
            Cut::Every(block) => block,
            Cut::Random(_) => random.below(3000),
        };
        let end = drive.len().min(start + block);
        let mut blocks: Vec<&mut [f64]> = out.iter_mut().map(|x| &mut x[start..end]).collect();
        engine.process(&drive[start..end], None, controls, &mut blocks);
        start = end;
    }
    out
}

const CUTS: [Cut; 8] = [
    Cut::Every(1),
    Cut::Every(17),
    Cut::Every(64),
    Cut::Every(480),
    Cut::Every(1024),
    Cut::Every(4096),
    Cut::Random(1),
    Cut::Random(2),
];

fn shapes() -> Vec<PyramidConfig> {
    let shape = |levels, window, feature, falloff| PyramidConfig { levels, window, feature, falloff };
    vec![shape(6, 4, 3, 0.0), shape(4, 3, 2, 0.1), shape(5, 7, 1, 0.0), shape(3, 2, 6, 0.3), shape(7, 5, 2, 0.0)]
}

#[test]
fn padded_stream_equals_the_whole_signal_run() {
    for shape in shapes() {
        let dictionary = dictionary(&shape, 1, 15_000);
        // Long enough a padding for the look-ahead: the array is the next power of two.
        let input = signal(&mut Random::new(5), 0, 18_000);
        let options = offline::Options { scaling_alpha: 0.7, ..offline::Options::default() };
        let whole = offline::synthesize(&input, &dictionary, &options, &|_| true).unwrap();
        let pyramid = Pyramid::of_input(&input, &shape).unwrap();
        let latency = shape.latency_samples();
        assert!(pyramid.padding.start[0] > latency, "{shape:?}: padding too short for this test");
        let controls = TextureControls {
            scaling_alpha: 0.7,
            dynamic_range: DynamicRange::Learned,
            gate: 0.0,
            quality: Quality::Exact,
            ..TextureControls::default()
        };
        let mut padded = pyramid.levels[0].clone();
        padded.resize(padded.len() + latency, 0.0);
        let mut engine = engine(&shape, &dictionary, 1);
        engine.swap_distribution(Some(Arc::new(Distribution::from_magnitudes(pyramid.top_magnitudes()))));
        let first = pyramid.padding.start[0] + latency;
        for (i, cut) in CUTS.into_iter().enumerate() {
            // A start anywhere on the grid of windows is the same.
            engine.reset(i as i64 * shape.period_samples() as i64 * 1000);
            let out = run(&mut engine, &padded, &controls, 1, cut);
            assert_eq!(out[0][first..first + input.len()], whole[0][..], "{shape:?} {cut:?}");
        }
    }
}

#[test]
fn blocks_never_matter_whatever_the_controls() {
    let shape = PyramidConfig::default();
    let dictionary = dictionary(&shape, 2, 30_000);
    let mut drive = signal(&mut Random::new(6), 6, 30_000);
    drive.resize(40_000, 0.0);
    for quality in [Quality::Exact, Quality::Bounded { candidates: 128 }] {
        for dynamic_range in [DynamicRange::Off, DynamicRange::Running] {
            let controls = TextureControls {
                scaling_alpha: 0.5,
                dynamic_range,
                gate: 1e-4,
                quality,
                ..TextureControls::default()
            };
            let mut engine = engine(&shape, &dictionary, 2);
            engine.reset(-12_345);
            let expected = run(&mut engine, &drive, &controls, 2, Cut::Every(40_000));
            assert!(expected[0].iter().any(|x| x.abs() > 0.01) && expected[0] != expected[1]);
            for cut in CUTS {
                engine.reset(-12_345);
                assert_eq!(run(&mut engine, &drive, &controls, 2, cut), expected, "{controls:?} {cut:?}");
            }
            let mut fresh = self::engine(&shape, &dictionary, 2);
            fresh.reset(-12_345);
            assert_eq!(run(&mut fresh, &drive, &controls, 2, Cut::Every(512)), expected, "fresh, {controls:?}");
        }
    }
}

#[test]
fn output_depends_on_no_input_beyond_the_latency() {
    for shape in shapes() {
        let dictionary = dictionary(&shape, 1, 15_000);
        let drive = signal(&mut Random::new(8), 0, 12_000);
        let controls = TextureControls {
            gate: 0.0,
            quality: Quality::Exact,
            dynamic_range: DynamicRange::Off,
            ..TextureControls::default()
        };
        let whole = run(&mut engine(&shape, &dictionary, 1), &drive, &controls, 1, Cut::Every(500));
        let mut changed = drive.clone();
        changed[8000..].iter_mut().for_each(|x| *x = 0.3 - *x);
        let other = run(&mut engine(&shape, &dictionary, 1), &changed, &controls, 1, Cut::Every(500));
        // Output index n + latency is sample n: causal by construction, so equal up to 8000.
        assert_eq!(whole[0][..8000], other[0][..8000], "{shape:?}");
        assert_ne!(whole[0][8000..], other[0][8000..], "{shape:?}");
    }
}

#[test]
fn silence_is_silent_and_after_it_two_renders_agree() {
    let shape = PyramidConfig::default();
    let dictionary = dictionary(&shape, 1, 30_000);
    let controls = TextureControls {
        gate: 1e-4,
        quality: Quality::Exact,
        dynamic_range: DynamicRange::Off,
        ..TextureControls::default()
    };
    let burst = signal(&mut Random::new(9), 2, 6_000);
    let mut long = signal(&mut Random::new(10), 2, 9_000);
    let silence = 12_000;
    long.resize(9_000 + silence, 0.0);
    let second = long.len() as i64;
    long.extend(&burst);
    long.resize(long.len() + 12_000, 0.0);
    let out = run(&mut engine(&shape, &dictionary, 1), &long, &controls, 1, Cut::Every(64));

    let mut texture = engine(&shape, &dictionary, 1);
    let tail = texture.latency_samples() + texture.tail_samples();
    let gap = 9_000 + tail..second as usize + texture.latency_samples() - 2000;
    assert!(gap.len() > 1000 && out[0][gap].iter().all(|x| *x == 0.0), "not silent in the gap");
    assert!(out[0][second as usize + 6_000 + tail..].iter().all(|x| *x == 0.0), "not silent at the end");

    // Alone, started somewhere in that silence.
    let lead = 5_000;
    texture.reset(second - lead);
    let mut alone = vec![0.0; lead as usize];
    alone.extend(&burst);
    alone.resize(alone.len() + 12_000, 0.0);
    let again = run(&mut texture, &alone, &controls, 1, Cut::Every(333));
    assert_eq!(out[0][(second - lead) as usize + tail..], again[0][tail..]);
    assert!(again[0].iter().any(|x| x.abs() > 0.01));
}

#[test]
fn a_recording_of_another_shape_is_handed_back() {
    let wrong = dictionary(&PyramidConfig { levels: 5, ..PyramidConfig::default() }, 1, 10_000);
    let right = dictionary(&PyramidConfig::default(), 1, 10_000);
    let mut texture = engine(&PyramidConfig::default(), &right, 1);
    let back = texture.swap_dictionary(Some(Arc::clone(&wrong))).unwrap();
    assert!(Arc::ptr_eq(&back, &wrong));
    let old = texture.swap_dictionary(None).unwrap();
    assert!(Arc::ptr_eq(&old, &right));
}

#[test]
fn matches_report_their_position_in_the_recording() {
    let shape = PyramidConfig { levels: 5, window: 4, feature: 3, falloff: 0.0 };
    let recording = signal(&mut Random::new(11), 1, 40_000);
    let dictionary = Arc::new(Dictionary::new(std::slice::from_ref(&recording), RATE_HZ, &shape, &|_| true).unwrap());
    let mut engine = engine(&shape, &dictionary, 1);
    let controls = TextureControls {
        dynamic_range: DynamicRange::Off,
        gate: 0.0,
        quality: Quality::Exact,
        ..TextureControls::default()
    };
    // A recording that is driven by a part of itself is found where that part is.
    let from = 8000;
    let mut silent = vec![0.0; 2000];
    let (mut places, mut swings) = (vec![], vec![]);
    for drive in recording[from..from + 24_000].chunks(2000) {
        engine.process(drive, None, &controls, &mut [&mut silent]);
        let (matches, extents) = engine.take_traces();
        places.extend(matches);
        swings.extend(extents);
    }
    let step = (shape.window << (shape.levels - 2)) as f64;
    assert!(places.len() as f64 > 22_000.0 / step, "{} matches", places.len());
    let off = |(index, found): (usize, &pyrophone_synthesis::texture::Match)| {
        (f64::from(found.place_s) * RATE_HZ - (from as f64 + step * index as f64)) / step
    };
    let near = places.iter().enumerate().map(off).filter(|off| off.abs() < 1.5).count();
    assert!(near * 10 > places.len() * 9, "{near} of {} matches are where they should be", places.len());
    assert!(places.iter().all(|found| found.factor == 1.0 && found.magnitude >= 0.0));
    for level in 0..shape.levels {
        let here = swings.iter().filter(|extent| usize::from(extent.level) == level);
        // From the first window whose context has sound on, every sixtieth of a second swings both ways.
        let sounding = here.clone().filter(|extent| extent.low < 0.0 && extent.high > 0.0).count();
        assert!(
            sounding + 2 >= here.count() && sounding as f64 > 22_000.0 / RATE_HZ * 60.0 - 6.0,
            "{level}: {sounding}"
        );
    }
    let (matches, extents) = engine.take_traces();
    assert_eq!((matches.count(), extents.count()), (0, 0), "they are taken once");
}

#[test]
fn scaling_that_yields_to_a_buzz_knows_no_blocks_and_no_past() {
    let shape = PyramidConfig::default();
    let hop = shape.period_samples() / 2;
    // What repeats with the hops repeats so in all that is made of it.
    let tile = signal(&mut Random::new(12), 1, 3 * hop);
    let recording: Vec<f64> = (0..30_000).map(|i| tile[i % tile.len()]).collect();
    let dictionary = Arc::new(Dictionary::new(&[recording], RATE_HZ, &shape, &|_| true).unwrap());
    let drive = signal(&mut Random::new(13), 1, 60_000);
    let auto = TextureControls {
        scaling_auto: true,
        gate: 0.0,
        quality: Quality::Bounded { candidates: 64 },
        ..TextureControls::default()
    };
    let by_hand = TextureControls { scaling_auto: false, ..auto };
    let play = |engine: &mut Texture, cut: Cut| {
        let mut out = run(engine, &drive, &auto, 1, cut).remove(0);
        let lowered = engine.scaling_alpha();
        out.extend(run(engine, &drive[..20_000], &by_hand, 1, cut).remove(0));
        out.extend(run(engine, &drive[..20_000], &auto, 1, cut).remove(0));
        (out, lowered, engine.scaling_alpha())
    };
    let mut engine = engine(&shape, &dictionary, 1);
    engine.reset(77);
    let expected = play(&mut engine, Cut::Every(60_000));
    assert!(expected.1 < 0.5, "scaling alpha is {}", expected.1);
    assert!(expected.2 > expected.1 && expected.2 < 1.0, "it begins anew: {}", expected.2);
    for cut in CUTS {
        engine.reset(77);
        assert!(play(&mut engine, cut) == expected, "{cut:?}");
    }
    let mut fresh = self::engine(&shape, &dictionary, 1);
    fresh.reset(77);
    assert!(play(&mut fresh, Cut::Every(512)) == expected, "fresh");
    fresh.reset(77);
    assert!(run(&mut fresh, &drive, &by_hand, 1, Cut::Every(512))[0] != expected.0[..60_000]);
    assert_eq!(fresh.scaling_alpha(), 1.0);
}
