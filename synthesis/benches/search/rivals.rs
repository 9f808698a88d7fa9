//! Searches side by side, on the searches that texture synthesis does.

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::{DMatrix, SymmetricEigen};
use pyrophone_synthesis::texture::Dictionary;
use pyrophone_synthesis::texture::search::{Budget, Searcher};

use crate::pairs::Pair;
use crate::queries::{self, Query};
use crate::{RATE_HZ, timed};

const DIMENSIONS: usize = 46;
/// Principal components given to the k-d tree.
const COMPONENTS: usize = 8;
/// Stride between the queries that slow searches process.
const SPARSE: usize = 101;

/// Times of searches.
struct Times {
    microseconds: Vec<f64>,
    /// Number of queries that each time represents.
    stands_for: usize,
}

impl Times {
    fn measure(queries: &[Query], every: usize, mut search: impl FnMut(&Query)) -> Self {
        let sampled = queries.iter().step_by(every);
        let mut microseconds: Vec<f64> = sampled.map(|query| timed(|| search(query)).1.as_secs_f64() * 1e6).collect();
        microseconds.sort_by(f64::total_cmp);
        Self { microseconds, stands_for: queries.len() }
    }

    fn print(&self, pair: &str, name: &str, seconds: f64) {
        let count = self.microseconds.len();
        let mean = self.microseconds.iter().sum::<f64>() / count as f64;
        let at = |q: f64| self.microseconds[((count - 1) as f64 * q) as usize];
        let cost = mean * 1e-6 * self.stands_for as f64 / seconds;
        println!("| {pair} | {name} | {cost:.4} | {:.2} | {:.1} | {:.1} |", at(0.5), at(0.999), at(1.0));
    }
}

/// Exact, bounded, the `kiddo` crate's k-d tree twice, and a scan.
pub fn table(pairs: &[Pair]) {
    println!("### Searches alone\n");
    println!(
        "The searches of one run, replayed with the search called by itself: all levels, each with its own index. Cost in \
         seconds of one core per second of sound; microseconds per query. The `kiddo` trees and the scan see every \
         {SPARSE}th query.\n"
    );
    println!("| pair | search | s per s | median, µs | 99.9 %, µs | largest, µs |");
    println!("|---|---|---|---|---|---|");
    for pair in pairs {
        let dictionary = pair.dictionary();
        let queries = queries::queries_of(&pair.input, &pair.training, &dictionary);
        let finest = queries.iter().filter(|query| query.level == 0).count();
        let seconds = (finest * dictionary.shape().window) as f64 / RATE_HZ;
        let mut searcher = Searcher::new();
        let mut ours = |budget: Budget| {
            Times::measure(&queries, 1, |query| {
                let (index, features) = (dictionary.index(query.level).unwrap(), dictionary.features(query.level));
                std::hint::black_box(searcher.nearest(index, &features, &query.feature, query.hint, budget));
            })
        };
        ours(Budget::Exact { eps: 0.0 }).print(&pair.name, "exact", seconds);
        ours(Budget::Bounded { candidates: 1024 }).print(&pair.name, "bounded, 1024", seconds);
        let levels: Vec<Rivals> = (0..dictionary.shape().top()).map(|level| Rivals::new(&dictionary, level)).collect();
        Times::measure(&queries, SPARSE, |query| levels[query.level].components(query)).print(
            &pair.name,
            "`kiddo`, 8 principal components, re-checked",
            seconds,
        );
        Times::measure(&queries, SPARSE, |query| levels[query.level].raw(query)).print(
            &pair.name,
            "`kiddo`, raw",
            seconds,
        );
        Times::measure(&queries, SPARSE, |query| levels[query.level].scan(query)).print(
            &pair.name,
            "brute force",
            seconds,
        );
    }
    println!();
}

/// A level's windows for other searches.
struct Rivals {
    features: Vec<[f64; DIMENSIONS]>,
    raw: ImmutableKdTree<f64, DIMENSIONS>,
    mean: Vec<f64>,
    axes: DMatrix<f64>,
    components: ImmutableKdTree<f64, COMPONENTS>,
}

impl Rivals {
    fn new(dictionary: &Dictionary, level: usize) -> Self {
        let (index, features) = (dictionary.index(level).unwrap(), dictionary.features(level));
        let features: Vec<[f64; DIMENSIONS]> = index
            .windows()
            .map(|window| {
                let mut feature = [0.0; DIMENSIONS];
                features.write(window, &mut feature);
                feature
            })
            .collect();
        let count = features.len() as f64;
        let mean: Vec<f64> = (0..DIMENSIONS).map(|d| features.iter().map(|x| x[d]).sum::<f64>() / count).collect();
        let mut covariance = DMatrix::<f64>::zeros(DIMENSIONS, DIMENSIONS);
        for feature in features.iter().step_by(7) {
            for i in 0..DIMENSIONS {
                for j in 0..DIMENSIONS {
                    covariance[(i, j)] += (feature[i] - mean[i]) * (feature[j] - mean[j]);
                }
            }
        }
        let eigen = SymmetricEigen::new(covariance);
        let mut order: Vec<usize> = (0..DIMENSIONS).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
        let axes = DMatrix::from_fn(COMPONENTS, DIMENSIONS, |axis, d| eigen.eigenvectors[(d, order[axis])]);
        let projected: Vec<[f64; COMPONENTS]> = features.iter().map(|x| project(&axes, &mean, x)).collect();
        Self {
            raw: ImmutableKdTree::new_from_slice(&features).unwrap(),
            components: ImmutableKdTree::new_from_slice(&projected).unwrap(),
            features,
            mean,
            axes,
        }
    }

    fn raw(&self, query: &Query) {
        let point: [f64; DIMENSIONS] = query.feature.as_slice().try_into().unwrap();
        std::hint::black_box(self.raw.query(&point).nearest_one::<SquaredEuclidean<f64>>().execute());
    }

    /// All windows that are as near in few components as the nearest window in few components is in full.
    fn components(&self, query: &Query) {
        let point = project(&self.axes, &self.mean, &query.feature);
        let nearest = self.components.query(&point).nearest_one::<SquaredEuclidean<f64>>().execute();
        let radius = distance(&self.features[nearest.item as usize], &query.feature) * (1.0 + 1e-9) + 1e-30;
        let candidates = self.components.query(&point).within::<SquaredEuclidean<f64>>(radius).unsorted().execute();
        let full = candidates.iter().map(|x| distance(&self.features[x.item as usize], &query.feature));
        std::hint::black_box(full.fold(f64::INFINITY, f64::min));
    }

    fn scan(&self, query: &Query) {
        let full = self.features.iter().map(|x| distance(x, &query.feature));
        std::hint::black_box(full.fold(f64::INFINITY, f64::min));
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum()
}

fn project(axes: &DMatrix<f64>, mean: &[f64], feature: &[f64]) -> [f64; COMPONENTS] {
    std::array::from_fn(|axis| (0..DIMENSIONS).map(|d| axes[(axis, d)] * (feature[d] - mean[d])).sum())
}
