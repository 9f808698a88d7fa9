//! The neighbourhood by which a window is matched (§5.1): the samples before it on its own level, and those around it
//! on the next coarser one.

use super::shape::PyramidConfig;

/// Position of the two halves of a window's feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WindowPosition {
    /// First sample of the causal half, on the window's own level.
    pub causal: i64,
    /// First tap of the coarse half, on the next coarser level.
    pub coarse: i64,
    /// True if the coarse samples lie half-way between taps, so that the next one is needed too.
    pub between: bool,
}

impl WindowPosition {
    /// Position of the feature of window `window`.
    pub fn of_window(window: i64, shape: &PyramidConfig) -> Self {
        let centre = window * shape.window as i64;
        let reach = shape.reach() as i64;
        Self { causal: centre - reach, coarse: (centre >> 1) - reach, between: centre & 1 == 1 }
    }
}

/// A sample half-way between two taps.
#[inline(always)]
pub fn halfway(a: f64, b: f64) -> f64 {
    0.5 * a + 0.5 * b
}

/// Part of a level's array; nothing outside it is ever read.
#[derive(Debug, Clone, Copy)]
pub struct Excerpt<'a> {
    /// Its samples.
    pub samples: &'a [f64],
    /// Index of the first sample in the whole array.
    pub first: usize,
}

impl<'a> Excerpt<'a> {
    /// The samples from index `index` of the whole array on.
    #[inline(always)]
    pub fn from(&self, index: i64) -> &'a [f64] {
        &self.samples[index as usize - self.first..]
    }
}

/// A recording's windows on one level, as features that are read directly from the pyramid and need no memory of their
/// own.
#[derive(Debug, Clone, Copy)]
pub struct Features<'a> {
    /// The level.
    pub fine: Excerpt<'a>,
    /// The next coarser level.
    pub coarse: Excerpt<'a>,
    /// Weights of a feature's samples.
    pub weights: &'a [f64],
    /// True if all weights are 1.
    pub unweighted: bool,
    /// The common shape.
    pub shape: &'a PyramidConfig,
}

impl Features<'_> {
    /// Writes the feature of `window`, which must lie within both levels.
    pub fn write(&self, window: usize, out: &mut [f64]) {
        let position = WindowPosition::of_window(window as i64, self.shape);
        let (causal_len, coarse_len) = (self.shape.causal_len(), self.shape.coarse_len());
        let causal = &self.fine.from(position.causal)[..causal_len];
        let coarse = self.coarse.from(position.coarse);
        let (out_causal, out_coarse) = out.split_at_mut(causal_len);
        out_causal.copy_from_slice(causal);
        if position.between {
            for (out, taps) in out_coarse.iter_mut().zip(coarse.windows(2)) {
                *out = halfway(taps[0], taps[1]);
            }
        } else {
            out_coarse.copy_from_slice(&coarse[..coarse_len]);
        }
        if !self.unweighted {
            out.iter_mut().zip(self.weights).for_each(|(x, weight)| *x *= weight);
        }
    }

    /// True if two windows have the same feature.
    pub fn equal(&self, a: usize, b: usize) -> bool {
        let (a, b) = (WindowPosition::of_window(a as i64, self.shape), WindowPosition::of_window(b as i64, self.shape));
        let taps = self.shape.coarse_len() + usize::from(a.between);
        let causal = |at: WindowPosition| &self.fine.from(at.causal)[..self.shape.causal_len()];
        let coarse = |at: WindowPosition| &self.coarse.from(at.coarse)[..taps];
        a.between == b.between && causal(a) == causal(b) && coarse(a) == coarse(b)
    }

    /// The samples of `window`'s feature in place, without weights, if they need no interpolation.
    #[inline(always)]
    pub fn in_place(&self, window: usize) -> Option<[&[f64]; 2]> {
        let position = WindowPosition::of_window(window as i64, self.shape);
        (!position.between).then(|| {
            let causal = &self.fine.from(position.causal)[..self.shape.causal_len()];
            [causal, &self.coarse.from(position.coarse)[..self.shape.coarse_len()]]
        })
    }

    /// Squared distance of `window`'s feature to `query`, summed in order in double precision
    /// without fused operations, so that every machine and every search finds the same nearest.
    #[inline(always)]
    pub fn distance(&self, window: usize, query: &[f64]) -> f64 {
        let (query_causal, query_coarse) = query.split_at(self.shape.causal_len());
        let mut sum = 0.0;
        if let Some([causal, coarse]) = self.in_place(window).filter(|_| self.unweighted) {
            for (x, q) in causal.iter().zip(query_causal).chain(coarse.iter().zip(query_coarse)) {
                sum += (x - q) * (x - q);
            }
            return sum;
        }
        let position = WindowPosition::of_window(window as i64, self.shape);
        let causal = self.fine.from(position.causal);
        let coarse = self.coarse.from(position.coarse);
        let (weights_causal, weights_coarse) = self.weights.split_at(query_causal.len());
        for ((x, q), weight) in causal.iter().zip(query_causal).zip(weights_causal) {
            let x = x * weight;
            sum += (x - q) * (x - q);
        }
        for (i, (q, weight)) in query_coarse.iter().zip(weights_coarse).enumerate() {
            let x = if position.between { halfway(coarse[i], coarse[i + 1]) } else { coarse[i] };
            let x = x * weight;
            sum += (x - q) * (x - q);
        }
        sum
    }
}
