//! Texture synthesis of files that are already decoded: indexing, matching and writing.

use std::sync::Arc;

use pyrophone_synthesis::texture::offline::{Options, synthesize};
use pyrophone_synthesis::texture::pyramid::Pyramid;
use pyrophone_synthesis::texture::search::{Budget, Searcher};
use pyrophone_synthesis::texture::{Dictionary, PyramidConfig};

use crate::pairs::Pair;
use crate::signals::{Random, signal};
use crate::{RATE_HZ, Row, cpu_s, row};

/// Level of the quiet recording's noise floor: -60 dB.
const FLOOR: f64 = 1e-3;

pub fn rows() -> Vec<Row> {
    vec![
        row("exact texture, whole program, CPU s per padded s", "0.045 each", |pairs| {
            let figures: Vec<String> =
                pairs.iter().map(|pair| format!("{} {:.3}", pair.name, exact(&pair.input, &pair.training))).collect();
            figures.join(", ")
        }),
        row("the same, a recording that is half noise floor, a drive padded with silence", "0.15", |_| {
            let pair = quiet();
            format!("{:.3}", exact(&pair.input, &pair.training))
        }),
        row("windows compared in full per query of silence in that recording", "64", |_| format!("{:.1}", in_full())),
    ]
}

fn exact(input: &[f64], training: &[f64]) -> f64 {
    let padded_s = Pyramid::of_input(input, &PyramidConfig::default()).unwrap().levels[0].len() as f64 / RATE_HZ;
    crate::shortest(|| {
        let begin = cpu_s();
        let training = vec![training.to_vec()];
        let dictionary = Arc::new(Dictionary::new(&training, RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap());
        synthesize(input, &dictionary, &Options::default(), &|_| true).unwrap();
        (cpu_s() - begin) / padded_s
    })
}

/// Half of the recording is white noise 60 dB below its bursts; more than half of the padded drive is silence.
fn quiet() -> Pair {
    let mut random = Random::new(21);
    let bursts = signal(&mut random, 1, 400_000);
    let peak = bursts.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let noise = |i: usize, random: &mut Random| {
        let noise = FLOOR * peak * (2.0 * random.unit() - 1.0);
        if (i / 50_000).is_multiple_of(2) { noise } else { bursts[i] + noise }
    };
    let training = (0..bursts.len()).map(|i| noise(i, &mut random)).collect();
    let mut input = vec![0.0; 60_000];
    input.extend(signal(&mut random, 0, 100_000));
    input.extend(vec![0.0; 60_000]);
    Pair { name: "quiet".to_owned(), input, training }
}

fn in_full() -> f64 {
    let training = quiet().training;
    let dictionary = Dictionary::new(&[training], RATE_HZ, &PyramidConfig::default(), &|_| true).unwrap();
    let (index, features) = (dictionary.index(0).unwrap(), dictionary.features(0));
    let mut searcher = Searcher::new();
    let mut random = Random::new(5);
    let mut feature = vec![0.0; dictionary.shape().feature_len()];
    let mut sum = 0;
    const QUERIES: usize = 2_000;
    for _ in 0..QUERIES {
        // Noise at the floor's own level, as silence is answered with.
        feature.iter_mut().for_each(|x| *x = FLOOR * 0.3 * (2.0 * random.unit() - 1.0));
        sum += searcher.nearest(index, &features, &feature, None, Budget::Exact { eps: 0.0 }).compared_in_full;
    }
    f64::from(sum) / QUERIES as f64
}
