//! The stereo image: as much difference between two channels, in every third octave, as the recording has.
//!
//! Windows are matched by the mean of the channels, so they join seamlessly only in the mean. The difference between the
//! channels is cut into pieces a few samples long, and its low part, which is large, spreads to frequencies where the
//! recording's channels are alike. Therefore the difference is brought to the same level, relative to the mean, as in
//! the recording.

use std::ops::Range;

use super::equalizer::{Equalizer, LIMIT_DB, design};

/// Level in dB of silence: just above the -300 dB that stand for no power at all.
const SILENT_DB: f64 = -290.0;

/// Levels of the mean and of the difference of two channels in third octaves, in dB.
#[derive(Debug)]
pub(super) struct Levels {
    pub mean_db: Vec<f64>,
    pub side_db: Vec<f64>,
}

/// Half the difference of two channels; none of one channel, or of more than two.
pub(super) fn side_of(channels: &[Vec<f64>]) -> Option<Vec<f64>> {
    let [left, right] = channels else { return None };
    Some(left.iter().zip(right).map(|(left, right)| 0.5 * (left - right)).collect())
}

/// Taps for the difference of the channels in the `output` of a trial, which bring it to the `recording`'s level relative to
/// the mean; empty if the channels of either are equal.
pub(super) fn side_taps(recording: &Levels, output: &Levels, sample_rate_hz: f64) -> Vec<f64> {
    let is_silent = |levels: &Levels| levels.side_db.iter().all(|db| *db <= SILENT_DB);
    if is_silent(recording) || is_silent(output) {
        return Vec::new();
    }
    let width_db = |levels: &Levels, band: usize| levels.side_db[band] - levels.mean_db[band];
    let gains_db: Vec<f64> = (0..recording.side_db.len().min(output.side_db.len()))
        .map(|band| (width_db(recording, band) - width_db(output, band)).clamp(-LIMIT_DB, LIMIT_DB))
        .collect();
    design(&gains_db, sample_rate_hz)
}

/// Filters the difference of two channels.
#[derive(Debug)]
pub(super) struct Image {
    equalizer: Equalizer,
    side: Vec<f64>,
    /// True if it has filtered since the reset.
    is_in_use: bool,
}

impl Image {
    /// An image filter for blocks of up to `block` samples.
    pub fn new(sample_rate_hz: f64, block: usize) -> Self {
        Self { equalizer: Equalizer::new(sample_rate_hz, 1), side: vec![0.0; block], is_in_use: false }
    }

    /// Resets to silence.
    pub fn reset(&mut self) {
        self.equalizer.reset();
        self.is_in_use = false;
    }

    /// Samples for which it continues to sound.
    pub fn tail_samples(&self) -> usize {
        self.equalizer.tail_samples()
    }

    /// See [`Equalizer::skip`].
    pub fn skip(&mut self, samples: usize) {
        if self.is_in_use {
            self.equalizer.skip(samples);
        }
    }

    /// Filters the samples in `range` of two channels; with no taps they stay bit for bit, as do more or fewer channels.
    pub fn process(&mut self, taps: &[f64], channels: &mut [&mut [f64]], range: Range<usize>) {
        let [left, right] = channels else { return };
        self.is_in_use |= !taps.is_empty();
        if !self.is_in_use {
            return;
        }
        let (left, right) = (&mut left[range.clone()], &mut right[range.clone()]);
        let side = &mut self.side[..range.len()];
        for (side, (left, right)) in side.iter_mut().zip(left.iter().zip(right.iter())) {
            *side = 0.5 * (left - right);
        }
        self.equalizer.process(taps, 1.0, &mut [&mut *side], 0..range.len());
        for (side, (left, right)) in side.iter().zip(left.iter_mut().zip(right.iter_mut())) {
            // The filter's contribution; if it is zero, the channels stay exactly as they are.
            let added = side - 0.5 * (*left - *right);
            *left += added;
            *right -= added;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dsp::White;

    const RATE_HZ: f64 = 44_100.0;

    fn noise(stream: u32) -> Vec<f64> {
        let mut noise = vec![0.0; 8192];
        White::new(1, stream).fill(0, &mut noise);
        noise
    }

    #[test]
    fn difference_is_turned_down_and_the_mean_stays() {
        let bands = super::super::bands::centres_hz(RATE_HZ).len();
        let level = |side_db: f64| Levels { mean_db: vec![0.0; bands], side_db: vec![side_db; bands] };
        let taps = side_taps(&level(-10.0), &level(0.0), RATE_HZ);
        let (before, mut after) = ([noise(1), noise(2)], [noise(1), noise(2)]);
        let [left, right] = &mut after;
        let mut image = Image::new(RATE_HZ, 1000);
        for start in (0..8192).step_by(1000) {
            let end = (start + 1000).min(8192);
            image.process(&taps, &mut [&mut left[start..end], &mut right[start..end]], 0..end - start);
        }
        let power = |signal: Vec<f64>| signal.iter().map(|x| x * x).sum::<f64>();
        let side = |channels: &[Vec<f64>]| power(side_of(channels).unwrap());
        let change_db = 10.0 * (side(&after) / side(&before)).log10();
        assert!((change_db + 10.0).abs() < 0.3, "{change_db} dB");
        for i in 0..8192 {
            let [mean, kept] = [&before, &after].map(|channels| channels[0][i] + channels[1][i]);
            assert!((mean - kept).abs() < 1e-12);
        }
    }

    #[test]
    fn without_taps_and_in_mono_everything_stays() {
        let (mut left, mut right) = (noise(1), noise(2));
        Image::new(RATE_HZ, 8192).process(&[], &mut [&mut left, &mut right], 0..8192);
        assert!(left == noise(1) && right == noise(2));
        assert!(side_of(&[noise(1)]).is_none());
        let equal = Levels { mean_db: vec![0.0; 3], side_db: vec![-300.0; 3] };
        let wide = Levels { mean_db: vec![0.0; 3], side_db: vec![0.0; 3] };
        assert!(side_taps(&equal, &wide, RATE_HZ).is_empty() && side_taps(&wide, &equal, RATE_HZ).is_empty());
    }
}
