//! Dynamic-range matching (§5.3): learned and running distributions of magnitudes, and the factor that maps one onto
//! the other.

use crate::Error;
use crate::dsp::mean_loudness;
use bitcode::{Decode, Encode};

/// Up to this many magnitudes a distribution is exact, as in the reference: 48 s of drive at 44.1 kHz and six levels.
/// Longer ones would make the sessions that store them large.
const EXACT_LIMIT: usize = 65_536;
/// Number of quantiles that represent larger distributions.
const QUANTILES: usize = 4_096;

/// Sorted magnitudes of a pyramid's top level.
#[derive(Debug, Clone, PartialEq, Encode, Decode)]
pub struct Distribution {
    quantiles: Vec<f64>,
    /// The level of a drive whose loudnesses these are.
    loudness: Option<f64>,
}

impl Distribution {
    /// The distribution of `magnitudes`, in any order: exact up to 65,536 values, otherwise as 4,096 quantiles.
    /// Non-finite values are ignored.
    pub fn from_magnitudes(mut magnitudes: Vec<f64>) -> Self {
        magnitudes.retain(|x| x.is_finite());
        magnitudes.iter_mut().for_each(|x| *x = x.abs());
        magnitudes.sort_unstable_by(f64::total_cmp);
        let sorted = Self::sorted(magnitudes);
        if sorted.quantiles.len() <= EXACT_LIMIT {
            return sorted;
        }
        let at = |i| sorted.amplitude(i as f64 / (QUANTILES - 1) as f64);
        Self::sorted((0..QUANTILES).map(at).collect())
    }

    fn sorted(quantiles: Vec<f64>) -> Self {
        Self { loudness: mean_loudness(&quantiles), quantiles }
    }

    /// A distribution from stored quantiles: finite, not negative, ascending.
    pub fn from_quantiles(quantiles: Vec<f64>) -> Result<Self, Error> {
        let what = "learned distribution";
        if let Some(at) = quantiles.iter().position(|x| !x.is_finite()) {
            return Err(Error::NotFinite { what, at });
        }
        if quantiles.len() > EXACT_LIMIT {
            let (found, high) = (quantiles.len() as f64, EXACT_LIMIT as f64);
            return Err(Error::OutOfRange { what: "values in a learned distribution", found, low: 0.0, high });
        }
        let descends = |pair: &&[f64]| pair[1] < pair[0];
        let negative = quantiles.first().filter(|x| **x < 0.0).copied();
        if let Some(found) = negative.or(quantiles.windows(2).find(descends).map(|pair| pair[1])) {
            return Err(Error::OutOfRange {
                what: "next value of a learned distribution",
                found,
                low: 0.0,
                high: f64::MAX,
            });
        }
        Ok(Self::sorted(quantiles))
    }

    /// The level of a drive with these loudnesses; none if all are silent.
    pub fn loudness(&self) -> Option<f64> {
        self.loudness
    }

    /// The sorted values.
    pub fn quantiles(&self) -> &[f64] {
        &self.quantiles
    }

    /// CDF(q): the magnitude at `fraction` (0-1) of the distribution, linear between values.
    pub fn amplitude(&self, fraction: f64) -> f64 {
        let Some(last) = self.quantiles.len().checked_sub(1) else { return 0.0 };
        let at = fraction.clamp(0.0, 1.0) * last as f64;
        let below = (at as usize).min(last);
        let above = (below + 1).min(last);
        let part = at - below as f64;
        self.quantiles[below] * (1.0 - part) + self.quantiles[above] * part
    }

    /// CDF^-1(a): the fraction of the distribution below `amplitude`: 0 below the first value, 1 from the last value
    /// on, linear in between.
    pub fn fraction(&self, amplitude: f64) -> f64 {
        let not_above = self.quantiles.partition_point(|x| *x <= amplitude);
        if not_above == 0 {
            return 0.0;
        }
        if not_above == self.quantiles.len() {
            return 1.0;
        }
        let (low, high) = (self.quantiles[not_above - 1], self.quantiles[not_above]);
        let part = (amplitude - low) / (high - low);
        ((not_above - 1) as f64 + part) / (self.quantiles.len() - 1) as f64
    }
}

/// Bins per decibel, and the range, of a [`Histogram`].
const BINS_PER_DB: f64 = 4.0;
const LOWEST_DB: f64 = -90.0;
const BINS: usize = 440;

/// A histogram of magnitudes in decibels, -90 to +20 dBFS, quarter of a decibel wide.
#[derive(Debug, Clone, PartialEq, Encode, Decode)]
pub struct Histogram {
    weights: Vec<f64>,
    total: f64,
}

impl Default for Histogram {
    fn default() -> Self {
        Self { weights: vec![0.0; BINS], total: 0.0 }
    }
}

impl Histogram {
    /// The histogram of a distribution, with a total weight of 1.
    pub fn of_distribution(distribution: &Distribution) -> Self {
        let mut histogram = Self::default();
        for magnitude in distribution.quantiles() {
            histogram.add(*magnitude, 1.0);
        }
        if histogram.total > 0.0 {
            let total = histogram.total;
            histogram.weights.iter_mut().for_each(|x| *x /= total);
            histogram.total = 1.0;
        }
        histogram
    }

    /// Adds a magnitude; below -90 dBFS it counts as silence and is ignored.
    fn add(&mut self, magnitude: f64, weight: f64) {
        let position = bin_position(magnitude);
        if position >= 0.0 {
            self.weights[(position as usize).min(BINS - 1)] += weight;
            self.total += weight;
        }
    }

    fn reset(&mut self) {
        self.weights.fill(0.0);
        self.total = 0.0;
    }

    /// Weight below `magnitude`, linear (in decibels) within a bin.
    fn below(&self, magnitude: f64) -> f64 {
        let position = bin_position(magnitude).clamp(0.0, BINS as f64);
        let bin = position as usize;
        let within = self.weights.get(bin).map_or(0.0, |x| x * (position - bin as f64));
        self.weights[..bin].iter().sum::<f64>() + within
    }
}

fn bin_position(magnitude: f64) -> f64 {
    (20.0 * maths::log10(magnitude.max(1e-30)) - LOWEST_DB) * BINS_PER_DB
}

/// The drive's distribution, estimated during playback: a histogram that forgets, over a prior that is the recording's
/// own distribution, so that the mapping starts as the identity and grows into the drive's. Memory is bounded; the
/// result is a function of the drive since reset.
#[derive(Debug, Clone)]
pub struct RunningDistribution {
    seen: Histogram,
    /// Weight of the next value; it grows, which reduces the weight of the past.
    weight: f64,
    growth: f64,
    prior_weight: f64,
}

/// Seconds after which a value counts 1/e.
const MEMORY_S: f64 = 30.0;
/// Seconds of drive that weigh as much as the prior.
const PRIOR_S: f64 = 0.25;

impl RunningDistribution {
    /// An estimate over values that arrive `rate_hz` times a second.
    pub fn new(rate_hz: f64) -> Self {
        let growth = maths::exp(1.0 / (MEMORY_S * rate_hz));
        Self { seen: Histogram::default(), weight: 1.0, growth, prior_weight: PRIOR_S * rate_hz }
    }

    /// Forgets everything.
    pub fn reset(&mut self) {
        self.seen.reset();
        self.weight = 1.0;
    }

    /// Adds the next magnitude.
    pub fn push(&mut self, magnitude: f64) {
        self.seen.add(magnitude, self.weight);
        self.weight *= self.growth;
        // Weights grow for ever; scaled back now and then, they stay finite.
        if self.weight > 1e12 {
            let shrink = 1.0 / self.weight;
            self.seen.weights.iter_mut().for_each(|x| *x *= shrink);
            self.seen.total *= shrink;
            self.weight = 1.0;
        }
    }

    /// The fraction of the drive so far below `amplitude`.
    pub fn fraction(&self, amplitude: f64, prior: &Histogram) -> f64 {
        let prior_weight = self.prior_weight * self.weight;
        let total = self.seen.total + prior_weight * prior.total;
        if total <= 0.0 {
            return 0.0;
        }
        (self.seen.below(amplitude) + prior_weight * prior.below(amplitude)) / total
    }
}

/// Mean magnitude below which a window is not mapped: the reference's threshold.
const LEAST_MEAN: f64 = 1e-4;

/// §5.3, equation 17: the factor for the feature's coarse half with mean magnitude `mean`; `fraction` gives the share
/// of the drive below an amplitude. 1 if the window is too quiet to map or the factor would be useless.
pub fn feature_factor(mean: f64, scaling_alpha: f64, fraction: impl Fn(f64) -> f64, recording: &Distribution) -> f64 {
    if mean <= LEAST_MEAN {
        return 1.0;
    }
    let ratio = recording.amplitude(fraction(mean)) / mean;
    let factor = (1.0 - scaling_alpha) + scaling_alpha * ratio;
    if factor == 0.0 || !factor.is_finite() { 1.0 } else { factor }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn look_ups_match_the_reference() {
        let cdf = Distribution::from_magnitudes(vec![0.0, 0.5, 1.5, 3.0, 5.0, 7.5, 10.0]);
        for (fraction, amplitude) in [(0.0, 0.0), (0.25, 1.0), (0.5, 3.0), (0.75, 6.25), (1.0, 10.0)] {
            assert_eq!(cdf.amplitude(fraction), amplitude);
        }
        let sixth = 1.0 / 6.0;
        let inverse =
            [(0.0, 0.0), (0.5, sixth), (2.25, 2.5 * sixth), (5.0, 4.0 * sixth), (10.0, 1.0), (50.0, 1.0), (-5.0, 0.0)];
        for (amplitude, fraction) in inverse {
            assert!((cdf.fraction(amplitude) - fraction).abs() < 1e-15, "{amplitude}");
        }
    }

    #[test]
    fn long_distributions_keep_their_quantiles() {
        let many = Distribution::from_magnitudes((0..200_000).map(|i| i as f64 / 199_999.0).collect());
        assert_eq!(many.quantiles().len(), QUANTILES);
        for i in 0..=100 {
            let q = i as f64 / 100.0;
            assert!((many.amplitude(q) - q).abs() < 1e-9 && (many.fraction(q) - q).abs() < 1e-9);
        }
        assert_eq!(Distribution::from_quantiles(many.quantiles().to_vec()).unwrap(), many);
    }

    #[test]
    fn bad_quantiles_are_refused() {
        assert!(Distribution::from_quantiles(vec![0.0, 2.0, 1.0]).is_err());
        assert!(Distribution::from_quantiles(vec![-1.0, 2.0]).is_err());
        assert!(Distribution::from_quantiles(vec![0.0, f64::NAN]).is_err());
        assert!(Distribution::from_quantiles(vec![]).is_ok());
    }

    #[test]
    fn running_estimate_starts_at_the_prior_and_finds_the_drive() {
        let prior =
            Histogram::of_distribution(&Distribution::from_magnitudes((1..=1000).map(|i| i as f64 / 1000.0).collect()));
        let mut running = RunningDistribution::new(1378.0);
        assert!((running.fraction(0.5, &prior) - 0.5).abs() < 0.02);
        for i in 0..20_000 {
            running.push(0.01 * ((i * 7919 % 1000) as f64 + 0.5) / 1000.0);
        }
        for part in [0.2, 0.5, 0.9] {
            let found = running.fraction(0.01 * part, &prior);
            assert!((found - part).abs() < 0.05, "{part}: {found}");
        }
    }

    #[test]
    fn weights_stay_finite_for_hours() {
        let mut running = RunningDistribution::new(1378.0);
        for i in 0..2_000_000 {
            running.push(0.1 + (i % 10) as f64 * 0.01);
        }
        let found = running.fraction(0.145, &Histogram::default());
        assert!((found - 0.5).abs() < 0.05, "{found}");
    }
}
