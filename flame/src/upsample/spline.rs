//! A smooth curve through evenly spaced values.

/// The natural cubic spline through `values`, with `parts` samples from each value to the next. The last value is
/// repeated to the end, so that there are `parts` times as many.
pub fn natural_cubic(values: &[f64], parts: usize) -> Vec<f64> {
    let bends = second_derivatives(values);
    let last = values.len().saturating_sub(1);
    (0..values.len() * parts)
        .map(|sample| {
            let (index, share) = (sample / parts, (sample % parts) as f64 / parts as f64);
            if index >= last {
                return values[last];
            }
            let (a, b) = (1.0 - share, share);
            let bend = (a * a * a - a) * bends[index] + (b * b * b - b) * bends[index + 1];
            a * values[index] + b * values[index + 1] + bend / 6.0
        })
        .collect()
}

/// Second derivatives per step squared, zero at both ends (Press et al., Numerical Recipes, 3.3.2).
fn second_derivatives(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let mut bends = vec![0.0; count];
    if count < 3 {
        return bends;
    }
    let mut factors = vec![0.0; count];
    for n in 1..count - 1 {
        let pivot = 0.5 * factors[n - 1] + 2.0;
        factors[n] = -0.5 / pivot;
        let bend = values[n + 1] - 2.0 * values[n] + values[n - 1];
        bends[n] = (3.0 * bend - 0.5 * bends[n - 1]) / pivot;
    }
    for n in (1..count - 1).rev() {
        bends[n] += factors[n] * bends[n + 1];
    }
    bends
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_stays_a_line() {
        let line = natural_cubic(&[1.0, 3.0, 5.0, 7.0], 4);
        assert_eq!(line.len(), 16);
        assert!(line[..13].iter().enumerate().all(|(n, value)| (value - 1.0 - 0.5 * n as f64).abs() < 1e-12));
        assert!(line[12..].iter().all(|value| *value == 7.0), "{line:?}");
    }

    #[test]
    fn a_slow_wave_is_followed() {
        let wave = |at: f64| (0.4 * at).sin();
        let values: Vec<f64> = (0..40).map(|n| wave(f64::from(n))).collect();
        let spline = natural_cubic(&values, 5);
        let far = (50..150).map(|n| (spline[n] - wave(n as f64 / 5.0)).abs()).fold(0.0, f64::max);
        assert!(far < 2e-4, "{far}");
    }

    #[test]
    fn short_series_are_no_matter() {
        assert_eq!(natural_cubic(&[2.0], 3), [2.0; 3]);
        assert_eq!(natural_cubic(&[2.0, 4.0], 2), [2.0, 3.0, 4.0, 4.0]);
        assert!(natural_cubic(&[], 3).is_empty());
    }
}
