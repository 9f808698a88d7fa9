//! An octave of noise, as a function of seed and position only.

use crate::dsp::White;

/// Centre frequency of the octave per node: the maximum of the spectrum sin(pi f)^2 sinc(f)^8.
const MIDDLE: f64 = 0.24;
/// Standard deviation of a cubic B-spline through white noise, and of one through its differences.
const SMOOTH_DEVIATION: f64 = 0.692_4;
const OCTAVE_DEVIATION: f64 = 0.697_2;

/// Cubic B-splines whose coefficients are white noise, or its differences, at nodes on the timeline. No filter has any
/// memory: the sound at a position does not depend on the start of playback, and costs four products.
#[derive(Debug, Clone)]
pub(super) struct Octave {
    nodes_per_sample: f64,
    is_smooth: bool,
    scale: f64,
    /// First of the streams of white noise, one for all channels and one for each.
    stream: u32,
    /// Gain factors of the part common to all channels and of their own parts.
    shares: [f64; 2],
    /// Seed and node of the coefficients at hand, by channel.
    held: Option<(u32, i64)>,
    coefficients: Vec<[f64; 4]>,
}

impl Octave {
    /// Noise of unit variance about `middle_hz`, or as high as the rate allows. It falls by 6 dB per octave below, and
    /// faster above. The share `common` of its power is the same in all `channels`.
    pub fn new(middle_hz: f64, common: f64, channels: usize, stream: u32, sample_rate_hz: f64) -> Self {
        Self {
            nodes_per_sample: (middle_hz / (MIDDLE * sample_rate_hz)).min(1.0),
            is_smooth: false,
            scale: 1.0 / OCTAVE_DEVIATION,
            stream,
            shares: if channels == 1 { [1.0, 0.0] } else { [common.sqrt(), (1.0 - common).sqrt()] },
            held: None,
            coefficients: vec![[0.0; 4]; channels],
        }
    }

    /// Noise of unit variance up to about `highest_hz`, in one channel.
    pub fn smooth(highest_hz: f64, stream: u32, sample_rate_hz: f64) -> Self {
        let octave = Self::new(highest_hz, 1.0, 1, stream, sample_rate_hz);
        Self { is_smooth: true, scale: 1.0 / SMOOTH_DEVIATION, ..octave }
    }

    /// Adds `weight` times the noise at `position` to `sums`, by channel.
    #[inline]
    pub fn add(&mut self, seed: u32, position: i64, weight: f64, sums: &mut [f64]) {
        let node_position = position as f64 * self.nodes_per_sample;
        let whole = node_position.floor();
        let node = whole as i64;
        if self.held != Some((seed, node)) {
            self.go_to(seed, node);
        }
        let weights = spline(node_position - whole).map(|x| weight * self.scale * x);
        for (sum, coefficients) in sums.iter_mut().zip(&self.coefficients) {
            *sum += coefficients.iter().zip(weights).map(|(x, weight)| x * weight).sum::<f64>();
        }
    }

    /// The noise at `position` in the first channel.
    #[inline]
    pub fn value_at(&mut self, seed: u32, position: i64) -> f64 {
        let mut sum = [0.0];
        self.add(seed, position, 1.0, &mut sum);
        sum[0]
    }

    fn go_to(&mut self, seed: u32, node: i64) {
        let follows = self.held == Some((seed, node.wrapping_sub(1)));
        let common = White::new(seed, self.stream);
        for (channel, coefficients) in self.coefficients.iter_mut().enumerate() {
            let own = White::new(seed, self.stream + 1 + channel as u32);
            let value = |node: i64| self.shares[0] * common.sample_at(node) + self.shares[1] * own.sample_at(node);
            let coefficient = |node: i64| {
                if self.is_smooth { value(node) } else { value(node) - value(node.wrapping_sub(1)) }
            };
            if follows {
                coefficients.rotate_left(1);
                coefficients[3] = coefficient(node.wrapping_add(2));
            } else {
                *coefficients = std::array::from_fn(|i| coefficient(node.wrapping_add(i as i64 - 1)));
            }
        }
        self.held = Some((seed, node));
    }
}

/// Weights of the cubic B-spline at the fraction `part` between the second and the third of four coefficients.
#[inline]
fn spline(part: f64) -> [f64; 4] {
    let rest = 1.0 - part;
    let (a, d) = (rest * rest * rest / 6.0, part * part * part / 6.0);
    let b = 2.0 / 3.0 - 0.5 * part * part * (2.0 - part);
    [a, b, 1.0 - a - b - d, d]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn variance(signal: &[f64]) -> f64 {
        signal.iter().map(|x| x * x).sum::<f64>() / signal.len() as f64
    }

    #[test]
    fn noise_has_unit_variance_and_lies_about_its_middle() {
        for middle_hz in [100.0, 900.0, 6000.0] {
            let mut octave = Octave::new(middle_hz, 1.0, 1, 9, 48_000.0);
            let signal: Vec<f64> = (0..400_000).map(|position| octave.value_at(5, position)).collect();
            assert!((variance(&signal) - 1.0).abs() < 0.08, "{middle_hz} Hz: {}", variance(&signal));
            let steps: Vec<f64> = signal.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let mean_hz = (variance(&steps) / variance(&signal)).sqrt() * 48_000.0 / (2.0 * std::f64::consts::PI);
            assert!((0.9..1.4).contains(&(mean_hz / middle_hz)), "{mean_hz} Hz for {middle_hz} Hz");
        }
        let mut smooth = Octave::smooth(8.0, 9, 48_000.0);
        let signal: Vec<f64> = (0..3_000_000).step_by(37).map(|position| smooth.value_at(5, position)).collect();
        assert!((variance(&signal) - 1.0).abs() < 0.1, "{}", variance(&signal));
    }

    #[test]
    fn noise_depends_on_the_position_alone() {
        let fresh = || Octave::new(700.0, 0.5, 2, 3, 44_100.0);
        let mut running = fresh();
        for position in -3000..3000 {
            let (mut expected, mut found) = ([0.0; 2], [0.0; 2]);
            running.add(1, position, 0.5, &mut expected);
            fresh().add(1, position, 0.5, &mut found);
            assert_eq!(found, expected, "{position}");
        }
        assert_ne!(fresh().value_at(1, 50), fresh().value_at(2, 50), "another seed");
    }

    #[test]
    fn channels_have_the_common_part_in_common() {
        for common in [0.0, 0.4, 1.0] {
            let mut octave = Octave::new(2000.0, common, 2, 3, 44_100.0);
            let (mut product, mut power) = (0.0, 0.0);
            for position in 0..200_000 {
                let mut pair = [0.0; 2];
                octave.add(1, position, 1.0, &mut pair);
                product += pair[0] * pair[1];
                power += 0.5 * (pair[0] * pair[0] + pair[1] * pair[1]);
            }
            assert!((product / power - common).abs() < 0.05, "{} for {common}", product / power);
        }
    }
}
