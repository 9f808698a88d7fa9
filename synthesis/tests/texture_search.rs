//! The search against a plain scan of all windows, on data that makes searches err: equal windows,
//! near-ties, silence, constants, and queries from inside, outside and between.

#[path = "common/brute.rs"]
mod brute;
mod common;
#[path = "common/queries.rs"]
mod queries;
#[path = "common/signals.rs"]
mod signals;

use pyrophone_synthesis::controls::Quality;
use pyrophone_synthesis::texture::feature::Features;
use pyrophone_synthesis::texture::search::{Budget, Index, Searcher};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};
use rayon::prelude::*;
use signals::{Random, signal};

const KINDS: usize = 8;

/// Recordings of different difficulty.
fn recording(kind: usize, random: &mut Random) -> Vec<f64> {
    let samples = 3000 + random.below(9000);
    let mut noise = |level: f64| level * 2.0 * (random.unit() - 0.5);
    match kind {
        0 => (0..samples).map(|_| noise(1.0)).collect(),
        1 => vec![0.25; samples],
        2 => vec![0.0; samples],
        // A loop, sample for sample: every window has its equals.
        3 => {
            let period: Vec<f64> = (0..480).map(|_| noise(0.5)).collect();
            (0..samples).map(|i| period[i % period.len()]).collect()
        }
        // The same loop, each time off by what the last digits of a double hold.
        4 => {
            let period: Vec<f64> = (0..480).map(|_| noise(0.5)).collect();
            (0..samples).map(|i| period[i % period.len()] * (1.0 + 2e-16 * ((i / 480) % 3) as f64)).collect()
        }
        // Bursts in digital silence.
        5 => (0..samples).map(|i| if i % 2000 < 300 { noise(0.8) } else { 0.0 }).collect(),
        // Loudness from -180 dB to 0 dB.
        6 => (0..samples).map(|i| noise(10f64.powf(-9.0 * (i % 1500) as f64 / 1500.0))).collect(),
        // Few real dimensions.
        _ => (0..samples).map(|i| (i as f64 * 0.013).sin() * (i as f64 * 0.0007).cos() + noise(1e-4)).collect(),
    }
}

/// Queries: windows themselves, near them, half-way between two, far away, and nothing.
fn query(kind: usize, index: &Index, features: &Features<'_>, dimensions: usize, random: &mut Random) -> Vec<f64> {
    let windows = index.windows();
    let mut of_window = || {
        let mut feature = vec![0.0; dimensions];
        features.write(windows.start + random.below(windows.len()), &mut feature);
        feature
    };
    let (mut a, b) = (of_window(), of_window());
    match kind {
        0 => {}
        1 => a.iter_mut().for_each(|x| *x += 1e-3 * (random.unit() - 0.5)),
        2 => a.iter_mut().for_each(|x| *x += 1e-15 * (random.unit() - 0.5)),
        3 => a.iter_mut().zip(&b).for_each(|(a, b)| *a = 0.5 * (*a + b)),
        4 => a.iter_mut().for_each(|x| *x = 1000.0 * (*x + random.unit() - 0.5)),
        5 => a.fill(0.0),
        6 => a.iter_mut().for_each(|x| *x *= 1e-7),
        _ => a.iter_mut().for_each(|x| *x = 2.0 * random.unit() - 1.0),
    }
    a
}

fn scan(index: &Index, features: &Features<'_>, query: &[f64]) -> (usize, f64) {
    let mut nearest = (usize::MAX, f64::INFINITY);
    for window in index.windows() {
        let mut feature = vec![0.0; query.len()];
        features.write(window, &mut feature);
        let distance = feature.iter().zip(query).fold(0.0, |sum, (x, q)| sum + (x - q) * (x - q));
        if distance < nearest.1 {
            nearest = (window, distance);
        }
    }
    nearest
}

fn check(seed: u64) {
    let mut random = Random::new(seed);
    let kind = seed as usize % KINDS;
    let falloff = if random.below(4) == 0 { 0.1 } else { 0.0 };
    let shape = PyramidConfig { levels: 3, window: 2 + random.below(6), feature: 1 + random.below(5), falloff };
    let training = recording(kind, &mut random);
    let dictionary = Dictionary::new(&[training], 44_100.0, &shape, &|_| true).unwrap();
    let mut searchers = Searcher::every();
    let mut searched = 0;
    for level in 0..2 {
        let Some(index) = dictionary.index(level) else { continue };
        let features = dictionary.features(level);
        for i in 0..48 {
            let query = query(i % 8, index, &features, shape.feature_len(), &mut random);
            let expected = scan(index, &features, &query);
            let hint = (i % 3 > 0).then(|| index.windows().start + random.below(index.windows().len() + 5));
            let context = format!("seed {seed}, recording {kind}, level {level}, query {}, {shape:?}", i % 8);
            let mut first_path = None;
            for (path, searcher) in searchers.iter_mut().enumerate() {
                let exact = searcher.nearest(index, &features, &query, hint, Budget::Exact { eps: 0.0 });
                assert_eq!(exact.window, expected.0, "{context}, path {path}");
                let mut answers = vec![exact];
                for candidates in [Budget::LEAST, 256, 1024, 4096] {
                    let found = searcher.nearest(index, &features, &query, hint, Budget::Bounded { candidates });
                    assert!(found.compared <= candidates, "{context}: {} of {candidates}", found.compared);
                    assert!(index.windows().contains(&found.window), "{context}");
                    assert!(features.distance(found.window, &query) >= expected.1, "{context}");
                    answers.push(found);
                }
                // What a budget allows to be found depends on the way there: it is the same with any arithmetic.
                let first = first_path.get_or_insert_with(|| answers.clone());
                assert_eq!(*first, answers, "{context}, path {path}");
            }
            searched += 1;
        }
    }
    assert!(searched > 0, "seed {seed}: nothing searched");
}

#[test]
fn every_path_finds_what_a_scan_finds() {
    assert!(!Searcher::every().is_empty());
    (0..64).into_par_iter().for_each(check);
}

#[test]
fn a_bounded_search_with_room_enough_is_exact() {
    let mut random = Random::new(3);
    let training = signal(&mut random, 0, 20_000);
    let dictionary = Dictionary::new(&[training], 44_100.0, &PyramidConfig::default(), &|_| true).unwrap();
    let (index, features) = (dictionary.index(2).unwrap(), dictionary.features(2));
    let mut searcher = Searcher::new();
    for i in 0..200 {
        let query = query(i % 8, index, &features, 46, &mut random);
        let exact = searcher.nearest(index, &features, &query, None, Budget::Exact { eps: 0.0 });
        // All windows of this level, all boxes, and each window once more in full.
        let all = Budget::Bounded { candidates: 1 << 18 };
        let bounded = searcher.nearest(index, &features, &query, None, all);
        assert_eq!(bounded.window, exact.window);
    }
}

#[test]
fn the_default_budget_is_close_to_exact_on_the_reference() {
    let Some(folder) = common::reference_dir() else { return };
    let Quality::Bounded { candidates } = Quality::default() else { panic!("the default is exact") };
    let check = |name: &str| {
        let read = |kind: &str| common::read_wav(&folder.join(kind).join(format!("{name}.wav"))).0.remove(0);
        let training = read("training");
        let dictionary =
            Dictionary::new(std::slice::from_ref(&training), 44_100.0, &PyramidConfig::default(), &|_| true);
        let dictionary = dictionary.unwrap();
        let queries = queries::queries_of(&read("signals"), &training, &dictionary);
        let mut searcher = Searcher::new();
        let mut ratios = Vec::new();
        let (mut found_sum, mut exact_sum) = (0.0, 0.0);
        for query in &queries {
            let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
            let mut distance = |budget| {
                let answer = searcher.nearest(index, &features, &query.feature, query.hint, budget);
                features.distance(answer.window, &query.feature).sqrt()
            };
            let exact = distance(Budget::Exact { eps: 0.0 });
            let found = distance(Budget::Bounded { candidates });
            found_sum += found;
            exact_sum += exact;
            if exact > 0.0 {
                ratios.push(found / exact);
            }
        }
        assert!(ratios.len() > 50_000, "{name}: only {} queries", ratios.len());
        ratios.sort_by(f64::total_cmp);
        let (mean, percentile) = (found_sum / exact_sum, ratios[ratios.len() * 99 / 100]);
        println!("{name}: mean distance found / exact {mean:.5}, 99th percentile {percentile:.5}");
        assert!((1.0..=1.02).contains(&mean), "{name}: mean {mean}");
        assert!(percentile <= 1.3, "{name}: 99th percentile {percentile}");
    };
    ["burning_brick", "dragon", "torch"].into_par_iter().for_each(check);
}

#[test]
fn the_index_does_not_depend_on_the_number_of_threads() {
    let mut random = Random::new(11);
    let training = signal(&mut random, 1, 60_000);
    let build = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            Dictionary::new(std::slice::from_ref(&training), 44_100.0, &PyramidConfig::default(), &|_| true).unwrap()
        })
    };
    let (one, four) = (build(1), build(4));
    let mut searcher = Searcher::new();
    for level in 0..5 {
        for i in 0..100 {
            let query = query(i % 8, one.index(level).unwrap(), &one.features(level), 46, &mut random);
            let budget = Budget::Bounded { candidates: 256 };
            let mut answer = |dictionary: &Dictionary| {
                let (index, features) = (dictionary.index(level).unwrap(), dictionary.features(level));
                searcher.nearest(index, &features, &query, None, budget)
            };
            assert_eq!(answer(&one), answer(&four), "level {level}");
        }
    }
}

#[test]
fn a_dictionary_that_was_kept_comes_back_whole() {
    // Long enough for arrays whose memory is asked for in one go.
    let samples: Vec<f64> = signal(&mut Random::new(31), 1, 560_000);
    let shape = PyramidConfig::default();
    let made = Dictionary::new(&[samples], 44_100.0, &shape, &|_| true).unwrap();
    let mut bytes = Vec::new();
    made.write_to(&mut bytes).unwrap();
    let read = Dictionary::read_from(&mut bytes.as_slice(), bytes.len() as u64).unwrap();
    let mut again = Vec::new();
    read.write_to(&mut again).unwrap();
    assert!(again == bytes, "what is read is what was written");
    for len in [0, 7, 100, bytes.len() / 2, bytes.len() - 1] {
        assert!(Dictionary::read_from(&mut &bytes[..len], len as u64).is_err(), "{len} bytes");
    }
}
