//! Zero-phase high-pass.

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
    // Long enough for the ringing after the end.
    let tail = (4.0 / corner.max(1e-4)) as usize;
    let mut passed = samples.to_vec();
    passed.resize(samples.len() + tail, 0.0);
    filter.pass(&mut passed);
    passed.reverse();
    filter.pass(&mut passed);
    passed.reverse();
    passed.truncate(samples.len());
    passed
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
}
