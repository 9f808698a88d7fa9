//! Times of the ruptures: bursts at random, each with a few ruptures in a row (a Neyman-Scott process).

use super::draws::Draws;
use super::kind::Bursts;

/// Smallest gap in seconds: two closer ruptures are heard as one.
const LEAST_GAP_S: f64 = 0.001;

impl Bursts {
    /// Ruptures a second.
    pub fn ruptures_per_s(&self) -> f64 {
        self.per_second * self.size
    }

    /// Onsets in seconds, in order, in the `seconds` from 0 on.
    pub fn onsets_s(&self, seconds: f64, draws: &mut Draws) -> Vec<f64> {
        let mut onsets_s = Vec::new();
        let mut burst_s = draws.exponential() / self.per_second;
        while burst_s < seconds {
            let mut onset_s = burst_s;
            // The number of ruptures is geometric: each is followed by another with the same probability.
            loop {
                if onset_s < seconds {
                    onsets_s.push(onset_s);
                }
                if draws.share() * self.size < 1.0 {
                    break;
                }
                onset_s += LEAST_GAP_S.max(self.gap_s * draws.exponential());
            }
            burst_s += draws.exponential() / self.per_second;
        }
        onsets_s.sort_by(f64::total_cmp);
        onsets_s.dedup_by(|later, earlier| *later - *earlier < LEAST_GAP_S);
        onsets_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ruptures_have_their_rate_and_come_in_bursts() {
        let variation = |size: f64| {
            let bursts = Bursts { per_second: 12.0 / size, size, gap_s: 0.01 };
            let onsets_s = bursts.onsets_s(500.0, &mut Draws::new(3, 4));
            let rate = onsets_s.len() as f64 / 500.0;
            assert!((rate / bursts.ruptures_per_s() - 1.0).abs() < 0.08, "{rate} a second");
            assert!(onsets_s.windows(2).all(|pair| pair[1] - pair[0] >= LEAST_GAP_S));
            let gaps: Vec<f64> = onsets_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let mean = gaps.iter().sum::<f64>() / gaps.len() as f64;
            (gaps.iter().map(|gap| (gap - mean).powi(2)).sum::<f64>() / gaps.len() as f64).sqrt() / mean
        };
        let (single, clustered) = (variation(1.000_001), variation(4.0));
        assert!((single - 1.0).abs() < 0.05, "at random: {single}");
        assert!(clustered > 1.5, "in bursts: {clustered}");
    }
}
