//! The searches that texture synthesis does for an input.

use pyrophone_synthesis::texture::Dictionary;
use pyrophone_synthesis::texture::search::{Budget, Searcher};

use crate::brute::{Match, Settings, synthesize_by};

/// A search.
pub struct Query {
    pub level: usize,
    pub feature: Vec<f64>,
    /// The window after the last match on its level.
    pub hint: Option<usize>,
}

/// The searches for `input` with exact answers, level by level, coarsest first; `dictionary` is
/// that of `training`.
pub fn queries_of(input: &[f64], training: &[f64], dictionary: &Dictionary) -> Vec<Query> {
    let shape = dictionary.shape();
    let settings = Settings {
        levels: shape.levels,
        window: shape.window,
        feature: shape.feature,
        falloff: shape.falloff,
        dynamic_range: true,
        scaling_alpha: 1.0,
    };
    let mut queries: Vec<Query> = Vec::new();
    let mut searcher = Searcher::new();
    let mut last = (usize::MAX, 0);
    synthesize_by(input, training, &settings, |Match { level, query, .. }| {
        let hint = (last.0 == level).then_some(last.1 + 1);
        let index = dictionary.index(level).expect("a level without windows");
        let answer = searcher.nearest(index, &dictionary.features(level), query, hint, Budget::Exact { eps: 0.0 });
        queries.push(Query { level, feature: query.to_vec(), hint });
        last = (level, answer.window);
        answer.window
    });
    queries
}
