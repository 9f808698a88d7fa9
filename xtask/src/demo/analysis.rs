//! Power over frequency, and over time and frequency.

use maths::fft::{Complex64, RealTransform};

/// Lowest and highest frequency that is shown, in Hz.
pub const BAND_HZ: (f64, f64) = (20.0, 20_000.0);

/// Power spectral density by Welch's method: full scale squared per Hz, mean over channels.
#[derive(Debug, Clone)]
pub struct Spectrum {
    bins: Vec<f64>,
    bin_hz: f64,
}

impl Spectrum {
    /// The spectrum of a whole sound.
    pub fn of(channels: &[Vec<f32>], sample_rate_hz: u32) -> Self {
        const SIZE: usize = 16_384;
        let samples = channels.first().map_or(0, Vec::len);
        let mut transform = Transform::new(SIZE, sample_rate_hz);
        let mut bins = vec![0.0; SIZE / 2 + 1];
        let mut count = 0.0;
        for channel in channels {
            for start in (0..samples).step_by(SIZE / 2) {
                transform.add_density(channel, start as i64, &mut bins);
                count += 1.0;
            }
        }
        bins.iter_mut().for_each(|bin| *bin /= count);
        Self { bins, bin_hz: transform.bin_hz }
    }

    /// Power between two frequencies.
    pub fn power(&self, low_hz: f64, high_hz: f64) -> f64 {
        let first = (low_hz / self.bin_hz).round() as usize;
        let last = ((high_hz / self.bin_hz).round() as usize).min(self.bins.len());
        self.bins.get(first..last).map_or(0.0, |bins| bins.iter().sum::<f64>() * self.bin_hz)
    }

    /// Density at a frequency in dB per Hz, mean over a sixth of an octave.
    pub fn density_db(&self, frequency_hz: f64) -> f64 {
        let half = 2f64.powf(1.0 / 12.0);
        decibels(mean_between(&self.bins, self.bin_hz, frequency_hz / half, frequency_hz * half))
    }

    /// Highest frequency of the spectrum.
    pub fn nyquist_hz(&self) -> f64 {
        self.bin_hz * (self.bins.len() - 1) as f64
    }
}

/// Power spectral density in dB over time (columns) and the logarithm of frequency (rows, lowest first).
pub struct Spectrogram {
    /// Column after column.
    pub levels_db: Vec<f32>,
    /// Rows of a column.
    pub rows: usize,
}

/// FFT sizes at 44.1 kHz, each with the frequency in Hz above which the next shorter one is used: long windows separate
/// low tones, short ones separate crackles.
const SIZES: [(usize, f64); 4] = [(8192, 160.0), (4096, 600.0), (2048, 2_400.0), (1024, f64::INFINITY)];

impl Spectrogram {
    /// The spectrogram of a whole sound.
    pub fn of(channels: &[Vec<f32>], sample_rate_hz: u32, columns: usize, rows: usize) -> Self {
        let samples = channels.first().map_or(0, Vec::len);
        let (low_hz, high_hz) = BAND_HZ;
        let step = (high_hz / low_hz).powf(1.0 / rows as f64);
        let frequencies: Vec<f64> = (0..rows).map(|row| low_hz * step.powf(row as f64 + 0.5)).collect();
        let mut powers = vec![0.0; columns * rows];
        let mut shorter_from_hz = 0.0;
        for (size, until_hz) in SIZES {
            let weights: Vec<f64> =
                frequencies.iter().map(|f| rise(*f, shorter_from_hz) * (1.0 - rise(*f, until_hz))).collect();
            shorter_from_hz = until_hz;
            let size = (size as f64 * f64::from(sample_rate_hz) / 44_100.0).round() as usize;
            let size = size + size % 2;
            let mut transform = Transform::new(size, sample_rate_hz);
            let mut bins = vec![0.0; size / 2 + 1];
            for (column, out) in powers.chunks_exact_mut(rows).enumerate() {
                let centre = (column as f64 + 0.5) * samples as f64 / columns as f64;
                bins.fill(0.0);
                for channel in channels {
                    transform.add_density(channel, centre as i64 - size as i64 / 2, &mut bins);
                }
                for ((power, weight), f) in out.iter_mut().zip(&weights).zip(&frequencies) {
                    if *weight > 0.0 {
                        let density = mean_between(&bins, transform.bin_hz, f / step.sqrt(), f * step.sqrt());
                        *power += weight * density / channels.len() as f64;
                    }
                }
            }
        }
        Self { levels_db: powers.into_iter().map(|power| decibels(power) as f32).collect(), rows }
    }

    /// The level that one in a thousand points exceeds.
    pub fn top_db(&self) -> f32 {
        let mut sorted = self.levels_db.clone();
        sorted.sort_by(f32::total_cmp);
        sorted.get(sorted.len() - 1 - sorted.len() / 1000).copied().unwrap_or(0.0)
    }
}

/// 0 below, 1 above, over half an octave around `centre_hz`.
fn rise(frequency_hz: f64, centre_hz: f64) -> f64 {
    if centre_hz == 0.0 {
        return 1.0;
    }
    (0.5 + 2.0 * (frequency_hz / centre_hz).log2()).clamp(0.0, 1.0)
}

fn decibels(power: f64) -> f64 {
    10.0 * power.max(1e-20).log10()
}

/// Mean of the bins between two frequencies; where these are closer than bins, interpolated.
fn mean_between(bins: &[f64], bin_hz: f64, low_hz: f64, high_hz: f64) -> f64 {
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

/// A windowed transform of one size (Hann).
struct Transform {
    fft: RealTransform,
    room: Vec<f64>,
    window: Vec<f64>,
    frame: Vec<f64>,
    spectrum: Vec<Complex64>,
    bin_hz: f64,
    /// Factor from squared magnitude to density.
    scale: f64,
}

impl Transform {
    fn new(size: usize, sample_rate_hz: u32) -> Self {
        let fft = RealTransform::new(size);
        let window: Vec<f64> =
            (0..size).map(|n| 0.5 - 0.5 * (std::f64::consts::TAU * n as f64 / size as f64).cos()).collect();
        let energy: f64 = window.iter().map(|w| w * w).sum();
        Self {
            frame: vec![0.0; size],
            spectrum: vec![Complex64::default(); fft.bins()],
            room: vec![0.0; fft.room()],
            fft,
            window,
            bin_hz: f64::from(sample_rate_hz) / size as f64,
            scale: 2.0 / (energy * f64::from(sample_rate_hz)),
        }
    }

    /// Adds the density of the frame from `start` on; beyond the sound's ends there is silence.
    fn add_density(&mut self, sound: &[f32], start: i64, bins: &mut [f64]) {
        for ((n, sample), window) in (start..).zip(&mut self.frame).zip(&self.window) {
            let x = usize::try_from(n).ok().and_then(|n| sound.get(n)).copied().unwrap_or(0.0);
            *sample = f64::from(x) * window;
        }
        self.fft.forward(&self.frame, &mut self.spectrum, &mut self.room);
        for (bin, value) in bins.iter_mut().zip(&self.spectrum) {
            *bin += self.scale * value.norm_sqr();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RATE_HZ: u32 = 44_100;

    /// Two seconds, faded in and out over a tenth: an abrupt end has power everywhere.
    fn tone(frequency_hz: f64) -> Vec<f32> {
        let step = std::f64::consts::TAU * frequency_hz / f64::from(RATE_HZ);
        let fade = |n: u32| (f64::from(n.min(2 * RATE_HZ - n)) / (0.1 * f64::from(RATE_HZ))).min(1.0);
        (0..2 * RATE_HZ).map(|n| (fade(n) * (step * f64::from(n)).sin()) as f32).collect()
    }

    #[test]
    fn a_tones_power_is_found_at_its_frequency() {
        let spectrum = Spectrum::of(&[tone(1000.0)], RATE_HZ);
        let power = spectrum.power(950.0, 1050.0);
        // The first and the last frames are half or wholly outside.
        assert!((0.4..0.51).contains(&power), "{power}");
        assert!(spectrum.power(1.0, 800.0) + spectrum.power(1200.0, 22_000.0) < 1e-6);
    }

    #[test]
    fn a_spectrogram_has_a_tone_in_its_row_whatever_the_window() {
        let rows = 200;
        for frequency_hz in [60.0, 160.0, 300.0, 1000.0, 8000.0] {
            let spectrogram = Spectrogram::of(&[tone(frequency_hz)], RATE_HZ, 5, rows);
            let column = &spectrogram.levels_db[2 * rows..3 * rows];
            let loudest = column.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
            let (low, high) = BAND_HZ;
            let found = low * (high / low).powf((loudest as f64 + 0.5) / rows as f64);
            assert!((found / frequency_hz).log2().abs() < 0.12, "{frequency_hz} Hz found at {found} Hz");
        }
    }
}
