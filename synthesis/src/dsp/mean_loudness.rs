//! The mean of a signal's loudnesses.

/// Exponent of the mean over time: about twice that of the loudness that companding restores, so that its mean power is
/// preserved.
pub(crate) const MEAN_EXPONENT: f64 = 1.4;
/// Share of the loudest below which a loudness counts as silence.
const SILENT_PART: f64 = 1e-3;

/// The mean of loudnesses that are all known, silence not counted; none if all are silent.
pub(crate) fn mean_loudness(loudnesses: &[f64]) -> Option<f64> {
    let silent = SILENT_PART * loudnesses.iter().fold(0.0f64, |most, x| most.max(*x));
    let audible = || loudnesses.iter().filter(|x| **x > silent);
    let mean = audible().map(|x| maths::pow(*x, MEAN_EXPONENT)).sum::<f64>() / audible().count().max(1) as f64;
    (mean > 0.0 && mean.is_finite()).then(|| maths::pow(mean, 1.0 / MEAN_EXPONENT))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_is_left_out() {
        let mut loudnesses = vec![0.2; 1000];
        assert!((mean_loudness(&loudnesses).unwrap() - 0.2).abs() < 1e-12);
        loudnesses.extend([0.0; 5000]);
        assert!((mean_loudness(&loudnesses).unwrap() - 0.2).abs() < 1e-12);
        assert_eq!(mean_loudness(&[0.0; 9]), None);
        assert_eq!(mean_loudness(&[]), None);
    }
}
