//! Texture synthesis against a plain brute force, over random settings and signals.

use std::sync::Arc;

use crate::signals::{Random, signal};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig, offline};
use rayon::prelude::*;

const CASES: u64 = 64;

fn check(seed: u64) {
    let mut random = Random::new(seed);
    let settings = crate::brute::Settings {
        levels: 3 + random.below(6),
        window: 2 + random.below(15),
        feature: 1 + random.below(6),
        falloff: if random.below(2) == 0 { 0.0 } else { random.unit() * 0.5 },
        dynamic_range: random.below(2) == 0,
        scaling_alpha: random.unit(),
    };
    // Brute force compares every window of the input with every one of the recording's.
    let longest = if settings.window < 6 { 12_000.0 } else { 44_100.0f64 };
    let length = |random: &mut Random| (1000.0 * (longest / 1000.0).powf(random.unit())) as usize;
    let (input_len, training_len) = (length(&mut random), length(&mut random));
    let input = signal(&mut random, seed as usize, input_len);
    let training = signal(&mut random, (seed / 5) as usize, training_len);
    let context = format!("seed {seed}: {settings:?}, {input_len} samples under {training_len}");

    let expected = crate::brute::synthesize(&input, &training, &settings);
    let crate::brute::Settings { levels, window, feature, falloff, dynamic_range, scaling_alpha } = settings;
    let shape = PyramidConfig { levels, window, feature, falloff };
    let dictionary = Arc::new(Dictionary::new(&[training], 44_100.0, &shape, &|_| true).unwrap());
    let options = offline::Options { dynamic_range, scaling_alpha, eps: 0.0 };
    let output = offline::synthesize(&input, &dictionary, &options, &|_| true).unwrap();
    let differing = output[0].iter().zip(&expected).filter(|(a, b)| **a as f32 != **b as f32).count();
    assert_eq!((output[0].len(), differing), (expected.len(), 0), "{context}");
}

#[test]
fn random_settings_equal_brute_force() {
    (0..CASES).into_par_iter().for_each(check);
}

#[test]
fn a_search_with_eps_keeps_its_promise() {
    use pyrophone_synthesis::texture::search::{Budget, SearchResult, Searcher};
    let mut random = Random::new(7);
    let training = signal(&mut random, 0, 20_000);
    let dictionary = Dictionary::new(&[training], 44_100.0, &PyramidConfig::default(), &|_| true).unwrap();
    let mut searcher = Searcher::new();
    let mut saved = 0;
    for level in 0..5 {
        let (index, features) = (dictionary.index(level).unwrap(), dictionary.features(level));
        for _ in 0..100 {
            let query: Vec<f64> = (0..46).map(|_| 0.2 * (random.unit() - 0.5)).collect();
            let distance = |answer: &SearchResult| features.distance(answer.window, &query);
            let exact = searcher.nearest(index, &features, &query, None, Budget::Exact { eps: 0.0 });
            for eps in [0.1, 1.0, 5.0] {
                let found = searcher.nearest(index, &features, &query, None, Budget::Exact { eps });
                let bound = distance(&exact).sqrt() * (1.0 + eps);
                assert!(distance(&found).sqrt() <= bound * (1.0 + 1e-12), "level {level} eps {eps}");
                saved += exact.compared - found.compared;
            }
            let budget = Budget::LEAST;
            let bounded = searcher.nearest(index, &features, &query, None, Budget::Bounded { candidates: budget });
            assert!(bounded.compared <= budget, "{} compared", bounded.compared);
            assert!(distance(&bounded) >= distance(&exact));
        }
    }
    assert!(saved > 0, "eps never saved any work");
}
