//! Conversion of a series to a seamless loop.

/// One period of a series: its first values fade in while the last `fade` of them, which lie beyond the period's end,
/// fade out, so that the end of the period continues into its beginning.
///
/// The deviation from the mean fades with equal power, because the two sections are unrelated. The result is `fade`
/// values shorter, and the fade is at most half of the series.
pub fn seamless(values: &[f64], fade: usize) -> Vec<f64> {
    let fade = fade.min(values.len() / 2);
    let (period, beyond) = values.split_at(values.len() - fade);
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let mut looped = period.to_vec();
    for (n, (value, leaving)) in looped.iter_mut().zip(beyond).enumerate() {
        let angle = std::f64::consts::FRAC_PI_2 * n as f64 / fade as f64;
        *value = mean + maths::sin(angle) * (*value - mean) + maths::cos(angle) * (leaving - mean);
    }
    looped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::Random;

    #[test]
    fn the_end_goes_on_in_the_beginning() {
        // A random walk: its steps are small, but it ends far from its start.
        let mut random = Random::new(3);
        let mut at = 100.0;
        let walk: Vec<f64> = (0..5000)
            .map(|_| {
                at += random.uniform() - 0.45;
                at
            })
            .collect();
        let looped = seamless(&walk, 360);
        assert_eq!(looped.len(), 4640);
        assert_eq!(looped[360..], walk[360..4640]);
        assert!((looped[0] - walk[4640]).abs() < 1e-9, "the seam is where the walk went on");
        let largest = |steps: &[f64]| steps.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
        assert!(largest(&looped) < 4.0 * largest(&walk), "{} against {}", largest(&looped), largest(&walk));
        assert!((looped[4639] - looped[0]).abs() <= largest(&walk));
    }

    #[test]
    fn fading_keeps_the_power() {
        let mut random = Random::new(4);
        let noise: Vec<f64> = (0..40_000).map(|_| 5.0 + random.uniform() - 0.5).collect();
        let looped = seamless(&noise, 20_000);
        let power = |x: &[f64]| x.iter().map(|v| (v - 5.0).powi(2)).sum::<f64>() / x.len() as f64;
        assert!((power(&looped) / power(&noise) - 1.0).abs() < 0.05, "{} of {}", power(&looped), power(&noise));
    }

    #[test]
    fn short_series_are_left_whole() {
        assert_eq!(seamless(&[], 5), vec![] as Vec<f64>);
        assert_eq!(seamless(&[1.0], 5), [1.0]);
        assert_eq!(seamless(&[1.0, 3.0], 0), [1.0, 3.0]);
        assert_eq!(seamless(&[2.0; 9], 100), [2.0; 5]);
    }
}
