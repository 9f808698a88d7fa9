//! The character of a low-frequency flame signal in a few figures: levels, burstiness, slope.

use maths::fft::RealTransform;
use pyrophone_analysis::Spectrum;

/// Bands with reported levels, in Hz: below the paper's high-pass, and the lower and upper part of the range above it.
pub const BANDS_HZ: [(f64, f64); 3] = [(10.0, 30.0), (30.0, 80.0), (80.0, 175.0)];

/// The band for envelope and kurtosis, in Hz: from the high-pass to the limit of 360 steps a second.
const HEARD_HZ: (f64, f64) = (30.0, 175.0);
/// Order of the Butterworth responses at both ends of that band; they are applied twice, without phase.
const ORDER: i32 = 4;
/// Frequencies over which the slope is fitted, in Hz: those of the paper's signals.
const SLOPE_HZ: (f64, f64) = (30.0, 180.0);
/// Length of the windows of Welch's method in seconds: bins of 5 Hz.
const WINDOW_S: f64 = 0.2;
/// Averaging time of the envelope, in seconds.
const ENVELOPE_S: f64 = 0.025;
/// Ratio of a burst's peak to the mean of the envelope, and the least time between two of them in seconds.
const BURST: f64 = 2.0;
const BURST_APART_S: f64 = 0.15;

/// Figures of a signal. By the same figures the paper's own three signals have an envelope's CV of 0.97-1.19, a
/// kurtosis of 7.8-10.5, 1.8-2.0 bursts a second and slopes of -15 to 0 dB per decade.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Character {
    /// Mean squares in [`BANDS_HZ`], in dB re 1.
    pub levels_db: [f64; 3],
    /// Deviation over mean of the envelope: rms over 25 ms of 30-175 Hz.
    pub envelope_cv: f64,
    /// Fourth moment over the squared second of 30-175 Hz; 3 for steady noise.
    pub kurtosis: f64,
    /// Peaks per second of the envelope above twice its mean.
    pub bursts_hz: f64,
    /// Slope of the power spectrum at 30-180 Hz, in dB per decade.
    pub slope_db: f64,
}

impl Character {
    /// Character of a signal of at least half a second; none where it is shorter, slower than 360 samples a second, or
    /// silent.
    pub fn of_signal(signal: &[f64], rate_hz: f64) -> Option<Self> {
        let power = signal.iter().map(|x| x * x).sum::<f64>();
        if rate_hz < 2.0 * SLOPE_HZ.1 || (signal.len() as f64) < 0.5 * rate_hz || !(power > 0.0 && power.is_finite()) {
            return None;
        }
        let window = ((WINDOW_S * rate_hz).round() as usize).max(2);
        let spectrum = Spectrum::of_frames(&[signal], rate_hz, window);
        let (density, bin_hz) = (spectrum.density(), spectrum.bin_hz());
        let audible = band_passed(signal, rate_hz);
        let envelope = envelope(&audible, rate_hz);
        let mean = mean_of(&envelope, |x| x);
        let deviation = mean_of(&envelope, |x| (x - mean).powi(2)).sqrt();
        Some(Self {
            levels_db: BANDS_HZ.map(|(low, high)| {
                let within = (low / bin_hz).round() as usize..(high / bin_hz).round() as usize;
                10.0 * (density[within].iter().sum::<f64>() * bin_hz).max(1e-30).log10()
            }),
            envelope_cv: deviation / mean,
            kurtosis: mean_of(&audible, |x| x.powi(4)) / mean_of(&audible, |x| x * x).powi(2),
            bursts_hz: bursts(&envelope, mean, rate_hz) as f64 * rate_hz / signal.len() as f64,
            // An exponent of 1 is 10 dB per decade.
            slope_db: 10.0 * spectrum.slope(SLOPE_HZ.0, SLOPE_HZ.1)?,
        })
    }
}

fn mean_of(values: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    values.iter().map(|x| of(*x)).sum::<f64>() / values.len() as f64
}

/// The signal in [`HEARD_HZ`], without delay.
fn band_passed(signal: &[f64], rate_hz: f64) -> Vec<f64> {
    let size = signal.len();
    let transform = RealTransform::new(size);
    let mut bins = transform.spectrum(signal);
    for (bin, value) in bins.iter_mut().enumerate() {
        let frequency_hz = (bin as f64 * rate_hz / size as f64).max(1e-9);
        let (low, high) = (HEARD_HZ.0 / frequency_hz, frequency_hz / HEARD_HZ.1);
        *value /= (1.0 + low.powi(2 * ORDER)) * (1.0 + high.powi(2 * ORDER)) * size as f64;
    }
    let mut output = vec![0.0; size];
    transform.inverse(&bins, &mut output, &mut vec![0.0; transform.room()]);
    output
}

/// Rms over [`ENVELOPE_S`] around every sample; the signal counts as zero outside its ends.
fn envelope(signal: &[f64], rate_hz: f64) -> Vec<f64> {
    let half = ((0.5 * ENVELOPE_S * rate_hz).round() as usize).max(1);
    let mut sums = vec![0.0];
    sums.extend(signal.iter().scan(0.0, |sum, x| {
        *sum += x * x;
        Some(*sum)
    }));
    let mean = |n: usize| (sums[(n + half).min(signal.len())] - sums[n.saturating_sub(half)]) / (2 * half) as f64;
    (0..signal.len()).map(|n| mean(n).max(0.0).sqrt()).collect()
}

/// Number of prominent peaks of an envelope; of several close together, the highest counts.
fn bursts(envelope: &[f64], mean: f64, rate_hz: f64) -> usize {
    let mut peaks: Vec<usize> = (1..envelope.len().saturating_sub(1))
        .filter(|n| envelope[*n] > BURST * mean && envelope[*n] > envelope[n - 1] && envelope[*n] >= envelope[n + 1])
        .collect();
    peaks.sort_by(|a, b| envelope[*b].total_cmp(&envelope[*a]));
    let mut kept: Vec<usize> = vec![];
    for peak in peaks {
        if kept.iter().all(|other| other.abs_diff(peak) as f64 >= BURST_APART_S * rate_hz) {
            kept.push(peak);
        }
    }
    kept.len()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use pyrophone_flame::solver::Random;

    use super::*;

    const RATE_HZ: f64 = 1440.0;

    fn noise(seconds: f64) -> Vec<f64> {
        let mut random = Random::new(5);
        (0..(seconds * RATE_HZ) as usize).map(|_| random.normal()).collect()
    }

    #[test]
    fn a_sine_has_its_level_in_its_band_alone() {
        for (band, frequency_hz) in [20.0, 50.0, 120.0].into_iter().enumerate() {
            let sine: Vec<f64> = (0..4320).map(|n| (TAU * frequency_hz * f64::from(n) / RATE_HZ).sin()).collect();
            let levels = Character::of_signal(&sine, RATE_HZ).unwrap().levels_db;
            assert!((levels[band] + 3.01).abs() < 0.1, "{frequency_hz} Hz: {levels:?}");
            assert!((0..3).all(|other| other == band || levels[other] < -40.0), "{frequency_hz} Hz: {levels:?}");
        }
    }

    #[test]
    fn white_noise_is_steady_and_flat() {
        let found = Character::of_signal(&noise(30.0), RATE_HZ).unwrap();
        assert!((found.kurtosis - 3.0).abs() < 0.3, "{found:?}");
        assert!(found.envelope_cv < 0.45 && found.bursts_hz < 0.5, "{found:?}");
        assert!(found.slope_db.abs() < 2.0, "{found:?}");
        // 145 Hz of the 720 that hold a mean square of 1.
        assert!((found.levels_db[2] - 10.0 * (95.0f64 / 720.0).log10()).abs() < 0.5, "{found:?}");
    }

    #[test]
    fn bursts_of_noise_are_counted() {
        let bursts: Vec<f64> = noise(10.0)
            .into_iter()
            .enumerate()
            .map(|(n, x)| {
                let since_s = (n as f64 / RATE_HZ).rem_euclid(0.5);
                x * (0.05 + (-since_s / 0.05).exp())
            })
            .collect();
        let found = Character::of_signal(&bursts, RATE_HZ).unwrap();
        assert!((1.8..=2.4).contains(&found.bursts_hz), "{found:?}");
        assert!(found.envelope_cv > 0.9 && found.kurtosis > 7.0, "{found:?}");
    }

    #[test]
    fn a_falling_spectrum_has_its_slope() {
        // A leaky sum falls by 20 dB per decade above its corner.
        let mut state = 0.0;
        let leaky: Vec<f64> = noise(40.0)
            .into_iter()
            .map(|x| {
                state = 0.98 * state + x;
                state
            })
            .collect();
        let found = Character::of_signal(&leaky, RATE_HZ).unwrap();
        assert!((found.slope_db + 20.0).abs() < 1.5, "{found:?}");
    }

    #[test]
    fn silence_and_scraps_have_no_character() {
        assert_eq!(Character::of_signal(&[0.0; 4000], RATE_HZ), None);
        assert_eq!(Character::of_signal(&noise(0.4), RATE_HZ), None);
        assert_eq!(Character::of_signal(&noise(2.0), 100.0), None);
        assert_eq!(Character::of_signal(&[f64::NAN; 4000], RATE_HZ), None);
    }
}
