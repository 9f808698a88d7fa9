//! The feature of the window that is to be matched.

use super::feature::{WindowPosition, halfway};
use super::shape::PyramidConfig;
use crate::dsp::Ring;

/// A feature as it is collected from the synthesized level (eq. 15) and the coarser one (eq. 16), and the samples needed
/// on the way.
#[derive(Debug)]
pub(super) struct WindowFeature {
    /// Weights by distance from the window.
    weights: Vec<f64>,
    /// The weighted samples: those of the level itself, then those of the coarser one.
    pub values: Vec<f64>,
    /// Neighbours on the coarser level, where its samples lie between the window's.
    taps: Vec<f64>,
    causal_len: usize,
}

impl WindowFeature {
    /// A feature of zeros.
    pub fn new(shape: &PyramidConfig) -> Self {
        Self {
            weights: shape.weights(),
            values: vec![0.0; shape.feature_len()],
            taps: vec![0.0; shape.coarse_len() + 1],
            causal_len: shape.causal_len(),
        }
    }

    /// The half that the level itself gives, and the one that the coarser level gives.
    pub fn halves(&mut self) -> (&mut [f64], &mut [f64]) {
        self.values.split_at_mut(self.causal_len)
    }

    /// Collects the feature at a place. Both levels come with the sample before which they read as silence.
    pub fn gather(
        &mut self,
        position: &WindowPosition,
        (own, floor): (&Ring, i64),
        (coarser, coarser_floor): (&Ring, i64),
    ) {
        let (causal, coarse) = self.values.split_at_mut(self.causal_len);
        own.copy(position.causal, floor, causal);
        if position.between {
            coarser.copy(position.coarse, coarser_floor, &mut self.taps);
            for (x, taps) in coarse.iter_mut().zip(self.taps.windows(2)) {
                *x = halfway(taps[0], taps[1]);
            }
        } else {
            coarser.copy(position.coarse, coarser_floor, coarse);
        }
        self.values.iter_mut().zip(&self.weights).for_each(|(x, weight)| *x *= weight);
    }

    /// Multiplies the whole feature.
    pub fn scale(&mut self, factor: f64) {
        if factor != 1.0 {
            self.values.iter_mut().for_each(|x| *x *= factor);
        }
    }
}
