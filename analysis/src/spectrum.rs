//! Power over frequency.

use crate::welch::Welch;

/// Longest and shortest window in samples.
const WINDOWS: (usize, usize) = (1 << 15, 1 << 10);

/// Power spectral density by Welch's method: full scale squared per Hz, mean over channels.
#[derive(Debug, Clone)]
pub struct Spectrum {
    bins: Vec<f64>,
    bin_hz: f64,
}

impl Spectrum {
    /// Spectrum of a whole sound, with windows of at most half its length; a short one is padded with silence.
    pub fn of_channels<C: AsRef<[f32]>>(channels: &[C], sample_rate_hz: u32) -> Self {
        let half = channels.first().map_or(0, |channel| channel.as_ref().len() / 2).max(1);
        let size = (1 << half.ilog2()).clamp(WINDOWS.1, WINDOWS.0);
        Self::of_frames(channels, f64::from(sample_rate_hz), size)
    }

    /// Spectrum of a whole sound, from frames of `size` samples, at least 2, that overlap by half. What is left at the end
    /// does not count; a sound shorter than a frame is padded with silence.
    pub fn of_frames<C: AsRef<[S]>, S: Copy + Into<f64>>(channels: &[C], sample_rate_hz: f64, size: usize) -> Self {
        let mut welch = Welch::new(size, sample_rate_hz);
        for samples in channels.iter().map(AsRef::as_ref) {
            for start in (0..=samples.len().saturating_sub(size)).step_by(size / 2) {
                welch.add(samples[start..].iter().map(|sample| (*sample).into()));
            }
        }
        Self { bins: welch.density().collect(), bin_hz: welch.bin_hz() }
    }

    /// Density by bin from 0 Hz to half the sample rate.
    pub fn density(&self) -> &[f64] {
        &self.bins
    }

    /// Distance of two bins in Hz.
    pub fn bin_hz(&self) -> f64 {
        self.bin_hz
    }

    /// Density at a frequency in dB per Hz, mean over a sixth of an octave.
    pub fn density_db(&self, frequency_hz: f64) -> f64 {
        let half = 2f64.powf(1.0 / 12.0);
        decibels(mean_between(&self.bins, self.bin_hz, frequency_hz / half, frequency_hz * half))
    }

    /// Power between two frequencies in Hz.
    pub fn power(&self, low_hz: f64, high_hz: f64) -> f64 {
        self.between(low_hz, high_hz).map(|(_, density)| density).sum::<f64>() * self.bin_hz
    }

    /// Frequencies in Hz with their density in dB per Hz, averaged over a 24th of an octave where that covers more than
    /// one value.
    pub fn levels_db(&self, low_hz: f64, high_hz: f64) -> Vec<(f64, f64)> {
        let part = |hz: f64| (24.0 * hz.log2()).floor() as i64;
        let values: Vec<(f64, f64)> = self.between(low_hz, high_hz).filter(|(hz, _)| *hz > 0.0).collect();
        let means = values.chunk_by(|a, b| part(a.0) == part(b.0)).map(|values| {
            let mean = |value: fn(&(f64, f64)) -> f64| values.iter().map(value).sum::<f64>() / values.len() as f64;
            (mean(|value| value.0), 10.0 * mean(|value| value.1).max(1e-30).log10())
        });
        means.collect()
    }

    /// Exponent of the best-fitting power law between two frequencies, on logarithmic axes; none if there is nothing to
    /// fit.
    pub fn slope(&self, low_hz: f64, high_hz: f64) -> Option<f64> {
        let points: Vec<(f64, f64)> = self
            .between(low_hz, high_hz)
            .filter(|(hz, density)| *hz > 0.0 && *density > 0.0)
            .map(|(hz, density)| (hz.log10(), density.log10()))
            .collect();
        let count = points.len() as f64;
        let mean = |value: fn(&(f64, f64)) -> f64| points.iter().map(value).sum::<f64>() / count;
        let (x, y) = (mean(|point| point.0), mean(|point| point.1));
        let (above, below) = points.iter().fold((0.0, 0.0), |(above, below), point| {
            (above + (point.0 - x) * (point.1 - y), below + (point.0 - x) * (point.0 - x))
        });
        (points.len() >= 3).then_some(above / below)
    }

    /// Highest frequency in Hz.
    pub fn nyquist_hz(&self) -> f64 {
        self.bin_hz * (self.bins.len() - 1) as f64
    }

    fn between(&self, low_hz: f64, high_hz: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let bins = self.bins.iter().enumerate().map(|(bin, density)| (bin as f64 * self.bin_hz, *density));
        bins.filter(move |(hz, _)| (low_hz..=high_hz).contains(hz))
    }
}

/// Power as dB; silence is -200 dB.
pub(crate) fn decibels(power: f64) -> f64 {
    10.0 * power.max(1e-20).log10()
}

/// Mean of the bins between two frequencies; where these are closer than bins, interpolated.
pub(crate) fn mean_between(bins: &[f64], bin_hz: f64, low_hz: f64, high_hz: f64) -> f64 {
    let (low, high) = (low_hz / bin_hz, high_hz / bin_hz);
    let first = low.ceil() as usize;
    let last = (high.floor() as usize + 1).min(bins.len());
    if last > first + 1 {
        return bins[first..last].iter().sum::<f64>() / (last - first) as f64;
    }
    let at = 0.5 * (low + high);
    let below = at as usize;
    match bins.get(below..=below + 1) {
        Some([a, b]) => a + (at - below as f64) * (b - a),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise, the same every time.
    fn noise(samples: usize) -> Vec<f32> {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f32 / (1u64 << 23) as f32 - 1.0
        };
        (0..samples).map(|_| next()).collect()
    }

    #[test]
    fn power_is_the_signals() {
        let noise = noise(400_000);
        let spectrum = Spectrum::of_channels(&[&noise], 44_100);
        let power = noise.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>() / noise.len() as f64;
        assert!((spectrum.power(0.0, 22_050.0) / power - 1.0).abs() < 0.02);
        assert!(spectrum.slope(100.0, 10_000.0).unwrap().abs() < 0.05);
        let sine: Vec<f32> = (0..100_000).map(|n| (std::f32::consts::TAU * 0.01 * n as f32).sin()).collect();
        assert!((Spectrum::of_channels(&[&sine], 44_100).power(400.0, 480.0) - 0.5).abs() < 0.01);
    }

    #[test]
    fn an_integrated_noise_falls_with_the_square() {
        let mut sum = 0.0;
        let walk: Vec<f32> = noise(400_000)
            .iter()
            .map(|x| {
                sum = 0.9999 * sum + x;
                sum
            })
            .collect();
        let slope = Spectrum::of_channels(&[&walk], 44_100).slope(30.0, 3000.0).unwrap();
        assert!((slope + 2.0).abs() < 0.05, "{slope}");
    }

    #[test]
    fn short_sounds_have_spectra_too() {
        for count in [0, 1, 100, 5000] {
            let spectrum = Spectrum::of_channels(&[noise(count)], 8000);
            assert!(spectrum.power(0.0, 4000.0).is_finite() && spectrum.nyquist_hz() == 4000.0);
        }
        assert_eq!(Spectrum::of_channels(&[[0.0; 3000]], 8000).slope(30.0, 180.0), None);
    }

    #[test]
    fn a_tones_power_is_found_at_its_frequency() {
        let step = std::f64::consts::TAU * 1000.0 / 44_100.0;
        let tone: Vec<f32> = (0..88_200).map(|n| (step * f64::from(n)).sin() as f32).collect();
        let spectrum = Spectrum::of_frames(&[&tone, &tone], 44_100.0, 16_384);
        assert!((spectrum.power(950.0, 1050.0) - 0.5).abs() < 1e-3);
        assert!(spectrum.power(1.0, 800.0) + spectrum.power(1200.0, 22_000.0) < 1e-6);
        // Half a square of full scale within a sixth of an octave of bins.
        let expected_db = 10.0 * (0.5 / (1000.0 * (2f64.powf(1.0 / 12.0) - 2f64.powf(-1.0 / 12.0)))).log10();
        assert!((spectrum.density_db(1000.0) - expected_db).abs() < 0.2);
    }
}
