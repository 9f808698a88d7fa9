//! The spectrum of the sound between a recording's crackles.

use super::stft::Stft;
use maths::fft;

/// Time that a percentile spans, in seconds: several of the longest crackles, so that crackles are a minority in it. And
/// the frames from one to the next; between them the background, which changes slowly, is interpolated.
const SPAN_S: f64 = 0.25;
const STEP: usize = 16;
/// Stride between the frames that count: frames overlap by three quarters.
const STRIDE: usize = 2;
/// The percentile, and the root mean square of Gaussian noise relative to it: magnitudes are Rayleigh distributed, so
/// percentile p is sqrt(-ln(1 - p)) of the root mean square.
const PERCENTILE: f64 = 0.4;

/// Root mean square magnitudes by frequency, as they change in time.
#[derive(Debug)]
pub(super) struct Background {
    bins: usize,
    /// Rows in time order, [`STEP`] frames apart.
    rows: Vec<f32>,
}

impl Background {
    /// The background of one channel. Crackles are rarer than the sound between them, so a percentile below the median
    /// excludes them.
    pub fn of_signal(signal: &[f64], stft: &mut Stft, sample_rate_hz: f64) -> Self {
        let (bins, frames) = (stft.bins(), stft.frames(signal.len()));
        let span = ((SPAN_S * sample_rate_hz / stft.hop() as f64) as usize / STRIDE).max(4);
        let to_rms = 1.0 / (-maths::ln(1.0 - PERCENTILE)).sqrt();
        // The last magnitudes of every bin, in a row.
        let mut recent = vec![0.0f32; bins * span];
        let mut sorted = vec![0.0f32; span];
        let mut rows = Vec::with_capacity(bins * (frames / STEP + 1));
        let (mut taken, mut next) = (0usize, 0usize);
        for row in 0..=frames / STEP {
            let until = (row * STEP + span * STRIDE / 2).min(frames);
            while next < until {
                stft.analyse(signal, next);
                for (bin, value) in stft.spectrum().iter().enumerate() {
                    recent[bin * span + taken % span] = fft::magnitude(*value) as f32;
                }
                taken += 1;
                next += STRIDE;
            }
            let held = taken.min(span);
            for bin in 0..bins {
                let values = &mut sorted[..held];
                values.copy_from_slice(&recent[bin * span..bin * span + held]);
                let rank = ((held as f64 * PERCENTILE) as usize).min(held.saturating_sub(1));
                let value = if held == 0 { 0.0 } else { *values.select_nth_unstable_by(rank, f32::total_cmp).1 };
                rows.push(to_rms as f32 * value);
            }
        }
        Self { bins, rows }
    }

    /// The root mean square magnitude of `bin` in `frame`.
    pub fn power_at(&self, frame: usize, bin: usize) -> f64 {
        let last = self.rows.len() / self.bins - 1;
        let (row, part) = ((frame / STEP).min(last), (frame % STEP) as f32 / STEP as f32);
        let value = |row: usize| self.rows[row.min(last) * self.bins + bin];
        f64::from(value(row) + part * (value(row + 1) - value(row)))
    }
}
