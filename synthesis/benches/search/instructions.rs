//! One fixed second of sound, for an instruction counter.

use pyrophone_synthesis::texture::Dictionary;
use pyrophone_synthesis::texture::search::{Budget, Searcher};

use crate::pairs;
use crate::queries::{self, Query};

/// Searches of one second of sound: 4/44100 s at level 0, twice that at the next, and so on.
const PER_LEVEL: [usize; 5] = [11_025, 5_512, 2_756, 1_378, 689];

/// Half of the samples of input that are looked at.
const HALF_SAMPLES: usize = 44_100;

/// Replays the middle second of the first pair's run with the search named `search`.
pub fn run(search: &str) {
    let budget = match search {
        "exact" => Budget::Exact { eps: 0.0 },
        "bounded" => Budget::Bounded { candidates: 1024 },
        other => panic!("no search is called {other}; there are exact and bounded"),
    };
    let pairs = pairs::all();
    let pair = &pairs[0];
    let dictionary = pair.dictionary();
    // Enough around the second; a counter makes the whole input a matter of many minutes.
    let middle = pair.input.len() / 2;
    let around = &pair.input[middle.saturating_sub(HALF_SAMPLES)..pair.input.len().min(middle + HALF_SAMPLES)];
    let all = queries::of(around, &pair.training, &dictionary);
    let mut second = Vec::new();
    for (level, count) in PER_LEVEL.into_iter().enumerate() {
        let of_level: Vec<&Query> = all.iter().filter(|query| query.level == level).collect();
        let from = of_level.len().saturating_sub(count) / 2;
        second.extend(of_level.into_iter().skip(from).take(count));
    }
    println!("{} {}", pair.name, second.len());
    counted_second(&dictionary, &second, &mut Searcher::new(), budget);
}

/// What is counted: callgrind finds it by its name.
#[inline(never)]
fn counted_second(dictionary: &Dictionary, queries: &[&Query], searcher: &mut Searcher, budget: Budget) {
    for query in queries {
        let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
        std::hint::black_box(searcher.nearest(index, &features, &query.feature, query.hint, budget));
    }
}
