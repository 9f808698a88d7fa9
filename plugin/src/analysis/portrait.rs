//! A whole recording at a glance: its outline, its spectrum, its course.

use pyrophone_recording::Recording;

use super::analyser::Analyser;
use super::bands::{BANDS, decibels};
use super::fidelity::Character;

/// Columns of outline and course.
pub const COLUMNS: usize = 512;

/// Longest stretch, in seconds, whose spectrum is looked at in every column: an hour is not worth a minute's work.
const GLANCE_S: f64 = 0.1;

/// Longest stretch, in seconds, from a recording's middle by which an output is judged.
const JUDGED_S: f64 = 12.0;

/// What is drawn of a recording, and judged by.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait {
    /// Least and largest sample by column.
    pub outline: Vec<[f32; 2]>,
    /// Mean power density in dB by band.
    pub spectrum_db: [f32; BANDS],
    /// Power density in dB, by column, then band.
    pub course_db: Vec<[f32; BANDS]>,
    /// Figures by which an output is judged.
    pub character: Character,
    /// Length in seconds.
    pub duration_s: f64,
}

impl Portrait {
    /// The portrait of a recording.
    pub fn of(recording: &Recording) -> Self {
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
        let mut sum = [0.0f64; BANDS];
        let course = (0..COLUMNS).map(|index| {
            let span = column(index);
            // Windows reach beyond a column where columns are short.
            let middle = (span.start + span.end) / 2;
            analyser.reset();
            let mut here = [0.0; BANDS];
            for at in 0..glance {
                let sample = (middle + at).checked_sub(glance / 2).filter(|at| *at < samples).map_or(0.0, mean);
                if let Some(density) = analyser.push(sample) {
                    here = *density;
                }
            }
            sum.iter_mut().zip(here).for_each(|(sum, x)| *sum += f64::from(x));
            here.map(decibels)
        });
        let course_db: Vec<[f32; BANDS]> = course.collect();
        let judged = samples.min((JUDGED_S * rate_hz) as usize);
        let first = (samples - judged) / 2;
        Self {
            outline: outline.collect(),
            spectrum_db: sum.map(|sum| decibels((sum / COLUMNS as f64) as f32)),
            course_db,
            character: Character::of((first..first + judged).map(mean), rate_hz),
            duration_s: recording.duration_s(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(channels: Vec<Vec<f32>>) -> Recording {
        Recording { channels, sample_rate_hz: 44_100, name: "test".into(), content_hash: String::new() }
    }

    #[test]
    fn outline_and_course_follow_the_recording() {
        let noise = pyrophone_synthesis::noise::White::new(1, 0);
        // Silence, then noise.
        let channel = |sign: f32| -> Vec<f32> {
            (0..88_200).map(|n| if n < 44_100 { 0.0 } else { sign * 0.1 * noise.at(n) as f32 }).collect()
        };
        let portrait = Portrait::of(&recording(vec![channel(1.0), channel(0.5)]));
        assert_eq!((portrait.outline.len(), portrait.course_db.len()), (COLUMNS, COLUMNS));
        assert_eq!(portrait.outline[100], [0.0, 0.0]);
        let [low, high] = portrait.outline[400];
        assert!(low < -0.1 && high > 0.1, "{low} {high}");
        let loudness = |column: usize| portrait.course_db[column][100];
        assert!(loudness(400) > loudness(100) + 60.0, "{} {}", loudness(400), loudness(100));
        assert!(portrait.spectrum_db.iter().skip(40).all(|level| (-75.0..-63.0).contains(level)));
    }

    #[test]
    fn single_samples_and_hours_are_no_trouble() {
        for samples in [1, 2, 511, 513, 3_000_000] {
            let portrait = Portrait::of(&recording(vec![vec![0.5; samples]]));
            assert_eq!(portrait.outline.len(), COLUMNS);
            assert!(portrait.outline.iter().any(|[_, high]| *high == 0.5), "{samples}");
            assert!(portrait.course_db.iter().flatten().all(|level| level.is_finite()), "{samples}");
        }
    }
}
