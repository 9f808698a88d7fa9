//! The search on recordings of which part is noise floor: a query of silence is about equally far from all of it, so
//! what must not happen is that nearly every window is compared in full.

use crate::queries::Query;
use crate::signals::{Random, signal};
use pyrophone_synthesis::controls::Quality;
use pyrophone_synthesis::texture::search::{Budget, Searcher};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};
use rayon::prelude::*;

/// Most windows compared in full per query, on average.
const IN_FULL_MAX: f64 = 64.0;
const RATE_HZ: f64 = 44_100.0;
const SAMPLES: usize = 50_000;
/// Of so many queries one is also answered by a scan.
const SCANNED: usize = 97;

/// Bursts, and stretches in which there is nothing but white noise at `floors_db` relative to the bursts' peaks, in turn;
/// `share` of the recording is noise floor.
fn recording(floors_db: &[f64], share: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let bursts = signal(&mut random, 1, SAMPLES);
    let peak = bursts.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let stretch = SAMPLES / 8;
    (0..SAMPLES)
        .map(|i| {
            let floor = peak * 10f64.powf(floors_db[i / stretch % floors_db.len()] / 20.0);
            let is_quiet = ((i % stretch) as f64) < share * stretch as f64;
            let noise = floor * (2.0 * random.unit() - 1.0);
            f64::from((if is_quiet { noise } else { bursts[i] + noise }) as f32)
        })
        .collect()
}

/// A short burst in silence.
fn drive(seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    let burst = signal(&mut random, 0, 6_000);
    (0..24_000).map(|i| if (9_000..15_000).contains(&i) { burst[i - 9_000] } else { 0.0 }).collect()
}

struct Case {
    name: String,
    dictionary: Dictionary,
    queries: Vec<Query>,
}

fn case(floors_db: &[f64], share: f64, seed: u64) -> Case {
    let training = recording(floors_db, share, seed);
    let dictionary =
        Dictionary::new(std::slice::from_ref(&training), RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap();
    let queries = crate::queries::queries_of(&drive(seed), &training, &dictionary);
    Case { name: format!("floors {floors_db:?} dB, {share} of the recording"), dictionary, queries }
}

fn cases() -> Vec<(Vec<f64>, f64)> {
    let mut cases: Vec<(Vec<f64>, f64)> = Vec::new();
    for floor_db in [-40.0, -50.0, -60.0, -80.0, -100.0, -120.0] {
        cases.extend([0.1, 0.5, 0.9].map(|share| (vec![floor_db], share)));
    }
    cases.push((vec![-40.0, -60.0, -80.0, -120.0], 0.5));
    cases.push((vec![-57.0, -63.0], 0.7));
    cases.push((vec![0.0], 1.0));
    cases
}

#[test]
fn few_windows_are_compared_in_full_whatever_the_noise_floor() {
    let check = |(number, (floors_db, share)): (usize, (Vec<f64>, f64))| {
        let Case { name, dictionary, queries } = case(&floors_db, share, number as u64);
        let mut searcher = Searcher::new();
        let in_full: u64 = queries
            .iter()
            .map(|query| {
                let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
                let budget = Budget::Exact { eps: 0.0 };
                let answer = searcher.nearest(index, &features, &query.feature, query.hint, budget);
                u64::from(answer.compared_in_full)
            })
            .sum();
        let mean = in_full as f64 / queries.len() as f64;
        println!("{name}: {mean:.1} in full per query, {} queries", queries.len());
        assert!(queries.len() > 10_000, "{name}: only {} queries", queries.len());
        assert!(mean <= IN_FULL_MAX, "{name}: {mean} windows in full per query");
    };
    cases().into_iter().enumerate().par_bridge().for_each(check);
}

#[test]
fn the_nearest_is_found_in_any_noise_floor() {
    let check = |(number, (floors_db, share)): (usize, (Vec<f64>, f64))| {
        let Case { name, dictionary, queries } = case(&floors_db, share, number as u64);
        let mut searchers = Searcher::every();
        for query in queries.iter().step_by(SCANNED) {
            let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
            let distance = |window: usize| features.distance(window, &query.feature);
            let nearest = index.windows().min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap();
            for searcher in &mut searchers {
                let budget = Budget::Exact { eps: 0.0 };
                let answer = searcher.nearest(index, &features, &query.feature, query.hint, budget);
                assert_eq!(answer.window, nearest, "{name}, level {}", query.level);
            }
        }
    };
    cases().into_iter().enumerate().par_bridge().for_each(check);
}

#[test]
fn the_default_budget_is_close_to_exact_in_any_noise_floor() {
    let Quality::Bounded { candidates } = Quality::default() else { panic!("the default is not bounded") };
    let check = |(number, (floors_db, share)): (usize, (Vec<f64>, f64))| {
        let Case { name, dictionary, queries } = case(&floors_db, share, number as u64);
        let mut searcher = Searcher::new();
        let (mut found_sum, mut exact_sum, mut ratios) = (0.0, 0.0, Vec::new());
        for query in &queries {
            let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
            let mut distance = |budget| {
                let answer = searcher.nearest(index, &features, &query.feature, query.hint, budget);
                features.distance(answer.window, &query.feature).sqrt()
            };
            let (exact, found) = (distance(Budget::Exact { eps: 0.0 }), distance(Budget::Bounded { candidates }));
            found_sum += found;
            exact_sum += exact;
            if exact > 0.0 {
                ratios.push(found / exact);
            }
        }
        ratios.sort_by(f64::total_cmp);
        let (mean, percentile) = (found_sum / exact_sum, ratios[ratios.len() * 99 / 100]);
        println!("{name}: mean distance found / exact {mean:.5}, 99th percentile {percentile:.5}");
        assert!((1.0..=1.02).contains(&mean), "{name}: mean {mean}");
        assert!(percentile <= 1.3, "{name}: 99th percentile {percentile}");
    };
    cases().into_iter().enumerate().par_bridge().for_each(check);
}
