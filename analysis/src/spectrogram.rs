//! Power over time and frequency.

use crate::spectrum::{decibels, mean_between};
use crate::welch::Welch;

/// Lowest and highest frequency that is shown, in Hz.
pub const BAND_HZ: (f64, f64) = (20.0, 20_000.0);

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
    pub fn of_channels(channels: &[Vec<f32>], sample_rate_hz: u32, columns: usize, rows: usize) -> Self {
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
            let mut welch = Welch::new(size, f64::from(sample_rate_hz));
            for (column, out) in powers.chunks_exact_mut(rows).enumerate() {
                let centre = (column as f64 + 0.5) * samples as f64 / columns as f64;
                welch.reset();
                for channel in channels {
                    welch.add(frame(channel, centre as i64 - size as i64 / 2));
                }
                let bins: Vec<f64> = welch.density().collect();
                for ((power, weight), f) in out.iter_mut().zip(&weights).zip(&frequencies) {
                    if *weight > 0.0 {
                        let density = mean_between(&bins, welch.bin_hz(), f / step.sqrt(), f * step.sqrt());
                        *power += weight * density;
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

/// A sound's samples from `start` on; beyond its ends there is silence.
fn frame(sound: &[f32], start: i64) -> impl Iterator<Item = f64> + '_ {
    let sample = |n: i64| usize::try_from(n).ok().and_then(|n| sound.get(n)).copied().unwrap_or(0.0);
    (start..).map(move |n| f64::from(sample(n)))
}

/// 0 below, 1 above, over half an octave around `centre_hz`.
fn rise(frequency_hz: f64, centre_hz: f64) -> f64 {
    if centre_hz == 0.0 {
        return 1.0;
    }
    (0.5 + 2.0 * (frequency_hz / centre_hz).log2()).clamp(0.0, 1.0)
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
    fn a_spectrogram_has_a_tone_in_its_row_whatever_the_window() {
        let rows = 200;
        for frequency_hz in [60.0, 160.0, 300.0, 1000.0, 8000.0] {
            let spectrogram = Spectrogram::of_channels(&[tone(frequency_hz)], RATE_HZ, 5, rows);
            let column = &spectrogram.levels_db[2 * rows..3 * rows];
            let loudest = column.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).unwrap().0;
            let (low, high) = BAND_HZ;
            let found = low * (high / low).powf((loudest as f64 + 0.5) / rows as f64);
            assert!((found / frequency_hz).log2().abs() < 0.12, "{frequency_hz} Hz found at {found} Hz");
        }
    }
}
