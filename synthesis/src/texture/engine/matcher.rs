//! Working memory for matching windows.

use crate::texture::search::Searcher;
use crate::texture::shape::PyramidConfig;
use crate::texture::window_feature::WindowFeature;

/// Number of levels below the top with continuity: runs there remain varied on finer levels, where continuity had no
/// effect.
const CONTINUOUS_LEVELS: usize = 3;
/// Seconds after which a run ends in any case, so that the recording is not played back: without a limit, stretches of
/// 0.4 s were copied.
const LONGEST_RUN_S: f64 = 0.034;

/// The search for a window's match, and its working memory.
#[derive(Debug)]
pub struct Matcher {
    /// Weights of a window's samples.
    pub hat: Vec<f64>,
    /// Relative error allowed to an exact search.
    pub eps: f64,
    /// Working memory of the search.
    pub searcher: Searcher,
    /// Feature of the window that is to be matched.
    pub query: WindowFeature,
    /// Factors on the samples of the window that is added.
    pub window: Vec<f64>,
    /// Largest number of consecutive windows, by level, that may continue a run although another is nearer.
    pub longest_run: Vec<usize>,
    /// Number of windows and boxes compared since creation.
    pub compared: u64,
}

impl Matcher {
    /// A matcher for an engine of `shape`.
    pub fn new(shape: &PyramidConfig, sample_rate_hz: f64) -> Self {
        let longest_run = |level: usize| {
            let windows = (LONGEST_RUN_S * sample_rate_hz) as usize / (shape.window << level);
            if level + CONTINUOUS_LEVELS < shape.top() { 0 } else { windows }
        };
        Self {
            hat: shape.hat(),
            eps: 0.0,
            searcher: Searcher::new(),
            query: WindowFeature::new(shape),
            window: vec![0.0; shape.hat().len()],
            longest_run: (0..shape.top()).map(longest_run).collect(),
            compared: 0,
        }
    }
}
