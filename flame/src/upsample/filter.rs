//! Zero-phase filters.

/// A biquad's coefficients (Bristow-Johnson's cookbook).
struct HighPass {
    feed: [f64; 3],
    back: [f64; 2],
}

impl HighPass {
    /// Second-order Butterworth at `corner` (cycles per sample, below 0.5).
    fn new(corner: f64) -> Self {
        let turn = std::f64::consts::TAU * corner;
        let alpha = maths::sin(turn) * std::f64::consts::FRAC_1_SQRT_2;
        let (cos, whole) = (maths::cos(turn), 1.0 + alpha);
        let outer = 0.5 * (1.0 + cos) / whole;
        Self { feed: [outer, -2.0 * outer, outer], back: [-2.0 * cos / whole, (1.0 - alpha) / whole] }
    }

    fn pass(&self, samples: &mut [f64]) {
        let (mut one, mut two) = (0.0, 0.0);
        for sample in samples {
            let out = self.feed[0] * *sample + one;
            one = self.feed[1] * *sample - self.back[0] * out + two;
            two = self.feed[2] * *sample - self.back[1] * out;
            *sample = out;
        }
    }
}

/// Filters the samples forwards and backwards at `corner` (cycles per sample), so that nothing moves in time. Silence
/// surrounds the samples.
pub fn high_passed(samples: &[f64], corner: f64) -> Vec<f64> {
    let filter = HighPass::new(corner.clamp(1e-6, 0.49));
    let mut passed = samples.to_vec();
    passed.resize(samples.len() + ringing_steps(corner), 0.0);
    filter.pass(&mut passed);
    passed.reverse();
    filter.pass(&mut passed);
    passed.reverse();
    passed.truncate(samples.len());
    passed
}

/// Samples over which the high-pass at `corner` rings.
pub fn ringing_steps(corner: f64) -> usize {
    (4.0 / corner.max(1e-4)) as usize
}

/// The samples smoothed by a two-sided exponential that falls by 1/e over `steps`, whose sum is 1. Silence surrounds the
/// samples.
pub fn smoothed(samples: &[f64], steps: f64) -> Vec<f64> {
    let decay = maths::exp(-1.0 / steps);
    let mut smooth = samples.to_vec();
    for _ in 0..2 {
        let mut last = 0.0;
        for sample in &mut smooth {
            last = *sample + decay * (last - *sample);
            *sample = last;
        }
        smooth.reverse();
    }
    smooth
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn high_pass_keeps_phase_and_removes_low_frequencies() {
        let wave =
            |cycles: f64| (0..2000).map(|n| (std::f64::consts::TAU * cycles * f64::from(n)).sin()).collect::<Vec<_>>();
        let far =
            |a: &[f64], b: &[f64]| a.iter().zip(b).skip(500).take(1000).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        let high = wave(0.2);
        assert!(far(&high_passed(&high, 0.02), &high) < 0.01);
        assert!(far(&high_passed(&wave(0.002), 0.02), &[0.0; 2000]) < 2e-4);
        // Half the power in each direction.
        let corner = high_passed(&wave(0.02), 0.02);
        assert!((corner[500..1500].iter().fold(0.0f64, |peak, x| peak.max(x.abs())) - 0.5).abs() < 0.01);
    }

    #[test]
    fn smoothing_keeps_the_sum_and_the_moment() {
        let mut click = vec![0.0; 201];
        click[100] = 1.0;
        let smooth = smoothed(&click, 3.0);
        assert!((smooth.iter().sum::<f64>() - 1.0).abs() < 1e-9);
        assert!((0..100).all(|n| (smooth[n] - smooth[200 - n]).abs() < 1e-12), "it is not symmetric");
        assert!((smooth[103] / smooth[106] - std::f64::consts::E).abs() < 1e-2);
    }
}
