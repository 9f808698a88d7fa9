//! Sequential random numbers for material that is made in advance.

use crate::dsp::White;

/// A sequence of random numbers.
#[derive(Debug)]
pub(super) struct Draws {
    noise: White,
    next: i64,
}

impl Draws {
    /// The sequence `number` of `seed`.
    pub fn new(seed: u32, number: u32) -> Self {
        Self { noise: White::new(seed, number), next: 0 }
    }

    /// A number in -1..1, evenly distributed.
    pub fn unit(&mut self) -> f64 {
        self.next += 1;
        self.noise.unit(self.next)
    }

    /// A number in 0..1, evenly distributed.
    pub fn share(&mut self) -> f64 {
        0.5 + 0.5 * self.unit()
    }

    /// A positive number of mean 1, exponentially distributed, below 40.
    pub fn exponential(&mut self) -> f64 {
        -maths::ln(self.share().max(f64::MIN_POSITIVE)).max(-40.0)
    }

    /// A number of mean 0 and variance 1, normally distributed within two standard deviations.
    pub fn normal(&mut self) -> f64 {
        loop {
            // The polar method of Marsaglia and Bray (1964), successful at once four times out of five.
            let [a, b] = [self.unit(), self.unit()];
            let square = a * a + b * b;
            if square > 0.0 && square < 1.0 {
                let normal = a * (-2.0 * maths::ln(square) / square).sqrt();
                if normal.abs() <= 2.0 {
                    return normal;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distributions_have_their_moments() {
        let mut draws = Draws::new(1, 2);
        let count = 20_000;
        let mut moments = |mut draw: Box<dyn FnMut(&mut Draws) -> f64>| {
            let values: Vec<f64> = (0..count).map(|_| draw(&mut draws)).collect();
            let mean = values.iter().sum::<f64>() / count as f64;
            let variance = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count as f64;
            (mean, variance, values.iter().fold(0.0f64, |most, x| most.max(x.abs())))
        };
        let (mean, variance, most) = moments(Box::new(Draws::normal));
        // Without its tails the variance is 0.77.
        assert!(mean.abs() < 0.03 && (variance - 0.774).abs() < 0.03 && most <= 2.0, "{mean} {variance} {most}");
        let (mean, variance, _) = moments(Box::new(Draws::exponential));
        assert!((mean - 1.0).abs() < 0.03 && (variance - 1.0).abs() < 0.08, "{mean} {variance}");
    }
}
