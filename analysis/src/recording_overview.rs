//! Overview of a whole recording: its outline, spectrum and spectrogram.

use pyrophone_recording::{Cut, Recording};

use crate::analyser::Analyser;
use crate::bands::{BANDS, FLOOR_DB, decibels};
use crate::fidelity::Character;

/// Columns of outline and course.
pub const COLUMNS: usize = 512;

/// Longest stretch, in seconds, analysed for each column: an hour-long recording must not cost a minute of analysis.
const GLANCE_S: f64 = 0.1;

/// Longest stretch, in seconds, from a recording's middle against which an output is judged.
const JUDGED_S: f64 = 12.0;

/// Picture and figures of a recording: outline and spectrogram cover all of it, the rest the part used for learning.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordingOverview {
    /// Least and largest sample by column.
    pub outline: Vec<[f32; 2]>,
    /// Mean power density in dB by band, at the part's level.
    pub spectrum_db: [f32; BANDS],
    /// Power density in dB, by column, then band.
    pub course_db: Vec<[f32; BANDS]>,
    /// Figures against which an output is judged.
    pub character: Character,
    /// Length in seconds.
    pub duration_s: f64,
    /// Start of the part, in seconds.
    pub start_s: f64,
}

impl RecordingOverview {
    /// The overview of a recording whose part `cut` is used for learning.
    pub fn of_recording(recording: &Recording, cut: &Cut) -> Self {
        let samples = recording.len_samples();
        let share = 1.0 / recording.channels.len().max(1) as f32;
        let mean = |at: usize| share * recording.channels.iter().map(|channel| channel[at]).sum::<f32>();
        let column = |index: usize| {
            let start = index * samples / COLUMNS;
            start..((index + 1) * samples / COLUMNS).max(start + 1).min(samples)
        };
        let outline = (0..COLUMNS).map(|index| {
            let samples = recording.channels.iter().flat_map(|channel| &channel[column(index)]);
            samples.fold([0.0f32; 2], |[low, high], x| [low.min(*x), high.max(*x)])
        });
        let rate_hz = f64::from(recording.sample_rate_hz);
        let glance = (GLANCE_S * rate_hz) as usize;
        let mut analyser = Analyser::new(rate_hz, GLANCE_S / 2.0, GLANCE_S);
        let course = (0..COLUMNS).map(|index| {
            let span = column(index);
            // Windows extend beyond a column where columns are short.
            let middle = (span.start + span.end) / 2;
            analyser.reset();
            let mut here = [0.0; BANDS];
            for at in 0..glance {
                let sample = (middle + at).checked_sub(glance / 2).filter(|at| *at < samples).map_or(0.0, mean);
                if let Some(density) = analyser.push(sample) {
                    here = *density;
                }
            }
            here.map(decibels)
        });
        let course_db = course.collect();
        let all = Self {
            outline: outline.collect(),
            course_db,
            spectrum_db: [FLOOR_DB; BANDS],
            character: Character::default(),
            duration_s: recording.duration_s(),
            start_s: 0.0,
        };
        all.with_cut(recording, cut)
    }

    /// The overview of the same recording with another part used for learning. An invalid part counts as all.
    pub fn with_cut(&self, recording: &Recording, cut: &Cut) -> Self {
        let samples = recording.len_samples();
        let span = cut.span(recording).unwrap_or(0..samples);
        let gain_db = 20.0 * cut.gain(recording).unwrap_or(1.0).log10() as f32;
        let column = |sample: usize| (sample * COLUMNS / samples.max(1)).min(COLUMNS - 1);
        let columns = column(span.start)..column(span.end.saturating_sub(1)) + 1;
        let spectrum_db = std::array::from_fn(|band| {
            let powers =
                self.course_db[columns.clone()].iter().map(|levels| 10f64.powf(f64::from(levels[band]) / 10.0));
            decibels((powers.sum::<f64>() / columns.len() as f64) as f32) + gain_db
        });
        let rate_hz = f64::from(recording.sample_rate_hz);
        let judged = span.len().min((JUDGED_S * rate_hz) as usize);
        let first = span.start + (span.len() - judged) / 2;
        let share = 1.0 / recording.channels.len().max(1) as f32;
        let mean = |at: usize| share * recording.channels.iter().map(|channel| channel[at]).sum::<f32>();
        Self {
            outline: self.outline.clone(),
            course_db: self.course_db.clone(),
            spectrum_db,
            character: Character::of_samples((first..first + judged).map(mean), rate_hz),
            duration_s: self.duration_s,
            start_s: span.start as f64 / rate_hz,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(channels: Vec<Vec<f32>>) -> Recording {
        Recording { channels, sample_rate_hz: 44_100, name: "test".into(), content_hash: String::new(), notes: vec![] }
    }

    #[test]
    fn outline_and_course_follow_the_recording() {
        let noise = pyrophone_synthesis::dsp::White::new(1, 0);
        // Silence, then noise.
        let channel = |sign: f32| -> Vec<f32> {
            (0..88_200).map(|n| if n < 44_100 { 0.0 } else { sign * 0.1 * noise.sample_at(n) as f32 }).collect()
        };
        let overview = RecordingOverview::of_recording(&recording(vec![channel(1.0), channel(0.5)]), &Cut::default());
        assert_eq!((overview.outline.len(), overview.course_db.len()), (COLUMNS, COLUMNS));
        assert_eq!(overview.outline[100], [0.0, 0.0]);
        let [low, high] = overview.outline[400];
        assert!(low < -0.1 && high > 0.1, "{low} {high}");
        let loudness = |column: usize| overview.course_db[column][100];
        assert!(loudness(400) > loudness(100) + 60.0, "{} {}", loudness(400), loudness(100));
        assert!(overview.spectrum_db.iter().skip(40).all(|level| (-75.0..-63.0).contains(level)));
    }

    #[test]
    fn the_part_that_is_learnt_from_is_judged_at_its_level() {
        let noise = pyrophone_synthesis::dsp::White::new(1, 0);
        let loudness = |n: i64| if n < 44_100 { 0.1 } else { 0.001 };
        let recording = recording(vec![(0..88_200).map(|n| (loudness(n) * noise.sample_at(n)) as f32).collect()]);
        let whole = RecordingOverview::of_recording(&recording, &Cut::default());
        let part = |region_s, gain_db| {
            let cut = Cut { region_s: Some(region_s), gain_db, normalise: false };
            whole.with_cut(&recording, &cut)
        };
        let band = 120;
        let quiet = part([1.1, 1.9], 0.0);
        assert!((whole.spectrum_db[band] - quiet.spectrum_db[band] - 37.0).abs() < 2.0, "40 dB, less the half");
        assert_eq!((quiet.start_s, quiet.duration_s), (1.1, 2.0));
        assert_eq!((&quiet.outline, &quiet.course_db), (&whole.outline, &whole.course_db));
        let louder = part([1.1, 1.9], 12.0);
        assert!((louder.spectrum_db[band] - quiet.spectrum_db[band] - 12.0).abs() < 1e-3);
    }

    #[test]
    fn any_length_fills_all_columns_with_finite_values() {
        for samples in [1, 2, 511, 513, 3_000_000] {
            let overview = RecordingOverview::of_recording(&recording(vec![vec![0.5; samples]]), &Cut::default());
            assert_eq!(overview.outline.len(), COLUMNS);
            assert!(overview.outline.iter().any(|[_, high]| *high == 0.5), "{samples}");
            assert!(overview.course_db.iter().flatten().all(|level| level.is_finite()), "{samples}");
        }
    }
}
