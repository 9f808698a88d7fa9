//! The part of a recording in use, and its level.

use crate::{Error, Recording, subsonic};

/// Most gain of a [`Cut`], up or down, in dB.
pub const MAX_GAIN_DB: f64 = 60.0;

/// A part of a recording, and its level.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cut {
    /// Start and end in seconds; none for all of it. Anything beyond the recording's ends is ignored.
    pub region_s: Option<[f64; 2]>,
    /// Gain in dB, within ±[`MAX_GAIN_DB`].
    pub gain_db: f64,
    /// True if the part is first normalised to full scale.
    pub normalise: bool,
}

impl Cut {
    /// First sample of the part in `recording`, and one past its last; never empty.
    ///
    /// # Errors
    /// If start or end is not a number, or the end is not after the start.
    pub fn span(&self, recording: &Recording) -> Result<std::ops::Range<usize>, Error> {
        let all = recording.len_samples();
        let Some([start_s, end_s]) = self.region_s else { return Ok(0..all) };
        if !(start_s.is_finite() && end_s.is_finite() && start_s < end_s) {
            return Err(Error::Region { name: recording.name.clone(), start_s, end_s });
        }
        let sample =
            |time_s: f64| (time_s * f64::from(recording.sample_rate_hz)).round().clamp(0.0, all as f64) as usize;
        let start = sample(start_s).min(all.saturating_sub(1));
        Ok(start..sample(end_s).max(start + 1).min(all))
    }

    /// The gain factor of the part.
    ///
    /// # Errors
    /// As [`span`](Self::span), and if the gain is not within ±[`MAX_GAIN_DB`].
    pub fn gain(&self, recording: &Recording) -> Result<f64, Error> {
        self.check_gain()?;
        let span = self.span(recording)?;
        Ok(if self.normalise { self.gain_on(&audible(recording, span)) } else { self.gain_on(&[]) })
    }

    fn check_gain(&self) -> Result<(), Error> {
        if (-MAX_GAIN_DB..=MAX_GAIN_DB).contains(&self.gain_db) {
            return Ok(());
        }
        Err(Error::Gain { found_db: self.gain_db, most_db: MAX_GAIN_DB })
    }

    /// The gain factor for the part's own samples.
    fn gain_on(&self, channels: &[Vec<f32>]) -> f64 {
        let samples = channels.iter().flatten();
        let peak = if self.normalise { samples.fold(0.0f32, |peak, sample| peak.max(sample.abs())) } else { 0.0 };
        let full = if peak > 0.0 { 1.0 / f64::from(peak) } else { 1.0 };
        full * maths::pow(10.0, self.gain_db / 20.0)
    }

    /// The part of `recording`, at its level, without inaudible frequencies: an offset and anything slower than 10 Hz
    /// would affect its peak and every match. Name and hash are unchanged, since they identify the file.
    ///
    /// # Errors
    /// As [`gain`](Self::gain).
    pub fn apply(&self, recording: &Recording) -> Result<Recording, Error> {
        self.check_gain()?;
        self.levelled(recording, audible(recording, self.span(recording)?))
    }

    /// The part of `recording`, at its level, including inaudible frequencies, as the paper's method uses it.
    ///
    /// # Errors
    /// As [`gain`](Self::gain).
    pub fn as_recorded(&self, recording: &Recording) -> Result<Recording, Error> {
        self.check_gain()?;
        let span = self.span(recording)?;
        self.levelled(recording, recording.channels.iter().map(|channel| channel[span.clone()].to_vec()).collect())
    }

    fn levelled(&self, recording: &Recording, mut channels: Vec<Vec<f32>>) -> Result<Recording, Error> {
        let gain = self.gain_on(&channels);
        if gain != 1.0 {
            channels.iter_mut().flatten().for_each(|sample| *sample = (f64::from(*sample) * gain) as f32);
        }
        let (name, content_hash) = (recording.name.clone(), recording.content_hash.clone());
        let (sample_rate_hz, notes) = (recording.sample_rate_hz, recording.notes.clone());
        Ok(Recording { channels, sample_rate_hz, name, content_hash, notes })
    }
}

/// A part of all channels, without inaudible frequencies.
fn audible(recording: &Recording, span: std::ops::Range<usize>) -> Vec<Vec<f32>> {
    let mut channels: Vec<Vec<f32>> = recording.channels.iter().map(|channel| channel[span.clone()].to_vec()).collect();
    subsonic::remove(&mut channels, recording.sample_rate_hz);
    channels
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tone that swells, at 8 kHz.
    fn tone() -> Recording {
        let channel = |sign: f32| {
            let sample =
                |n: usize| sign * (n / 8 + 1) as f32 / 8000.0 * [0.0, 0.7, 1.0, 0.7, 0.0, -0.7, -1.0, -0.7][n % 8];
            (0..32_000).map(sample).collect()
        };
        Recording {
            channels: vec![channel(1.0), channel(-0.5)],
            sample_rate_hz: 8000,
            name: "tone".into(),
            content_hash: "00".into(),
            notes: vec![],
        }
    }

    #[test]
    fn the_part_is_cut_and_levelled() {
        let whole = tone();
        assert_eq!(Cut::default().apply(&whole).unwrap(), whole, "bit for bit");
        let part = Cut { region_s: Some([1.0, 3.0]), ..Cut::default() }.apply(&whole).unwrap();
        assert_eq!(part.channels[0], whole.channels[0][8000..24_000]);
        assert_eq!((part.name.as_str(), part.content_hash.as_str()), ("tone", "00"));
        let loud = Cut { region_s: Some([1.0, 3.0]), normalise: true, gain_db: -20.0 }.apply(&whole).unwrap();
        let peak = |channel: usize| loud.channels[channel].iter().fold(0.0f32, |peak, sample| peak.max(sample.abs()));
        assert!((peak(0) - 0.1).abs() < 1e-6, "the part's own peak counts: {}", peak(0));
        assert!((peak(1) - 0.05).abs() < 1e-6, "channels keep their balance");
        let silent = Recording { channels: vec![vec![0.0; 10]], ..tone() };
        assert_eq!(Cut { normalise: true, ..Cut::default() }.apply(&silent).unwrap(), silent);
    }

    #[test]
    fn an_offset_takes_no_part_in_normalising() {
        let normal = Cut { normalise: true, ..Cut::default() };
        let mut offset = tone();
        offset.channels.iter_mut().flatten().for_each(|sample| *sample += 0.3);
        let (plain, offset_gain) = (normal.gain(&tone()).unwrap(), normal.gain(&offset).unwrap());
        assert!((offset_gain / plain - 1.0).abs() < 0.01, "{offset_gain} instead of {plain}");
        let part = normal.apply(&offset).unwrap();
        let mean = part.channels[0].iter().sum::<f32>() / 32_000.0;
        assert!(mean.abs() < 1e-4, "an offset of {mean}");
    }

    #[test]
    fn region_is_clipped_to_the_recording_and_empty_ones_refused() {
        let whole = tone();
        let span = |start_s, end_s| Cut { region_s: Some([start_s, end_s]), ..Cut::default() }.span(&whole);
        assert_eq!(span(-5.0, 0.5).unwrap(), 0..4000);
        assert_eq!(span(0.5, 1e9).unwrap(), 4000..32_000);
        assert_eq!(span(7.0, 8.0).unwrap(), 31_999..32_000, "never empty");
        assert_eq!(span(0.2, 0.2 + 1e-9).unwrap(), 1600..1601);
        for (start_s, end_s) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY)] {
            assert!(matches!(span(start_s, end_s), Err(Error::Region { .. })), "{start_s}-{end_s}");
        }
        let loud = Cut { gain_db: 61.0, ..Cut::default() };
        assert!(matches!(loud.apply(&whole), Err(Error::Gain { .. })));
    }
}
